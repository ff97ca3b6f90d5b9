#include "tools/programs/setup/field_step.h"

#include <cmath>

#include "core/geometry/camera_model.h"
#include "tools/programs/calibrate/field/fit_consistency.h"
#include "tools/programs/calibrate/field/painted_lines.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/setup/page_state.h"

namespace touchline::setup {
namespace {

// Points per line, because a line that is straight on the field is curved in the picture.
constexpr std::size_t kPointsOfALine = 33;
// Above these values, a robot's position somewhere in the field has an error that affects play: a tenth of the robot's
// size, and a quarter of the limits at which calibrate_field() fails.
constexpr double kGoodTop_mm = 4.0, kGoodRms_mm = 1.5;

nlohmann::json polyline(const CameraModel& camera, const calibrate::Mark& mark) {
  nlohmann::json out = nlohmann::json::array();
  for (std::size_t i = 0; i < kPointsOfALine; ++i) {
    const double way_m = calibrate::length_of(mark) * static_cast<double>(i) / static_cast<double>(kPointsOfALine - 1);
    const calibrate::MarkPlace place = calibrate::place_on(mark, way_m);
    const PixelPoint pixel = camera.to_pixel({static_cast<float>(place.x_m), static_cast<float>(place.y_m)}, 0.0f);
    out.push_back({pixel.u_px, pixel.v_px});
  }
  return out;
}

// Returns the lines that the model projects and this field has: the border, the goals, and the other markings that the
// pictures show.
nlohmann::json overlay_of(const CameraModel& camera, const FieldParameters& field,
                          const calibrate::FieldReport& report) {
  const auto x = static_cast<double>(field.length_m / 2), y = static_cast<double>(field.width_m / 2);
  const auto goal = static_cast<double>(field.goal_width_m / 2);
  nlohmann::json out = nlohmann::json::array();
  const auto add = [&](double from_x, double from_y, double to_x, double to_y) {
    out.push_back(polyline(camera, {calibrate::MarkKind::kLine, from_x, from_y, to_x, to_y}));
  };
  add(-x, -y, x, -y);
  add(x, -y, x, y);
  add(x, y, -x, y);
  add(-x, y, -x, -y);
  for (const double side : {-1.0, 1.0}) {
    if (field.goal_width_m <= 0) break;
    const double back = side * (x + static_cast<double>(field.goal_depth_m));
    add(side * x, -goal, back, -goal);
    add(back, -goal, back, goal);
    add(back, goal, side * x, goal);
  }
  for (std::size_t m = 0; m < report.refinement.marks.size(); ++m) {
    if (report.marks[m].side < 0 && calibrate::is_seen(report.refinement.marks[m])) {
      out.push_back(polyline(camera, report.marks[m]));
    }
  }
  return out;
}

nlohmann::json notes_of(const calibrate::FieldReport& report, const FieldParameters& field) {
  nlohmann::json notes = nlohmann::json::array();
  const auto note = [&](const char* level, const std::string& text) {
    notes.push_back({{"level", level}, {"text", text}});
  };
  if (!report.unrefined.empty()) note("warning", "only the corners were used: " + report.unrefined);
  if (report.height != calibrate::HeightSource::kMeasured) {
    note("warning", "the height of the lens was not measured: measure it with a tape and enter it");
  }
  for (const std::string& doubt : report.doubts) note("warning", doubt);
  // A height that the picture shows is displayed beside its input field, so no note is needed.
  if (report.refinement.points > 0 && !calibrate::shows_height(report.refinement.height)) {
    note("ok", calibrate::describe(report.refinement.height));
  }
  std::size_t used = 0;
  for (const calibrate::MarkReport& mark : report.refinement.marks) used += mark.used ? 1u : 0u;
  if (!report.refinement.marks.empty()) {
    note("ok",
         formatted("%zu of %zu markings agree with the drawing of the field", used, report.refinement.marks.size()));
  }
  if (const std::string unpainted = calibrate::describe_unpainted(field, report); !unpainted.empty()) {
    note("ok", unpainted + ", so none are drawn or told to other programs");
  }
  return notes;
}

nlohmann::json measured_field(const calibrate::FieldReport& report, const FieldParameters& field,
                              const CameraModel& camera) {
  const calibrate::RefinementReport& refined = report.refinement;
  nlohmann::json out = {{"camera_height_m", report.fit.height_m},
                        {"tilt_rad", report.fit.tilt_rad},
                        {"camera_height_sigma_m", report.fit.height_sigma_m},
                        {"top_assumes", calibrate::assumption_of(report)},
                        {"overlay", overlay_of(camera, field, report)},
                        {"notes", notes_of(report, field)},
                        {"report", calibrate::text_of(report)}};
  const float x = field.length_m / 2, y = field.width_m / 2;
  for (const FieldPoint& corner : {FieldPoint{-x, -y}, FieldPoint{x, -y}, FieldPoint{x, y}, FieldPoint{-x, y}}) {
    const PixelPoint pixel = camera.to_pixel(corner, 0.0f);
    out["corners_px"].push_back({pixel.u_px, pixel.v_px});
  }
  if (refined.points == 0) {
    out["rms_mm"] = report.fit.residual_mm.rms;
    out["max_mm"] = report.fit.residual_mm.max;
    out["quality"] = quality("warning", "four points show no accuracy: it is unknown between them");
    return out;
  }
  if (calibrate::shows_height(refined.height)) {
    out["seen_height_m"] = refined.height.height_m;
    out["seen_height_sigma_m"] = refined.height.sigma_m;
  }
  out["rms_mm"] = refined.rms_mm;
  out["p95_mm"] = refined.p95_mm;
  out["max_mm"] = refined.max_mm;
  out["rms_px"] = refined.rms_px;
  out["top_sigma_mm"] = refined.sigma.top_corner_mm;
  const bool is_good =
      refined.sigma.top_corner_mm <= kGoodTop_mm && refined.rms_mm <= kGoodRms_mm && report.doubts.empty();
  out["quality"] = quality(
      is_good ? "ok" : "warning",
      formatted("border and markings within %.2f mm (95 %% within %.2f mm); a robot's top in a "
                "corner is known to %.1f mm%s",
                refined.rms_mm, refined.p95_mm, refined.sigma.top_corner_mm, calibrate::assumption_of(report).c_str()),
      refined.rms_mm, "mm");
  return out;
}

}  // namespace

Result<void> find_field(const FieldRequest& request, const JobInput& input, const JobOutput& output) {
  const std::string venue = input.path(input.state.files.venue);
  TOUCHLINE_TRY_ASSIGN(const calibrate::VenueDraft draft, calibrate::read_draft(venue));
  TOUCHLINE_TRY_ASSIGN(const calibrate::ChosenField chosen, calibrate::choose_field(draft, request.choice));
  const FieldParameters& field = chosen.drawing.field;
  calibrate::FieldPictures pictures;
  for (const CameraFrame& frame : input.frames) pictures.pictures.push_back(calibrate::picture_of(frame->frame()));
  if (request.corners) {
    TOUCHLINE_TRY(calibrate::check_corners(*request.corners));
    pictures.points = calibrate::corner_points(*request.corners, static_cast<double>(field.length_m),
                                               static_cast<double>(field.width_m));
  }
  output.progress("the camera model is being fitted");
  Result<calibrate::FieldReport> found = calibrate::calibrate_field(pictures, chosen, request.choice.camera_height_m);
  if (!found.ok()) {
    const bool may_drag = !request.corners && found.code() != ErrorCode::kOutOfRange;
    return Error{found.code(), found.text() + (may_drag ? "; you can drag the corners yourself" : "")};
  }
  const calibrate::FieldReport& report = found.value();
  const hal::Picture& picture = pictures.pictures.front();
  TOUCHLINE_TRY(calibrate::write_sections(venue, calibrate::field_sections(draft, picture, field, report)));
  CameraModel camera;
  if (!camera.configure(report.fit.camera).ok()) {
    return Error{ErrorCode::kInconsistent, "the camera model found is invalid"};
  }
  nlohmann::json measured = measured_field(report, field, camera);
  measured["entered"] = {{"preset", request.choice.preset},
                         {"length_m", request.choice.length_m},
                         {"width_m", request.choice.width_m},
                         {"camera_height_m", request.choice.camera_height_m},
                         {"ignore_lines", request.choice.drawing == calibrate::kNoDrawing}};
  const std::string warning = calibrate::region_warning(draft.region_of_interest, picture, field, report.fit.camera);
  if (!warning.empty()) {
    measured["notes"].push_back({{"level", "warning"}, {"text", warning}});
    measured["quality"]["level"] = "warning";
  }
  output.measured(measured);
  if (report.refinement.points == 0) return {};
  output.progress("the error map is being drawn");
  TOUCHLINE_TRY_ASSIGN(const hal::Picture errors, calibrate::draw_errors(picture, report));
  return output.picture("error_map", errors);
}

}  // namespace touchline::setup
