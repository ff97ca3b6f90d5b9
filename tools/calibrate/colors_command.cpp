#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>

#include "firmware/config/team_file.h"
#include "firmware/config/toml_file.h"
#include "hal/replay/picture.h"
#include "tools/calibrate/color_fit.h"
#include "tools/calibrate/commands.h"
#include "tools/calibrate/text.h"
#include "tools/calibrate/venue_draft.h"

namespace touchline::calibrate {
namespace {

namespace fs = std::filesystem;

// Every color that a team file names must have been clicked on.
Status check_team(const std::string& path, const std::vector<Click>& clicks, std::string& reason) {
  config::TeamFile team;
  config::Locations where;
  config::Problems problems;
  if (Status s = config::read_toml(path, "", {}, team, where, problems); !s.ok()) {
    reason = problems.text();
    return s;
  }
  std::set<std::string> wanted = {team.own.color, team.opponent.color, team.ball.color};
  for (const auto& side : {team.own, team.opponent}) {
    for (const auto& robot : side.robot) wanted.insert(robot.colors.begin(), robot.colors.end());
  }
  wanted.erase("");
  for (const Click& click : clicks) wanted.erase(click.color);
  if (wanted.empty()) return {};
  reason = path + " names colors that no click shows:";
  for (const std::string& name : wanted) reason += " " + name;
  return ErrorCode::kInconsistent;
}

void print_report(const ColorFitInput& input, const ColorFit& fit) {
  for (std::size_t i = 0; i < fit.clicks.size(); ++i) {
    const Click& click = input.clicks[i];
    const ClickResult& result = fit.clicks[i];
    if (result.area_px == 0) {
      std::printf("click %zu (%s, %s at %.0f,%.0f) caught nothing: %s\n", i, click.image.c_str(), click.color.c_str(),
                  click.u_px, click.v_px, result.reason.c_str());
    } else if (result.recognized < 0.5) {
      std::printf("click %zu (%s, %s at %.0f,%.0f): only %.0f %% of its %zu pixels are recognized\n", i,
                  click.image.c_str(), click.color.c_str(), click.u_px, click.v_px, 100 * result.recognized,
                  result.area_px);
    }
  }
  std::size_t width = 10;
  for (const std::string& name : fit.names) width = std::max(width, name.size() + 1);
  const auto column = static_cast<int>(width);
  std::printf("pixels of the patches, %% (row: clicked on, column: classified as)\n%*s%*s", column, "", column, "none");
  for (const std::string& name : fit.names) std::printf("%*s", column, name.c_str());
  std::printf("%*s\n", column, "boxes");
  for (std::size_t c = 0; c < fit.names.size(); ++c) {
    std::printf("%-*s", column, fit.names[c].c_str());
    for (const double share : fit.confusion[c]) std::printf("%*.1f", column, 100 * share);
    const auto boxes = std::count_if(fit.learned.boxes.begin(), fit.learned.boxes.end(),
                                     [&](const ColorBox& b) { return b.color == c + 1; });
    std::printf("%*td\n", column, boxes);
  }
  std::printf("background taken for a color, %%:");
  for (std::size_t c = 0; c < fit.names.size(); ++c) {
    std::printf(" %s %.4f", fit.names[c].c_str(), 100 * fit.background_share[c]);
  }
  std::printf("\nmargins of the closest pairs, levels between their cores (negative: they overlap):");
  for (std::size_t i = 0; i < std::min<std::size_t>(6, fit.learned.margins.size()); ++i) {
    const PairMargin& m = fit.learned.margins[i];
    std::printf("%s %s-%s %d", i == 0 ? "" : ",", fit.names[m.first].c_str(), fit.names[m.second].c_str(), m.levels);
  }
  std::printf("\n");
  for (std::size_t c = 0; c < fit.names.size(); ++c) {
    if (fit.learned.cut_share[c] > 0.05) {
      std::printf("%s: %.0f %% of its pixels were given up to keep it apart from others; exchange it if you can\n",
                  fit.names[c].c_str(), 100 * fit.learned.cut_share[c]);
    }
  }
  std::vector<StrayRegion> strays = fit.strays;
  std::sort(strays.begin(), strays.end(),
            [](const StrayRegion& a, const StrayRegion& b) { return a.area_px > b.area_px; });
  constexpr std::size_t kShown = 8;
  for (std::size_t i = 0; i < std::min(kShown, strays.size()); ++i) {
    const StrayRegion& stray = strays[i];
    std::printf("%s: %u pixels of %s at %.0f,%.0f where nobody clicked: a patch, or clutter like it\n",
                stray.image.c_str(), stray.area_px, fit.names[stray.color].c_str(),
                static_cast<double>(stray.center.u_px), static_cast<double>(stray.center.v_px));
  }
  if (strays.size() > kShown) std::printf("and %zu smaller ones\n", strays.size() - kShown);
}

}  // namespace

void ColorsCommand::add_options(CLI::App& app) {
  app.add_option("--samples", samples, "JSON file of clicks: {\"samples\":[{\"image\",\"color\",\"u\",\"v\"}]}")
      ->required();
  app.add_option("--venue", venue, "Venue file; its light map and region of interest are used")->required();
  app.add_option("--images", images, "Folder that the image names start from; else the JSON file's");
  app.add_option("--team", team, "Team file: all colors that it names must have been clicked on");
  app.add_option("--format", format, "What the camera delivers: rgb24, bgr24, yuyv, uyvy, nv12")
      ->check(CLI::IsMember({"rgb24", "bgr24", "yuyv", "uyvy", "nv12"}));
  app.add_option("--patch-radius", patch_radius_px, "A patch reaches no farther from the click, px")
      ->check(CLI::Range(3, 200));
  app.add_option("--preview", preview, "Folder to write pictures of the classified pixels to");
}

int ColorsCommand::run() const {
  std::string reason;
  VenueDraft draft;
  if (!read_draft(venue, draft, reason).ok()) return refuse(reason);
  ColorFitInput input;
  if (!read_clicks(samples, input.clicks, reason).ok()) return refuse(reason);
  if (!team.empty() && !check_team(team, input.clicks, reason).ok()) return refuse(reason);
  input.light = draft.light;
  input.region_of_interest = draft.region_of_interest;
  input.growth.radius_px = patch_radius_px;
  const fs::path root = images.empty() ? fs::path(samples).parent_path() : fs::path(images);
  const auto pixel_format = format_of(format);
  if (!pixel_format) return refuse("--format: " + format + " is unknown");
  for (const Click& click : input.clicks) {
    if (input.pictures.count(click.image) > 0) continue;
    if (!CameraPicture::load((root / click.image).string(), *pixel_format, input.pictures[click.image], reason).ok()) {
      return refuse(reason);
    }
  }
  ColorFit fit;
  if (!fit_colors(input, fit, reason).ok()) return refuse(reason);
  print_report(input, fit);

  std::vector<config::ColorEntry> entries;
  for (std::size_t c = 0; c < fit.names.size(); ++c) {
    config::ColorEntry entry;
    entry.name = fit.names[c];
    entry.shown_rgb = fit.shown_rgb[c];
    for (const ColorBox& box : fit.learned.boxes) {
      if (box.color == c + 1) entry.box.push_back({box.low, box.high});
    }
    entries.push_back(std::move(entry));
  }
  if (!write_sections(venue, {section_of("colors", config::ColorsEntry{fit.space}, ""), section_of("color", entries)},
                      reason)
           .ok()) {
    return refuse(reason);
  }
  std::printf("%s: %zu colors in %zu boxes written\n", venue.c_str(), entries.size(), fit.learned.boxes.size());
  if (preview.empty()) return 0;
  std::error_code error;
  fs::create_directories(preview, error);
  for (const auto& [image, picture] : input.pictures) {
    hal::Picture drawn;
    drawn.width_px = picture.frame().width_px;
    drawn.height_px = picture.frame().height_px;
    drawn.rgb8 = preview_rgb(input, fit, picture);
    const std::string path = (fs::path(preview) / (fs::path(image).stem().string() + ".png")).string();
    if (!hal::write_picture(path, drawn, reason).ok()) return refuse(reason);
  }
  return 0;
}

}  // namespace touchline::calibrate
