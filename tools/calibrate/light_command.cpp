#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "tools/calibrate/commands.h"
#include "tools/calibrate/light_fit.h"
#include "tools/calibrate/text.h"
#include "tools/calibrate/venue_draft.h"

namespace touchline::calibrate {

void LightCommand::add_options(CLI::App& app) {
  app.add_option("--picture", pictures, "Picture of the field covered with grey paper; several are averaged")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--venue", venue, "Venue file; the map is written beside it")->required();
}

int LightCommand::run() const {
  std::string reason;
  VenueDraft draft;
  if (!read_draft(venue, draft, reason).ok()) return refuse(reason);
  std::vector<hal::Picture> references;
  for (const std::string& path : pictures) {
    references.emplace_back();
    if (!hal::read_picture(path, references.back(), reason).ok()) return refuse(reason);
  }
  LightMap map;
  LightReport report;
  if (!fit_light(references, draft.region_of_interest, map, report, reason).ok()) return refuse(reason);

  const std::filesystem::path file(venue);
  config::LightEntry entry;
  entry.map = file.stem().string() + "-light.png";
  const std::string map_path = (file.parent_path() / entry.map).string();
  if (!hal::write_picture(map_path, map_picture(map), reason).ok()) return refuse(reason);
  if (!write_sections(venue, {section_of("light", entry, "")}, reason).ok()) return refuse(reason);

  constexpr const char* kNames[] = {"red", "green", "blue"};
  for (std::size_t c = 0; c < 3; ++c) {
    std::printf("%-5s illumination %.2f to %.2f (%.2f : 1), 1 is the value %.1f\n", kNames[c], report.least[c],
                report.most[c], report.most[c] / report.least[c], report.normal[c]);
  }
  std::printf("%u x %u cells: %zu saturated, %zu too dark, %zu beyond what can be corrected\n", map.columns, map.rows,
              report.saturated_cells, report.dark_cells, report.clamped_cells);
  std::printf("%s written, %s: [light] written\n", map_path.c_str(), venue.c_str());
  return 0;
}

}  // namespace touchline::calibrate
