#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/camera_model.h"
#include "core/pipeline.h"
#include "firmware/report/trace_json.h"
#include "tools/programs/replay/canvas.h"

namespace touchline::replay {

/// Names and colors for the annotation.
struct AnnotationStyle {
  report::TraceNames names;
  std::vector<CanvasColor> colors;  // indexed by ColorId
};

/// Draws the results of the pipeline over the picture: outlines of regions in their color, with the reason where one
/// was rejected; patch centers; robots with heading and id; the ball; tracks with their 3-sigma ellipse and an arrow to
/// their predicted position in 0.25 s; the lines of the field as the camera model projects them.
class Annotator {
 public:
  Annotator(const PipelineParameters& parameters, AnnotationStyle style);

  /// Draws one frame. The pixels of `trace.frame` must still be valid. The returned picture has even width and height,
  /// as video encoders need.
  SurfacePtr draw(const StepTrace& trace, std::uint64_t frame, const std::string& file) const;

 private:
  void draw_field(cairo_t& context) const;
  void dim_outside(cairo_t& context, const Frame& frame) const;
  void draw_regions(cairo_t& context, const StepTrace& trace) const;
  void draw_refusals(cairo_t& context, const StepTrace& trace) const;
  void draw_robot(cairo_t& context, const RobotSighting& robot) const;
  void draw_id_label(cairo_t& context, const RobotSighting& robot, double scale) const;
  void draw_ball(cairo_t& context, const BallSighting& ball) const;
  void draw_tracks(cairo_t& context, const StepTrace& trace) const;
  void draw_header(cairo_t& context, const StepTrace& trace, std::uint64_t frame, const std::string& file,
                   double width) const;
  void draw_legend(cairo_t& context, const StepTrace& trace, double top, double width) const;

  [[nodiscard]] CanvasColor team_color(Team team) const;
  [[nodiscard]] CanvasColor color_of(ColorId color) const;

  PipelineParameters parameters_;
  AnnotationStyle style_;
  CameraModel camera_;
  bool has_camera_ = false;
};

}  // namespace touchline::replay
