#include "tools/programs/calibrate/field/field_calibration.h"

#include <algorithm>
#include <cmath>

#include "tools/programs/calibrate/field/field_overlay.h"
#include "tools/programs/calibrate/field/fit_consistency.h"
#include "tools/programs/calibrate/field/painted_lines.h"
#include "tools/programs/calibrate/field/paper_fit.h"
#include "tools/programs/calibrate/field/residual_map.h"
#include "tools/programs/calibrate/field/vanishing_points.h"
#include "tools/programs/calibrate/imaging/channel_image.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/command_line/progress.h"

namespace touchline::calibrate {
namespace {

// Copies the measures that Touchline only publishes to other programs.
void copy_markings(const FieldParameters& from, FieldParameters& to) {
  to.line_width_m = from.line_width_m;
  to.center_circle_m = from.center_circle_m;
  to.penalty_area_depth_m = from.penalty_area_depth_m;
  to.penalty_area_width_m = from.penalty_area_width_m;
}

Corners turned(const Corners& c) { return {c[1], c[2], c[3], c[0]}; }

// Returns every tenth point, so that the marks do not hide the photograph.
std::vector<FloorPoint> points_of(const RefinementReport& refinement) {
  std::vector<FloorPoint> points;
  for (std::size_t i = 0; i < refinement.found.size(); i += 10) {
    const MarkPoint& p = refinement.found[i];
    points.push_back({p.x_m, p.y_m, p.u_px, p.v_px});
  }
  return points;
}

std::vector<FloorPoint> all_points_of(const RefinementReport& refinement) {
  std::vector<FloorPoint> points;
  points.reserve(refinement.found.size());
  for (const MarkPoint& p : refinement.found) points.push_back({p.x_m, p.y_m, p.u_px, p.v_px});
  return points;
}

// Tries both orientations of the border: x to the right or upwards in the picture.
Result<void> fit_border(const LightPicture& picture, const ChosenField& chosen, const std::optional<double>& measured_m,
                        Progress& progress, FieldReport& report) {
  const FieldDrawing& drawing = chosen.drawing;
  struct Attempt {
    FieldFit fit;
    RefinementReport refinement;
    bool quarter_turned = false;
  };
  const BorderSearch& border = *report.border;
  const double length = static_cast<double>(drawing.field.length_m), width = static_cast<double>(drawing.field.width_m);
  std::vector<Attempt> good;
  std::optional<Error> first_error;
  for (const bool quarter_turned : {false, true}) {
    Attempt attempt;
    attempt.quarter_turned = quarter_turned;
    FieldFitInput input;
    input.width_px = picture.width_px();
    input.height_px = picture.height_px();
    input.camera_height_m = measured_m;
    input.start_only = true;
    const Corners& corners = border.straight_corners;
    input.points = corner_points(quarter_turned ? turned(corners) : corners, length, width);
    Result<void> result = fit_field(input, attempt.fit);
    if (!result.ok()) {
      result = prefixed("the bright region is not the border, or the picture cuts the field off", result.error());
    } else {
      // Uses Brown's model instead of eq. (12), fitted up to the corners of the field.
      FullModelParameters& full = attempt.fit.camera.full;
      double radius = 0;
      for (const PixelPoint& corner : border.corners) {
        radius = std::max(radius, std::hypot(static_cast<double>(corner.u_px) - 0.5 * (picture.width_px() - 1),
                                             static_cast<double>(corner.v_px) - 0.5 * (picture.height_px() - 1)));
      }
      const auto k = brown_of_eq12(border.h_px, static_cast<double>(full.fx_px), radius);
      full.k1 = static_cast<float>(k[0]);
      full.k2 = static_cast<float>(k[1]);
      full.k3 = static_cast<float>(k[2]);
      result = refine_field(picture, drawing.field, report.marks, chosen.height, attempt.fit, attempt.refinement);
      if (result.ok()) {
        good.push_back(std::move(attempt));
        progress.step();
        continue;
      }
    }
    progress.step();
    // Of the errors of both orientations, report the one for which the longer sides of field and picture are parallel.
    const auto distance = [&](std::size_t a, std::size_t b) {
      return std::hypot(static_cast<double>(corners[a].u_px - corners[b].u_px),
                        static_cast<double>(corners[a].v_px - corners[b].v_px));
    };
    const bool upright = distance(0, 1) + distance(2, 3) < distance(1, 2) + distance(3, 0);
    if (!first_error || (upright == (length >= width)) == quarter_turned) first_error = result.error();
  }
  if (good.empty()) return *first_error;
  std::sort(good.begin(), good.end(),
            [](const Attempt& a, const Attempt& b) { return a.refinement.points > b.refinement.points; });
  // Ratio of the numbers of points found above which both orientations fit equally well. A center line, which has at
  // least a tenth of the points, fits only one of them.
  constexpr double kAlike = 0.92;
  if (good.size() > 1 &&
      static_cast<double>(good[1].refinement.points) > kAlike * static_cast<double>(good[0].refinement.points)) {
    return Error{ErrorCode::kNotFound,
                 "the field looks the same when rotated by 90 degrees, and no marking shows the direction"};
  }
  report.fit = good[0].fit;
  report.refinement = std::move(good[0].refinement);
  report.steps =
      vanishing_point_model(border, good[0].quarter_turned, picture.width_px(), picture.height_px(), drawing.field);
  if (report.steps) report.steps_mm = paper_residual(report.steps->model, all_points_of(report.refinement));
  return {};
}

// Fits square pixels, or a free pixel aspect ratio with `fit_input.free_aspect`.
Result<void> fit_points_once(const FieldPictures& input, const LightPicture& light, const ChosenField& chosen,
                             FieldFitInput fit_input, FieldReport& found) {
  fit_input.start_only = input.refine;
  TOUCHLINE_TRY(fit_field(fit_input, found.fit));
  Result<void> refined;
  if (input.refine) {
    refined = refine_field(light, chosen.drawing.field, found.marks, chosen.height, found.fit, found.refinement);
  }
  found.unrefined = refined.text();
  if (refined.code() == ErrorCode::kInconsistent) return std::move(refined).error();
  // Without refinement, the camera model is computed from the given points only.
  if (!refined.ok() || !input.refine) {
    found.refinement = {};
    if (found.height == HeightSource::kRules) found.height = HeightSource::kSeen;
  }
  if (refined.ok()) return {};
  fit_input.start_only = false;
  if (const Result<void> fitted = fit_field(fit_input, found.fit); !fitted.ok()) {
    return Error{fitted.code(), "at the given points, the border was not recognized (" + found.unrefined +
                                    "), and from the points alone: " + fitted.text()};
  }
  return {};
}

// Some drivers stretch pictures of another aspect ratio to the requested size. The smallest usual stretch, from 5 : 4
// to 4 : 3, is a factor of 1.07. A smaller stretch comes from a wrong length or width of the field.
constexpr double kMinStretch = 0.05;

double stretch_of(const FieldFit& fit) {
  return static_cast<double>(fit.camera.full.fx_px) / static_cast<double>(fit.camera.full.fy_px) - 1;
}

// Fits square pixels first, and a free aspect ratio only if the border contradicts square pixels.
Result<void> fit_points(const FieldPictures& input, const LightPicture& light, const ChosenField& chosen,
                        const FieldFitInput& fit_input, FieldReport& found) {
  FieldReport stretched = found;
  Result<void> square = fit_points_once(input, light, chosen, fit_input, found);
  if (!input.refine || !fit_input.camera_height_m || (square.ok() && found.unrefined.empty())) return square;
  FieldFitInput free_input = fit_input;
  free_input.free_aspect = true;
  if (!fit_points_once(input, light, chosen, free_input, stretched).ok() || !stretched.unrefined.empty() ||
      std::abs(stretch_of(stretched.fit)) < kMinStretch || !check_center_markings(light, stretched, 0).ok()) {
    return square;
  }
  found = std::move(stretched);
  return {};
}

// Fits the border or the points, without comparing the person's entries with the picture.
Result<FieldReport> fit_pictures(const FieldPictures& input, const LightPicture& light, const ChosenField& field,
                                 double camera_height_m) {
  const hal::Picture& picture = input.pictures.front();
  const bool clicked = !input.points.empty();
  FieldReport found;
  found.marks = marks_of(field.drawing);
  found.height = field.height_source;
  found.points = input.points;
  FieldFitInput fit_input;
  fit_input.width_px = static_cast<int>(picture.width_px);
  fit_input.height_px = static_cast<int>(picture.height_px);
  fit_input.points = input.points;
  if (camera_height_m > 0) fit_input.camera_height_m = camera_height_m;
  // Steps: reading, border, one fit per orientation.
  Progress progress("field", clicked ? 2 : 4);
  progress.step();
  if (clicked) {
    TOUCHLINE_TRY(fit_points(input, light, field, fit_input, found));
    return found;
  }
  found.border.emplace();
  if (Result<void> border = find_border(picture, *found.border); !border.ok()) {
    return prefixed("the border of the field was not found", std::move(border).error());
  }
  progress.step();
  Result<void> fitted = fit_border(light, field, fit_input.camera_height_m, progress, found);
  if (!fitted.ok()) return prefixed("a border was found, but", std::move(fitted).error());
  return found;
}

// Rejects a given height that the picture contradicts: a fit without it is good, and its height is far off.
// kOutOfRange: the picture contradicts the height; the message says what was tried.
Result<void> check_height_given(const FieldPictures& input, const LightPicture& light, const ChosenField& field,
                                double camera_height_m, const Result<FieldReport>& with_height) {
  ChosenField unmeasured = field;
  unmeasured.height = field.rules;
  unmeasured.height_source = field.rules ? HeightSource::kRules : HeightSource::kSeen;
  const Result<FieldReport> free_fit = fit_pictures(input, light, unmeasured, 0);
  const bool is_found = free_fit.ok() && shows_height(free_fit.value().refinement.height);
  const HeightEvidence& evidence = is_found
                                       ? free_fit.value().refinement.height
                                       : (with_height.ok() ? with_height.value().refinement.height : HeightEvidence{});
  const double sigmas = std::abs(evidence.height_m - camera_height_m) / std::hypot(evidence.sigma_m, kHeightSigma_m);
  if (sigmas * sigmas < kImpossibleHeight) return {};
  return failure(ErrorCode::kOutOfRange,
                 "the camera is not %.2f m above the floor, as given (--camera-height): %s, from the perspective of "
                 "border and markings. Measure from the floor to the lens again%s",
                 camera_height_m, describe(evidence).c_str(),
                 is_found ? ", or give no height: the field is found without it" : "");
}

}  // namespace

Result<ChosenField> choose_field(const VenueDraft& venue, const FieldChoice& choice) {
  ChosenField out;
  const bool ignores_markings = choice.drawing == kNoDrawing, is_drawn = !choice.drawing.empty() && !ignores_markings;
  if (is_drawn && !choice.preset.empty()) {
    return Error{ErrorCode::kInconsistent, "a drawing and a preset of the field cannot be combined"};
  }
  FieldParameters field = venue.file.field;
  const bool sized = choice.length_m > 0 && choice.width_m > 0;
  if (is_drawn) {
    TOUCHLINE_TRY_ASSIGN(out.drawing, read_drawing(choice.drawing));
    field = out.drawing.field;
  } else if (!choice.preset.empty()) {
    const FieldPreset* known = find_preset(choice.preset);
    if (known == nullptr) {
      std::string text = "field preset " + choice.preset + " is unknown; the presets are";
      for (const FieldPreset& p : field_presets()) text += " " + std::string(p.name);
      return Error{ErrorCode::kNotFound, text};
    }
    out.drawing = known->drawing;
    out.height = known->height;
    const float margin = field.margin_m;
    field = out.drawing.field;
    field.margin_m = margin;
  } else if (!venue.exists && !sized) {
    return Error{ErrorCode::kInconsistent, "the size of the field is needed: a preset, a drawing, or length and width"};
  }
  if (choice.length_m > 0) field.length_m = static_cast<float>(choice.length_m);
  if (choice.width_m > 0) field.width_m = static_cast<float>(choice.width_m);
  const bool resized = choice.length_m > 0 || choice.width_m > 0;
  if (resized || (!is_drawn && choice.preset.empty())) {
    // The markings are known only if the field has the size of a league.
    const FieldPreset* league = find_preset(field.length_m, field.width_m);
    out.drawing = league != nullptr ? league->drawing : bare_drawing(field);
    out.height = league != nullptr ? league->height : std::nullopt;
    // A venue file without a preset keeps the values that a person has written into it.
    if (!choice.preset.empty() || !venue.exists) {
      copy_markings(league != nullptr ? league->drawing.field : FieldParameters{}, field);
    }
  }
  // Limit the goal's width, because the preset's goals are wider than a small field on a desk.
  if (resized && field.goal_width_m >= field.width_m) field.goal_width_m = field.goal_depth_m = 0.0f;
  out.drawing.field = field;
  if (ignores_markings) {
    out.drawing.line.clear();
    out.drawing.arc.clear();
  }
  out.rules = out.height;
  if (out.height) out.height_source = HeightSource::kRules;
  if (choice.camera_height_m > 0) {
    out.height = HeightPrior{choice.camera_height_m, kHeightSigma_m};
    out.height_source = HeightSource::kMeasured;
  }
  return out;
}

Result<FieldReport> calibrate_field(const FieldPictures& input, const ChosenField& field, double camera_height_m) {
  const hal::Picture& picture = input.pictures.front();
  for (const hal::Picture& other : input.pictures) {
    if (other.width_px == picture.width_px && other.height_px == picture.height_px) continue;
    return failure(ErrorCode::kInconsistent, "the pictures have different sizes: %u x %u and %u x %u", picture.width_px,
                   picture.height_px, other.width_px, other.height_px);
  }
  const bool clicked = !input.points.empty();
  if (clicked && input.points.size() < 4) {
    return Error{ErrorCode::kInconsistent, "at least four corners and points are needed, or none"};
  }
  const double right = picture.width_px - 0.5, bottom = picture.height_px - 0.5;
  for (const FloorPoint& p : input.points) {
    if (p.u_px >= -0.5 && p.v_px >= -0.5 && p.u_px <= right && p.v_px <= bottom) continue;
    return failure(
        ErrorCode::kOutOfRange,
        "pixel %.0f,%.0f, given for the place (%.2f, %.2f) m, lies outside of the picture, which has %u x %u "
        "pixels",
        p.u_px, p.v_px, p.x_m, p.y_m, picture.width_px, picture.height_px);
  }
  const LightPicture light(input.pictures);
  Result<FieldReport> fitted = fit_pictures(input, light, field, camera_height_m);
  if (camera_height_m > 0 && (!fitted.ok() || contradicts(fitted.value().refinement.height))) {
    if (Result<void> height = check_height_given(input, light, field, camera_height_m, fitted); !height.ok()) {
      return std::move(height).error();
    }
  }
  if (!fitted.ok()) return fitted;
  FieldReport& report = fitted.value();
  // Tolerance in the middle of the field, for unknown distortion and for errors of the clicks. Points clicked on
  // markings also show how accurately this field is painted.
  const double tolerance_m = (report.fit.has_distortion ? 0.0 : distortion_effect_m(report.fit.camera, report.points)) +
                             report.fit.residual_mm.rms / 1e3;
  TOUCHLINE_TRY(check_center_markings(light, report, tolerance_m));
  report.doubts = height_doubts(report, field.rules, light.width_px());
  bool is_round = false;  // A circle distinguishes stretched pixels from a wrong length or width.
  for (std::size_t m = 0; m < report.refinement.marks.size(); ++m) {
    is_round |= report.marks[m].radius_m > 0 && report.refinement.marks[m].used;
  }
  if (std::abs(stretch_of(report.fit)) >= kMinStretch && !is_round) {
    report.doubts.push_back(formatted(
        "the pixels of this picture are %.2f times as high as wide, or length or width of the field is wrong by as "
        "much: compare with a tape, and prefer a camera mode that does not stretch",
        1 + stretch_of(report.fit)));
  }
  return fitted;
}

std::vector<Section> field_sections(const VenueDraft& venue, const hal::Picture& picture, const FieldParameters& field,
                                    const FieldReport& report) {
  config::PictureEntry entry = venue.file.picture;
  entry.width_px = static_cast<std::uint16_t>(picture.width_px);
  entry.height_px = static_cast<std::uint16_t>(picture.height_px);
  return {section_of("picture", entry, ""), section_of("field", painted_field(field, report), ""),
          section_of("camera_model", report.fit.camera, residual_text(report))};
}

std::string region_warning(const Polygon& region, const hal::Picture& picture, const FieldParameters& field,
                           const CameraParameters& camera) {
  constexpr int kSteps = 50;  // samples along each side of the field
  CameraModel model;
  if (!model.configure(camera).ok()) return "";
  const int width = static_cast<int>(picture.width_px), height = static_cast<int>(picture.height_px);
  const std::vector<std::uint8_t> inside = inside_mask(region, width, height);
  int seen = 0, left_out = 0;
  for (int j = 0; j <= kSteps; ++j) {
    for (int i = 0; i <= kSteps; ++i) {
      const FieldPoint place{field.length_m * (static_cast<float>(i) / kSteps - 0.5f),
                             field.width_m * (static_cast<float>(j) / kSteps - 0.5f)};
      const PixelPoint pixel = model.to_pixel(place, 0.0f);
      const long u = std::lround(pixel.u_px), v = std::lround(pixel.v_px);
      // Skip parts of the field outside the picture, which no region could contain.
      if (u < 0 || v < 0 || u >= width || v >= height) continue;
      ++seen;
      left_out += inside[static_cast<std::size_t>(v * width + u)] == 0 ? 1 : 0;
    }
  }
  if (left_out == 0) return "";
  return formatted(
      "the region of interest leaves out %.*f %% of the field, where nothing is seen; if it was made for "
      "another view of the camera, remove section [region_of_interest] of the venue file",
      100 * left_out < seen ? 1 : 0, 100.0 * left_out / seen);
}

Result<hal::Picture> draw_result(const hal::Picture& picture, const FieldParameters& field, const FieldReport& report) {
  CameraModel camera;
  if (!camera.configure(report.fit.camera).ok()) {
    return Error{ErrorCode::kInconsistent, "the camera model found is invalid"};
  }
  hal::Picture drawn = picture;
  const bool refined = report.refinement.points > 0;
  draw_field(camera, field, report.marks, refined ? points_of(report.refinement) : report.points, drawn);
  return drawn;
}

Result<hal::Picture> draw_errors(const hal::Picture& picture, const FieldReport& report) {
  CameraModel camera;
  if (!camera.configure(report.fit.camera).ok()) {
    return Error{ErrorCode::kInconsistent, "the camera model found is invalid"};
  }
  return draw_residuals(picture, camera, report.refinement);
}

}  // namespace touchline::calibrate
