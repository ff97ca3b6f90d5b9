#include "tools/programs/calibrate/field/field_command.h"

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "tools/programs/calibrate/field/field_calibration.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/command_line/formatted.h"

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

// These functions are in the namespaces of their types, where CLI11 finds them by the type of an option's variable.
// Parses "u,v".
static bool lexical_cast(const std::string& text, PixelPoint& out) {
  std::array<double, 2> n{};
  if (!parse_numbers(text, n)) return false;
  out = {static_cast<float>(n[0]), static_cast<float>(n[1])};
  return true;
}

namespace calibrate {

// Parses "x,y,u,v".
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

}  // namespace

void FieldCommand::add_options(CLI::App& app) {
  app.add_option("--picture", pictures,
                 "Picture of the field as the camera delivers it; repeatable, pictures are averaged")
      ->required()
      ->type_name("FILE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--venue", venue, "Venue file; created if it does not exist")->required()->type_name("FILE");
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
  app.add_option(
         "--drawing", drawing,
         "TOML file with size, border, lines and arcs of the field (docs/calibration.md), or none: only the border\n"
         "counts, whatever is painted inside it")
      ->type_name("FILE");
  app.add_option("--length", length_m, "Length of the field, m")->check(number_range(0.1, 30.0));
  app.add_option("--width", width_m, "Width of the field, m")->check(number_range(0.1, 30.0));
  app.add_option("--camera-height", camera_height_m, "Measured height of the lens above the floor, m")
      ->check(number_range(0.1, 20.0));
  app.add_option("--kind", kind, "Camera model that the firmware uses: full, or paper (Klancar eq. 12-15)")
      ->check(one_of({"full", "paper"}));
  app.add_flag_callback(
      "--no-refine", [this] { refine = false; }, "Use only the given points, without refinement along the border");
  app.add_option("--roi", region, "Pixels u,v of the corners of the region of interest, three or more");
  app.add_option(
         "--preview", preview,
         "PNG file to write: border and markings according to the model; the residuals are drawn in NAME-errors.png")
      ->type_name("FILE");
  app.add_option("--report", report, "JSON file to write with the complete report")->type_name("FILE");
  add_examples(
      app, {{"touchline-calibrate field --picture empty.png --venue venue.toml --field-preset vsss --camera-height 2.4",
             "find the border by itself"},
            {"touchline-calibrate field --picture empty.png --venue venue.toml --length 2.2 --width 1.8 --corners "
             "82,410 560,418 548,61 95,57",
             "begin with these corners"}});
}

Result<void> FieldCommand::write_previews(const hal::Picture& photograph, const FieldReport& found,
                                          const FieldParameters& field) const {
  TOUCHLINE_TRY_ASSIGN(const hal::Picture drawn, draw_result(photograph, field, found));
  TOUCHLINE_TRY(hal::write_picture(preview, drawn));
  if (found.refinement.points == 0) return {};
  const std::filesystem::path path(preview);
  TOUCHLINE_TRY_ASSIGN(const hal::Picture errors, draw_errors(photograph, found));
  return hal::write_picture((path.parent_path() / (path.stem().string() + "-errors.png")).string(), errors);
}

Result<void> FieldCommand::run() const {
  const auto begin = std::chrono::steady_clock::now();
  TOUCHLINE_TRY_ASSIGN(const VenueDraft draft, read_draft(venue));
  FieldPictures input;
  TOUCHLINE_TRY_ASSIGN(input.pictures, load_photographs(pictures));
  input.refine = refine;
  const hal::Picture& photograph = input.pictures[0];
  TOUCHLINE_TRY_ASSIGN(const ChosenField chosen,
                       choose_field(draft, {preset, drawing, length_m, width_m, camera_height_m}));
  const FieldParameters& field = chosen.drawing.field;
  if (!corners.empty()) {
    const Corners four = {corners[0], corners[1], corners[2], corners[3]};
    if (const Result<void> checked = check_corners(four); !checked.ok()) return prefixed("--corners", checked.error());
    input.points = corner_points(four, static_cast<double>(field.length_m), static_cast<double>(field.width_m));
  }
  input.points.insert(input.points.end(), points.begin(), points.end());
  if (!region.empty() && (region.size() < 3 || region.size() > kMaxPolygonPoints)) {
    return Error{ErrorCode::kInconsistent,
                 formatted("--roi: there are %zu corners; 3 to %zu are possible", region.size(), kMaxPolygonPoints)};
  }
  Polygon roi_polygon;
  for (const PixelPoint& p : region) roi_polygon.push_back(p);
  if (const std::optional<CrossingSides> crossing = crossing_sides(roi_polygon)) {
    return failure(ErrorCode::kInconsistent,
                   "--roi: the sides that begin at corners %zu and %zu cross or touch; give the corners in their order "
                   "around the region",
                   crossing->first + 1, crossing->second + 1);
  }

  Result<FieldReport> calibrated = calibrate_field(input, chosen, camera_height_m);
  if (!calibrated.ok()) {
    // If the picture contradicts the given values, another search for the border cannot help.
    const bool contradicted = calibrated.code() == ErrorCode::kOutOfRange;
    const bool skippable = refine && calibrated.code() == ErrorCode::kInconsistent;
    const char* const advice = contradicted ? ""
                               : input.points.empty()
                                   ? "; you can give the corners of the field (--corners), or, if it "
                                     "has no visible border, four or more known points, such as ends "
                                     "of lines (--point X,Y,U,V)"
                               : skippable ? " (--no-refine skips the refinement)"
                                           : "";
    return Error{calibrated.code(), pictures[0] + ": " + calibrated.text() + advice};
  }
  FieldReport& found = calibrated.value();
  found.fit.camera.kind = kind == "paper" ? CameraModelKind::kPaper : CameraModelKind::kFull;
  found.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::vector<Section> sections = field_sections(draft, photograph, field, found);
  Polygon searched = draft.region_of_interest;
  if (!region.empty()) {
    searched = roi_polygon;
    config::RegionOfInterestEntry roi;
    for (const PixelPoint& p : region) {
      roi.u_px.push_back(p.u_px);
      roi.v_px.push_back(p.v_px);
    }
    sections.push_back(section_of("region_of_interest", roi, ""));
  }
  if (!preview.empty()) TOUCHLINE_TRY(write_previews(photograph, found, field));
  if (!report.empty()) TOUCHLINE_TRY(write_json(found, report));
  TOUCHLINE_TRY(write_sections(venue, sections));

  std::printf("%s%.1f s\n", text_of(found).c_str(), found.seconds);
  std::printf("%s: [picture], [field], [camera_model]%s written\n", venue.c_str(),
              region.empty() ? "" : ", [region_of_interest]");
  if (const std::string warning = region_warning(searched, photograph, field, found.fit.camera); !warning.empty()) {
    std::fprintf(stderr, "%s: warning: %s\n", venue.c_str(), warning.c_str());
  }
  return {};
}

}  // namespace calibrate
}  // namespace touchline
