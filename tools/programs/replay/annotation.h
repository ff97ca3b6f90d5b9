#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/camera_model.h"
#include "core/pipeline.h"
#include "firmware/report/trace_json.h"
#include "tools/programs/replay/canvas.h"

namespace touchline::replay {

/// How things are called and shown.
struct Appearance {
  report::TraceNames names;
  std::vector<Rgb> colors;  // indexed by ColorId
};

/// Draws what the pipeline saw over the picture that it saw it in: regions with their color's outline and, where one
/// was refused, why; patches, robots with heading and id, ball, tracks with velocity (where they will be in a quarter
/// of a second) and their 3-sigma ellipse, and the field's lines as the camera model sees them.
class Annotator {
 public:
  Annotator(const PipelineParameters& parameters, Appearance appearance);

  /// `trace` must still have its frame's pixels. Width and height are even.
  SurfacePtr draw(const StepTrace& trace, std::uint64_t frame, const std::string& file) const;

 private:
  void draw_field(cairo_t& context) const;
  void shade_outside(cairo_t& context, const Frame& frame) const;
  void draw_regions(cairo_t& context, const StepTrace& trace) const;
  void draw_refusals(cairo_t& context, const StepTrace& trace) const;
  void draw_robot(cairo_t& context, const RobotSighting& robot) const;
  void draw_badge(cairo_t& context, const RobotSighting& robot, double scale) const;
  void draw_ball(cairo_t& context, const BallSighting& ball) const;
  void draw_tracks(cairo_t& context, const StepTrace& trace) const;
  void draw_header(cairo_t& context, const StepTrace& trace, std::uint64_t frame, const std::string& file,
                   double width) const;
  void draw_legend(cairo_t& context, const StepTrace& trace, double top, double width) const;

  void line_on_field(cairo_t& context, FieldPoint from, FieldPoint to, float height_m) const;
  void circle_on_field(cairo_t& context, FieldPoint center, float radius_x_m, float radius_y_m, float height_m) const;
  void square_on_field(cairo_t& context, const Pose& pose, float side_m, float height_m) const;
  void arrow_on_field(cairo_t& context, FieldPoint from, FieldPoint to, float height_m) const;
  [[nodiscard]] Rgb team_color(Team team) const;
  [[nodiscard]] Rgb color_of(ColorId color) const;

  PipelineParameters parameters_;
  Appearance appearance_;
  CameraModel camera_;
  bool has_camera_ = false;
};

}  // namespace touchline::replay
