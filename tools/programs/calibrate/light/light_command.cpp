#include "tools/programs/calibrate/light/light_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>

#include "tools/programs/calibrate/light/light_calibration.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/command_line/progress.h"

namespace touchline::calibrate {

namespace {

// At this number of pictures or more, they are assumed to show a game unless --surface is given.
constexpr std::size_t kManyPictures = 12;
}  // namespace

void LightCommand::add_options(CLI::App& app) {
  app.add_option("--picture", pictures, "Reference picture; repeatable, see --surface")
      ->required()
      ->type_name("FILE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--venue", venue, "Venue file; the map is written to the same folder")->required()->type_name("FILE");
  app.add_option(
         "--surface", surface,
         "Subject of the pictures. grey: the field covered with grey paper; field: the empty field (lines and\n"
         "goals are ignored); moving: a few dozen pictures of a game (moving objects are ignored); border: the\n"
         "white border around the field, for a floor that reflects the lamps. Default: grey; moving for 12 or\n"
         "more pictures")
      ->check(one_of({"grey", "field", "moving", "border"}));
  app.add_flag(
      "--keep-normal", keep_normal,
      "Keep the learned colors although the lamps have changed: the map is relative to the light in which the\n"
      "colors were learned. Needs pictures of the surface that the former map was measured on");
  add_examples(
      app,
      {{"touchline-calibrate light --picture grey.png --venue venue.toml", "from the field under grey paper"},
       {"touchline-calibrate light --picture empty.png --venue venue.toml --surface field", "from the empty field"}});
}

Result<void> LightCommand::run() const {
  const bool many = surface.empty() && pictures.size() >= kManyPictures;
  const std::string measured_on = !surface.empty() ? surface : many ? "moving" : "grey";
  std::vector<hal::Picture> loaded;
  Progress progress("pictures", pictures.size());
  for (const std::string& path : pictures) {
    TOUCHLINE_TRY_ASSIGN(hal::Picture picture, hal::read_picture(path));
    loaded.push_back(std::move(picture));
    progress.step();
  }
  TOUCHLINE_TRY_ASSIGN(const LightCalibration light,
                       calibrate_light(venue, std::move(loaded), measured_on, keep_normal));
  const LightReport& report = light.report;

  constexpr const char* kNames[] = {"red", "green", "blue"};
  for (std::size_t c = 0; c < 3; ++c) {
    std::printf("%-5s illumination %.2f to %.2f (%.2f : 1); 1 stands for the value %.1f\n", kNames[c], report.least[c],
                report.most[c], report.most[c] / report.least[c], report.normal[c]);
  }
  std::printf("%u x %u cells, %zu measured%s: %zu saturated, %zu too dark, %zu beyond the range of a map\n",
              light.map.columns, light.map.rows, report.known_cells,
              measured_on == "grey"     ? ""
              : measured_on == "border" ? " from the border"
                                        : " on plain floor",
              report.saturated_cells, report.dark_cells, report.clamped_cells);
  constexpr std::size_t kShown = 6;
  for (std::size_t i = 0; i < std::min(kShown, report.spots.size()); ++i) {
    const LightSpot& spot = report.spots[i];
    std::printf("%s: %zu cells in u %zu to %zu, v %zu to %zu\n", spot.saturated ? "saturated" : "too dark", spot.cells,
                spot.left_px, spot.right_px, spot.top_px, spot.bottom_px);
  }
  if (report.spots.size() > kShown) std::printf("and %zu smaller spots\n", report.spots.size() - kShown);
  std::printf("%s written, %s: [light] written\n", light.map_path.c_str(), venue.c_str());
  if (measured_on == "grey" && !light.paper_checked) {
    std::printf("whether the field is covered with paper was not checked: calibrate the field first\n");
  }
  if (light.had_colors && !keep_normal) {
    std::printf(
        "the colors were learned with another map: learn them again, or measure the light with --keep-normal\n");
  }
  return {};
}

}  // namespace touchline::calibrate
