#include "tools/programs/calibrate/light/light_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "firmware/config/light_writer.h"
#include "tools/programs/calibrate/light/light_fit.h"
#include "tools/programs/calibrate/venue/venue_draft.h"
#include "tools/programs/command_line/progress.h"

namespace touchline::calibrate {

namespace {

// From this number on, pictures are assumed to show a game unless --surface is given.
constexpr std::size_t kManyPictures = 12;
// The mask ends this far inside the border, which is 2 to 5 cm wide and has a blurred edge.
constexpr float kInsideBorder_m = 0.03f;

// Returns false if the venue has no camera model yet.
bool camera_of(const VenueDraft& draft, CameraModel& camera) {
  const CameraParameters& model = draft.file.camera_model;
  return (model.kind == CameraModelKind::kFull ? model.full.fx_px : model.paper.focal_px) > 0 &&
         camera.configure(model).ok();
}

// Marks the pixels that show the floor inside the border.
std::vector<std::uint8_t> floor_mask(const VenueDraft& draft, const CameraModel& camera, const hal::Picture& picture) {
  std::vector<std::uint8_t> mask;
  mask.reserve(std::size_t{picture.width_px} * picture.height_px);
  const float x = draft.file.field.length_m / 2 - kInsideBorder_m, y = draft.file.field.width_m / 2 - kInsideBorder_m;
  for (std::uint32_t v = 0; v < picture.height_px; ++v) {
    for (std::uint32_t u = 0; u < picture.width_px; ++u) {
      const FieldPoint p = camera.to_field({static_cast<float>(u), static_cast<float>(v)}, 0.0f);
      mask.push_back(std::abs(p.x_m) < x && std::abs(p.y_m) < y ? 1 : 0);
    }
  }
  return mask;
}

// Reads C of the map that the venue's colors were learned with.
Result<void> read_normal(const std::string& venue, const config::LightEntry& entry, const std::string& measured_on,
                         std::optional<std::array<double, 3>>& normal) {
  if (entry.normal.size() != 3) {
    return Error{
        ErrorCode::kNotFound,
        venue + ": light.normal is missing: measure the light without --keep-normal, then learn the " + "colors"};
  }
  // Pictures of a game show the same floor as pictures of the empty field.
  const auto surface_of = [](const std::string& surface) { return surface == "moving" ? "field" : surface; };
  if (surface_of(entry.surface) != surface_of(measured_on)) {
    return Error{ErrorCode::kInconsistent,
                 venue + ": light.surface: the colors were learned with a map of surface " + entry.surface +
                     "; --keep-normal needs pictures of the same surface, not of " + measured_on};
  }
  normal = {static_cast<double>(entry.normal[0]), static_cast<double>(entry.normal[1]),
            static_cast<double>(entry.normal[2])};
  return {};
}

}  // namespace

void LightCommand::add_options(CLI::App& app) {
  app.add_option("--picture", pictures, "Reference picture; repeatable, see --surface")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--venue", venue, "Venue file; the map is written to the same folder")->required();
  app.add_option(
         "--surface", surface,
         "Subject of the pictures. grey: the field covered with grey paper; field: the empty field (lines and\n"
         "goals are ignored); moving: a few dozen pictures of a game (moving objects are ignored); border: the\n"
         "white border around the field, for a floor that reflects the lamps. Default: grey; moving for 12 or\n"
         "more pictures")
      ->check(CLI::IsMember({"grey", "field", "moving", "border"}));
  app.add_flag(
      "--keep-normal", keep_normal,
      "Keep the learned colors although the lamps have changed: the map is relative to the light in which the\n"
      "colors were learned. Needs pictures of the same surface as then");
}

Result<void> LightCommand::run() const {
  TOUCHLINE_TRY_ASSIGN(const VenueDraft draft, read_draft(venue));
  LightFitInput input;
  const bool many = surface.empty() && pictures.size() >= kManyPictures;
  const std::string measured_on = !surface.empty() ? surface : many ? "moving" : "grey";
  if (keep_normal) TOUCHLINE_TRY(read_normal(venue, draft.file.light, measured_on, input.normal));
  if (measured_on == "moving") {
    input.surface = LightSurface::kMoving;
  } else if (measured_on == "field") {
    input.surface = LightSurface::kField;
  } else if (measured_on == "border") {
    input.surface = LightSurface::kBorder;
  }
  Progress progress("pictures", pictures.size());
  for (const std::string& path : pictures) {
    TOUCHLINE_TRY_ASSIGN(hal::Picture picture, hal::read_picture(path));
    input.pictures.push_back(std::move(picture));
    progress.step();
  }
  input.region_of_interest = draft.region_of_interest;
  CameraModel camera;
  const hal::Picture& first = input.pictures.front();
  if (input.surface != LightSurface::kGreyPaper && camera_of(draft, camera)) {
    input.floor = floor_mask(draft, camera, first);
    input.border = border_places(camera, draft.file.field, first.width_px, first.height_px);
  } else if (input.surface == LightSurface::kBorder) {
    return Error{ErrorCode::kInconsistent,
                 venue + ": --surface border needs the camera model: run touchline-calibrate field first"};
  }
  LightMap map;
  LightReport report;
  TOUCHLINE_TRY(fit_light(input, map, report));

  config::LightEntry entry;
  entry.surface = measured_on;
  for (const double value : report.normal) entry.normal.push_back(static_cast<float>(value));
  Result<std::string> png = hal::encode_png(map_picture(map));
  if (!png.ok()) return prefixed(venue, std::move(png).error());
  TOUCHLINE_TRY_ASSIGN(const std::string map_path, config::write_light(venue, png.value(), entry));

  constexpr const char* kNames[] = {"red", "green", "blue"};
  for (std::size_t c = 0; c < 3; ++c) {
    std::printf("%-5s illumination %.2f to %.2f (%.2f : 1); 1 stands for the value %.1f\n", kNames[c], report.least[c],
                report.most[c], report.most[c] / report.least[c], report.normal[c]);
  }
  std::printf("%u x %u cells, %zu measured%s: %zu saturated, %zu too dark, %zu beyond the range of a map\n",
              map.columns, map.rows, report.known_cells,
              input.surface == LightSurface::kGreyPaper ? ""
              : measured_on == "border"                 ? " from the border"
                                                        : " on plain floor",
              report.saturated_cells, report.dark_cells, report.clamped_cells);
  constexpr std::size_t kShown = 6;
  for (std::size_t i = 0; i < std::min(kShown, report.spots.size()); ++i) {
    const LightSpot& spot = report.spots[i];
    std::printf("%s: %zu cells in u %zu to %zu, v %zu to %zu\n", spot.saturated ? "saturated" : "too dark", spot.cells,
                spot.left_px, spot.right_px, spot.top_px, spot.bottom_px);
  }
  if (report.spots.size() > kShown) std::printf("and %zu smaller spots\n", report.spots.size() - kShown);
  std::printf("%s written, %s: [light] written\n", map_path.c_str(), venue.c_str());
  if (!draft.file.color.empty() && !keep_normal) {
    std::printf(
        "the colors were learned with another map: learn them again, or measure the light with --keep-normal\n");
  }
  return {};
}

}  // namespace touchline::calibrate
