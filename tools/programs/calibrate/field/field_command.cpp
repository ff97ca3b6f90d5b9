#include "tools/programs/calibrate/field/field_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "tools/programs/calibrate/field/border_search.h"
#include "tools/programs/calibrate/field/field_drawing.h"
#include "tools/programs/calibrate/field/field_fit.h"
#include "tools/programs/calibrate/field/field_overlay.h"
#include "tools/programs/calibrate/field/field_refinement.h"
#include "tools/programs/calibrate/field/field_report.h"
#include "tools/programs/calibrate/field/paper_fit.h"
#include "tools/programs/calibrate/field/residual_map.h"
#include "tools/programs/calibrate/field/vanishing_points.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"
#include "tools/programs/calibrate/venue/venue_draft.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/command_line/progress.h"

namespace touchline {
namespace {

// Parses numbers that are separated by commas.
template <std::size_t N>
bool parse_numbers(const std::string& text, std::array<double, N>& out) {
  const std::vector<std::string> words = CLI::detail::split(text, ',');
  if (words.size() != N) return false;
  for (std::size_t i = 0; i < N; ++i) {
    if (!CLI::detail::lexical_cast(words[i], out[i]) || !std::isfinite(out[i])) return false;
  }
  return true;
}

}  // namespace

// CLI11 finds these functions by the type of an option's variable, hence in the namespaces of the types. "u,v":
static bool lexical_cast(const std::string& text, PixelPoint& out) {
  std::array<double, 2> n{};
  if (!parse_numbers(text, n)) return false;
  out = {static_cast<float>(n[0]), static_cast<float>(n[1])};
  return true;
}

namespace calibrate {

// "x,y,u,v"
static bool lexical_cast(const std::string& text, FloorPoint& out) {
  std::array<double, 4> n{};
  if (!parse_numbers(text, n)) return false;
  out = {n[0], n[1], n[2], n[3]};
  return true;
}

namespace {

Result<std::vector<hal::Picture>> load_photographs(const std::vector<std::string>& paths) {
  std::vector<hal::Picture> out;
  for (const std::string& path : paths) {
    TOUCHLINE_TRY_ASSIGN(hal::Picture picture, load_rgb(path));
    if (!out.empty() && (picture.width_px != out[0].width_px || picture.height_px != out[0].height_px)) {
      return failure(ErrorCode::kInconsistent, "%s is %u x %u, but %s is %u x %u", path.c_str(), picture.width_px,
                     picture.height_px, paths[0].c_str(), out[0].width_px, out[0].height_px);
    }
    out.push_back(std::move(picture));
  }
  return out;
}

// The measures that are only published to other programs.
void copy_markings(const FieldParameters& from, FieldParameters& to) {
  to.line_width_m = from.line_width_m;
  to.center_circle_m = from.center_circle_m;
  to.penalty_area_depth_m = from.penalty_area_depth_m;
  to.penalty_area_width_m = from.penalty_area_width_m;
}

Corners turned(const Corners& c) { return {c[1], c[2], c[3], c[0]}; }

// Every tenth point, so that the photograph remains visible.
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
Result<void> fit_border(const LightPicture& picture, const FieldDrawing& drawing,
                        const std::optional<HeightPrior>& height, const std::optional<double>& measured_m,
                        Progress& progress, FieldReport& report) {
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
      // Brown's model instead of eq. (12), as far as the corners of the field.
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
      result = refine_field(picture, drawing.field, report.marks, height, attempt.fit, attempt.refinement);
      if (result.ok()) {
        good.push_back(std::move(attempt));
        progress.step();
        continue;
      }
    }
    progress.step();
    // Reports the error of the orientation in which the longer sides of field and picture are parallel.
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
  // The markings inside the border distinguish both orientations: a center line has at least a tenth of the points.
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

}  // namespace

void FieldCommand::add_options(CLI::App& app) {
  app.add_option("--picture", pictures,
                 "Picture of the field as the camera delivers it; repeatable, pictures are averaged")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--venue", venue, "Venue file; created if it does not exist")->required();
  app.add_option(
         "--corners", corners,
         "Pixels u,v of the corners of the field: -x-y +x-y +x+y -x+y (x along the field). Without corners and\n"
         "points, the program searches the bright border; x then points to the right or upwards in the picture")
      ->expected(4);
  app.add_option("--point", points, "x,y,u,v: a point on the floor (m) and its pixel; repeatable")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--field-preset", preset,
                 "Size of field and goals, and markings: mirosot-middle, vsss, ssl-a (or ssl), ssl-b");
  app.add_option("--drawing", drawing,
                 "TOML file with size, border, lines and arcs of the field (docs/calibration.md)");
  app.add_option("--length", length_m, "Length of the field, m")->check(number_range(0.3, 30.0));
  app.add_option("--width", width_m, "Width of the field, m")->check(number_range(0.3, 30.0));
  app.add_option("--camera-height", camera_height_m, "Measured height of the lens above the floor, m")
      ->check(number_range(0.3, 20.0));
  app.add_option("--kind", kind, "Camera model that the firmware uses: full, or paper (Klancar eq. 12-15)")
      ->check(CLI::IsMember({"full", "paper"}));
  app.add_flag_callback(
      "--no-refine", [this] { refine = false; }, "Use only the given points, without refinement along the border");
  app.add_option("--roi", region, "Pixels u,v of the corners of the region of interest, three or more");
  app.add_option(
      "--preview", preview,
      "PNG file to write: border and markings according to the model; the residuals are drawn in NAME-errors.png");
  app.add_option("--report", report, "JSON file to write with the complete report");
}

Result<void> FieldCommand::choose_drawing(const VenueDraft& draft, FieldDrawing& out,
                                          std::optional<HeightPrior>& height) const {
  if (!drawing.empty() && !preset.empty()) {
    return Error{ErrorCode::kInconsistent, "--drawing and --field-preset cannot be combined"};
  }
  FieldParameters field = draft.file.field;
  if (!drawing.empty()) {
    TOUCHLINE_TRY_ASSIGN(out, read_drawing(drawing));
    field = out.field;
  } else if (!preset.empty()) {
    const FieldPreset* known = find_preset(preset);
    if (known == nullptr) {
      std::string text = "--field-preset: " + preset + " is unknown; the presets are";
      for (const FieldPreset& p : field_presets()) text += " " + std::string(p.name);
      return Error{ErrorCode::kNotFound, text};
    }
    out = known->drawing;
    height = known->height;
    const float margin = field.margin_m;
    field = out.field;
    field.margin_m = margin;
  } else if (!draft.exists && (length_m <= 0 || width_m <= 0)) {
    return Error{ErrorCode::kInconsistent,
                 "the size of the field is needed: --field-preset, --drawing, or --length and --width"};
  }
  const bool resized = length_m > 0 || width_m > 0;
  if (length_m > 0) field.length_m = static_cast<float>(length_m);
  if (width_m > 0) field.width_m = static_cast<float>(width_m);
  if (resized || (drawing.empty() && preset.empty())) {
    // The markings are known only for the size of a league.
    const FieldPreset* league = find_preset(field.length_m, field.width_m);
    out = league != nullptr ? league->drawing : bare_drawing(field);
    height = league != nullptr ? league->height : std::nullopt;
    // A venue file without a preset keeps what somebody wrote into it.
    if (!preset.empty() || !draft.exists) {
      copy_markings(league != nullptr ? league->drawing.field : FieldParameters{}, field);
    }
  }
  out.field = field;
  return {};
}

Result<void> FieldCommand::write_previews(const hal::Picture& photograph, const FieldReport& found,
                                          const FieldParameters& field, const std::vector<FloorPoint>& given) const {
  CameraModel camera;
  if (!camera.configure(found.fit.camera).ok()) {
    return Error{ErrorCode::kInconsistent, "the camera model found is invalid"};
  }
  hal::Picture drawn = photograph;
  const bool refined = found.refinement.points > 0;
  draw_field(camera, field, found.marks, refined ? points_of(found.refinement) : given, drawn);
  TOUCHLINE_TRY(hal::write_picture(preview, drawn));
  if (!refined) return {};
  const std::filesystem::path path(preview);
  const std::string errors = (path.parent_path() / (path.stem().string() + "-errors.png")).string();
  return hal::write_picture(errors, draw_residuals(photograph, camera, found.refinement));
}

Result<void> FieldCommand::find_camera(const std::vector<hal::Picture>& photographs, const FieldDrawing& drawn,
                                       const std::optional<HeightPrior>& height, FieldFitInput& input,
                                       FieldReport& found) const {
  // Steps: reading, border, one fit per orientation.
  const bool clicked = !input.points.empty();
  Progress progress("field", clicked ? 2 : 4);
  const LightPicture light(photographs);
  progress.step();
  if (!clicked) {
    found.border.emplace();
    if (const Result<void> border = find_border(photographs[0], *found.border); !border.ok()) {
      return prefixed("no --corners or --point are given, and the border was not found in " + pictures[0],
                      border.error());
    }
    progress.step();
    const Result<void> fitted = fit_border(light, drawn, height, input.camera_height_m, progress, found);
    if (!fitted.ok()) {
      return Error{fitted.code(),
                   "a border was found in " + pictures[0] + ", but " + fitted.text() + " (try --corners)"};
    }
  } else {
    input.start_only = refine;
    TOUCHLINE_TRY(fit_field(input, found.fit));
    Result<void> refined;
    if (refine) refined = refine_field(light, drawn.field, found.marks, height, found.fit, found.refinement);
    found.unrefined = refined.text();
    if (refined.code() == ErrorCode::kInconsistent) {
      return Error{refined.code(), found.unrefined + " (--no-refine skips the refinement)"};
    }
    // Without refinement, the camera model follows from the given points alone.
    if (!refined.ok() || !refine) {
      found.refinement = {};
      if (found.height == HeightSource::kRules) found.height = HeightSource::kSeen;
    }
    if (!refined.ok()) {
      input.start_only = false;
      if (const Result<void> fitted = fit_field(input, found.fit); !fitted.ok()) {
        return Error{fitted.code(), fitted.text() + "; and " + found.unrefined};
      }
    }
  }
  return {};
}

Result<void> FieldCommand::run() const {
  const auto begin = std::chrono::steady_clock::now();
  TOUCHLINE_TRY_ASSIGN(const VenueDraft draft, read_draft(venue));
  TOUCHLINE_TRY_ASSIGN(const std::vector<hal::Picture> photographs, load_photographs(pictures));
  const hal::Picture& photograph = photographs[0];

  FieldDrawing drawn;
  std::optional<HeightPrior> height;
  TOUCHLINE_TRY(choose_drawing(draft, drawn, height));
  const FieldParameters& field = drawn.field;
  FieldReport found;
  found.marks = marks_of(drawn);
  if (height) found.height = HeightSource::kRules;
  if (camera_height_m > 0) {
    height = HeightPrior{camera_height_m, kHeightSigma_m};
    found.height = HeightSource::kMeasured;
  }

  FieldFitInput input;
  input.width_px = static_cast<int>(photograph.width_px);
  input.height_px = static_cast<int>(photograph.height_px);
  if (camera_height_m > 0) input.camera_height_m = camera_height_m;
  if (!corners.empty()) {
    const Corners four = {corners[0], corners[1], corners[2], corners[3]};
    if (const Result<void> checked = check_corners(four); !checked.ok()) return prefixed("--corners", checked.error());
    input.points = corner_points(four, static_cast<double>(field.length_m), static_cast<double>(field.width_m));
  }
  input.points.insert(input.points.end(), points.begin(), points.end());
  const bool clicked = !input.points.empty();
  if (clicked && input.points.size() < 4)
    return Error{ErrorCode::kInconsistent, "at least four corners and points are needed, or none"};
  if (!region.empty() && (region.size() < 3 || region.size() > kMaxPolygonPoints)) {
    return Error{ErrorCode::kInconsistent,
                 formatted("--roi: there are %zu corners; 3 to %zu are possible", region.size(), kMaxPolygonPoints)};
  }

  TOUCHLINE_TRY(find_camera(photographs, drawn, height, input, found));
  found.points = input.points;
  FieldFit& fit = found.fit;
  fit.camera.kind = kind == "paper" ? CameraModelKind::kPaper : CameraModelKind::kFull;
  found.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  config::PictureEntry entry = draft.file.picture;
  entry.width_px = static_cast<std::uint16_t>(photograph.width_px);
  entry.height_px = static_cast<std::uint16_t>(photograph.height_px);
  std::vector<Section> sections = {section_of("picture", entry, ""), section_of("field", field, ""),
                                   section_of("camera_model", fit.camera, residual_text(found))};
  if (!region.empty()) {
    config::RegionOfInterestEntry roi;
    for (const PixelPoint& p : region) {
      roi.u_px.push_back(p.u_px);
      roi.v_px.push_back(p.v_px);
    }
    sections.push_back(section_of("region_of_interest", roi, ""));
  }
  if (!preview.empty()) TOUCHLINE_TRY(write_previews(photograph, found, field, input.points));
  if (!report.empty()) TOUCHLINE_TRY(write_json(found, report));
  TOUCHLINE_TRY(write_sections(venue, sections));

  std::printf("%s%.1f s\n", text_of(found).c_str(), found.seconds);
  std::printf("%s: [picture], [field], [camera_model]%s written\n", venue.c_str(),
              region.empty() ? "" : ", [region_of_interest]");
  return {};
}

}  // namespace calibrate
}  // namespace touchline
