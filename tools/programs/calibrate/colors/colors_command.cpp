#include "tools/programs/calibrate/colors/colors_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include <unistd.h>

#include "hal/replay/picture.h"
#include "tools/programs/calibrate/colors/auto_detect.h"
#include "tools/programs/calibrate/colors/color_fit.h"
#include "tools/programs/calibrate/colors/field_reference.h"
#include "tools/programs/calibrate/venue/venue_draft.h"
#include "tools/programs/command_line/formatted.h"

namespace touchline::calibrate {
namespace {

namespace fs = std::filesystem;

// Checks that each color of the team file has a click.
Result<void> check_all_colors(const std::string& path, const TeamColors& team, const std::vector<Click>& clicks) {
  std::string missing;
  for (const std::string& name : team.names) {
    if (std::none_of(clicks.begin(), clicks.end(), [&](const Click& c) { return c.color == name; }))
      missing += " " + name;
  }
  if (missing.empty()) return {};
  return failure(ErrorCode::kNotFound, "%s: these colors have no click:%s", path.c_str(), missing.c_str());
}

// Prints the result for the person who confirms it.
void print_detected(const DetectedColors& found) {
  std::printf("%zu patches, %zu robots in %zu pictures\n%-12s %-15s %7s %-12s %s\n", found.input.patches.size(),
              found.assignment.robots, found.images.size(), "color", "R G B", "patches", "next best", "confidence");
  for (std::size_t c = 0; c < found.input.colors.size(); ++c) {
    const WantedColor& wanted = found.input.colors[c];
    const AssignedColor& color = found.assignment.colors[c];
    const std::string rgb =
        color.patches.empty() ? "-" : formatted("%3.0f %3.0f %3.0f", color.rgb[0], color.rgb[1], color.rgb[2]);
    std::printf("%-12s %-15s %7zu %-12s %s\n", wanted.name.c_str(), rgb.c_str(), color.patches.size(),
                color.alternative.empty() ? "-" : color.alternative.c_str(),
                wanted.clicked ? "clicked" : formatted("%.1f %%", 100 * color.confidence()).c_str());
  }
}

void print_unused(const std::vector<Click>& clicks, const std::vector<ClickUse>& uses) {
  const auto used = std::count_if(uses.begin(), uses.end(), [](const ClickUse& use) { return use.used; });
  if (!uses.empty()) std::printf("%td of %zu clicks used\n", used, uses.size());
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (uses[i].used) continue;
    std::printf("click %s is not used: %s\n", describe_click(i, clicks[i]).c_str(), uses[i].reason.c_str());
  }
}

bool confirmed() {
  std::printf("are these colors right? [y/n] ");
  std::fflush(stdout);
  std::string answer;
  return std::getline(std::cin, answer) && (answer == "y" || answer == "yes");
}

void print_report(const ColorFitInput& input, const ColorFit& fit) {
  for (std::size_t i = 0; i < fit.clicks.size(); ++i) {
    const Click& click = input.clicks[i];
    const ClickResult& result = fit.clicks[i];
    if (result.area_px == 0) {
      std::printf("click %s is not used: %s\n", describe_click(i, click).c_str(), result.reason.c_str());
    } else if (result.recognized < 0.5) {
      std::printf("%s, the %s patch at %.0f,%.0f: only %.0f %% of its %zu pixels are recognized\n", click.image.c_str(),
                  click.color.c_str(), click.u_px, click.v_px, 100 * result.recognized, result.area_px);
    }
  }
  std::size_t width = 10;
  for (const std::string& name : fit.names) width = std::max(width, name.size() + 1);
  const auto column = static_cast<int>(width);
  std::printf("classification of the patches, %% of pixels (row: clicked on, column: classified as)\n%*s%*s", column,
              "", column, "none");
  for (const std::string& name : fit.names) std::printf("%*s", column, name.c_str());
  std::printf("%*s\n", column, "boxes");
  for (std::size_t c = 0; c < fit.names.size(); ++c) {
    std::printf("%-*s", column, fit.names[c].c_str());
    for (const double share : fit.confusion[c]) std::printf("%*.1f", column, 100 * share);
    const auto boxes = std::count_if(fit.learned.boxes.begin(), fit.learned.boxes.end(),
                                     [&](const ColorBox& b) { return b.color == c + 1; });
    std::printf("%*td\n", column, boxes);
  }
  std::printf("background classified as a color, %%:");
  for (std::size_t c = 0; c < fit.names.size(); ++c) {
    std::printf(" %s %.4f", fit.names[c].c_str(), 100 * fit.background_share[c]);
  }
  std::printf(
      "\nmargin of each pair: levels between their cores in the channel that separates them best (negative: "
      "overlap)\n");
  std::vector<std::vector<int>> margin(fit.names.size(), std::vector<int>(fit.names.size(), 0));
  for (const PairMargin& m : fit.learned.margins)
    margin[std::max(m.first, m.second)][std::min(m.first, m.second)] = m.levels;
  for (std::size_t c = 1; c < fit.names.size(); ++c) {
    std::printf("%-*s", column, fit.names[c].c_str());
    for (std::size_t other = 0; other < c; ++other) std::printf("%*d", column, margin[c][other]);
    std::printf("\n");
  }
  std::printf("%*s", column, "");
  for (std::size_t c = 0; c + 1 < fit.names.size(); ++c) std::printf("%*s", column, fit.names[c].c_str());
  std::printf("\n");
  for (std::size_t c = 0; c < fit.names.size(); ++c) {
    if (fit.learned.cut_share[c] > 0.05) {
      std::printf("%s: lost %.0f %% of its pixels to other colors; replace it if possible\n", fit.names[c].c_str(),
                  100 * fit.learned.cut_share[c]);
    }
  }
  for (const ColorReplacement& e : fit.advice.replacements) {
    std::printf("%s and %s are only %d levels apart: replace %s if possible; %s would be %d levels from all others\n",
                fit.names[e.first].c_str(), fit.names[e.second].c_str(), e.levels, fit.names[e.replaced].c_str(),
                e.suggestion.name.c_str(), e.suggestion.levels);
  }
  std::printf("best additional color: %s, %d levels from all others and from the background\n",
              fit.advice.additional.name.c_str(), fit.advice.additional.levels);
  std::vector<StrayRegion> strays = fit.strays;
  std::sort(strays.begin(), strays.end(),
            [](const StrayRegion& a, const StrayRegion& b) { return a.area_px > b.area_px; });
  constexpr std::size_t kShown = 8;
  for (std::size_t i = 0; i < std::min(kShown, strays.size()); ++i) {
    const StrayRegion& stray = strays[i];
    std::printf("%s: %u pixels of %s at %.0f,%.0f without a click: a patch or clutter\n", stray.image.c_str(),
                stray.area_px, fit.names[stray.color].c_str(), static_cast<double>(stray.center.u_px),
                static_cast<double>(stray.center.v_px));
  }
  if (strays.size() > kShown) std::printf("and %zu smaller ones\n", strays.size() - kShown);
}

}  // namespace

void ColorsCommand::add_options(CLI::App& app) {
  app.add_option("--picture", pictures,
                 "Picture of standing robots and ball: detects the colors without clicks; repeatable")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--samples", samples,
                 "JSON file of clicks: {\"samples\":[{\"image\",\"color\",\"u\",\"v\"}]}, or \"box\":[u0,v0,u1,v1]");
  app.add_option("--venue", venue, "Venue file; its camera model, light map and region of interest are used")
      ->required();
  app.add_option("--images", images, "Folder of the pictures in the JSON file (default: the folder of the JSON file)");
  app.add_option("--team", team, "Team file: each of its colors must have a click or be detected");
  std::vector<std::string> formats;
  formats.reserve(kPixelFormatTable.size());
  for (const PixelFormatInfo& info : kPixelFormatTable) formats.emplace_back(info.word);
  app.add_option("--format", format, "Pixel format of the camera, as camera.format in board.toml")
      ->check(CLI::IsMember(formats));
  app.add_option("--patch-radius", patch_radius_px, "Greatest distance of a patch's pixels from the click, px")
      ->check(CLI::Range(3, 200));
  app.add_option("--preview", preview, "Folder for pictures of the detected patches and of classified pixels");
  app.add_flag("--yes", yes, "Accept colors that were detected without clicks, without asking");
}

// The default is a folder next to the venue file.
std::string ColorsCommand::preview_folder() const {
  if (!preview.empty()) return preview;
  const fs::path file(venue);
  return (file.parent_path() / (file.stem().string() + "-colors")).string();
}

// Reads clicks and pictures.
Result<void> ColorsCommand::read_input(ColorFitInput& input) const {
  if (samples.empty() && pictures.empty()) {
    return failure(ErrorCode::kNotFound, "either --picture or --samples is needed");
  }
  const auto pixel_format = format_of(format);
  if (!pixel_format) return failure(ErrorCode::kUnsupported, "--format: %s is unknown", format.c_str());
  if (!samples.empty()) {
    TOUCHLINE_TRY_ASSIGN(input.clicks, read_clicks(samples));
  }
  const auto load = [&](const std::string& path, const std::string& name) -> Result<void> {
    if (input.pictures.count(name) > 0) return {};
    TOUCHLINE_TRY_ASSIGN(input.pictures[name], CameraPicture::load(path, *pixel_format));
    return {};
  };
  const fs::path root = images.empty() ? fs::path(samples).parent_path() : fs::path(images);
  std::map<std::string, std::string> name_of;  // loads each picture once, whatever its name
  std::error_code error;
  for (const Click& click : input.clicks) {
    const std::string path = (root / click.image).string();
    TOUCHLINE_TRY(load(path, click.image));
    name_of[fs::weakly_canonical(path, error).string()] = click.image;
  }
  for (const std::string& path : pictures) {
    if (name_of.count(fs::weakly_canonical(path, error).string()) == 0) TOUCHLINE_TRY(load(path, path));
  }
  return {};
}

// Replaces the clicks by the patches that were detected with their help, after a person has confirmed them.
Result<void> ColorsCommand::detect_colors(const VenueDraft& draft, ColorFitInput& input) const {
  if (team.empty()) return failure(ErrorCode::kNotFound, "--picture needs --team, which names the colors to detect");
  TOUCHLINE_TRY_ASSIGN(const TeamColors wanted, read_team_colors(team));
  TOUCHLINE_TRY_ASSIGN(DetectedColors found, auto_detect_colors(draft, wanted, input.clicks, input.pictures));
  print_detected(found);
  print_unused(input.clicks, found.uses);
  const std::string folder = preview_folder();
  std::error_code error;
  fs::create_directories(folder, error);
  for (const auto& [image, picture] : input.pictures) {
    const std::string path = (fs::path(folder) / (fs::path(image).stem().string() + "-found.png")).string();
    TOUCHLINE_TRY(write_detection_picture(path, found, image, picture));
  }
  std::printf("pictures of the result are in %s\n", folder.c_str());
  if (!found.doubts.empty()) {
    std::string text = "the colors are not certain:";
    for (const std::string& doubt : found.doubts) text += "\n  " + doubt;
    return Error{ErrorCode::kInconsistent, text};
  }
  const bool all_clicked = std::all_of(found.input.colors.begin(), found.input.colors.end(),
                                       [](const WantedColor& color) { return color.clicked; });
  if (!all_clicked && !yes && (isatty(STDIN_FILENO) == 0 || !confirmed())) {
    return failure(ErrorCode::kInconsistent,
                   "not confirmed, nothing was written: check the pictures in %s, then run this again with --yes",
                   folder.c_str());
  }
  input.clicks = std::move(found.clicks);
  input.unclear = std::move(found.unclear);
  return {};
}

Result<void> ColorsCommand::run() const {
  TOUCHLINE_TRY_ASSIGN(const VenueDraft draft, read_draft(venue));
  ColorFitInput input;
  TOUCHLINE_TRY(read_input(input));
  input.light = draft.light;
  input.region_of_interest = draft.region_of_interest;
  input.growth.radius_px = patch_radius_px;
  // Without a camera model or a team file, clicks are all there is to learn from.
  const bool can_detect = !team.empty() && has_camera_model(draft);
  if (can_detect || !pictures.empty()) TOUCHLINE_TRY(detect_colors(draft, input));
  if (!team.empty()) {
    TOUCHLINE_TRY_ASSIGN(const TeamColors wanted, read_team_colors(team));
    TOUCHLINE_TRY(check_all_colors(team, wanted, input.clicks));
  }
  TOUCHLINE_TRY_ASSIGN(const ColorFit fit, fit_colors(input));
  print_report(input, fit);

  std::vector<config::ColorEntry> entries;
  for (std::size_t c = 0; c < fit.names.size(); ++c) {
    config::ColorEntry entry;
    entry.name = fit.names[c];
    entry.shown_rgb = fit.shown_rgb[c];
    entry.typical.assign(fit.typical[c].begin(), fit.typical[c].end());
    for (const ColorBox& box : fit.learned.boxes) {
      if (box.color == c + 1) entry.box.push_back({box.low, box.high});
    }
    entries.push_back(std::move(entry));
  }
  config::ColorsEntry colors{fit.space, {}};
  if (fit.background) colors.background.assign(fit.background->begin(), fit.background->end());
  TOUCHLINE_TRY_ASSIGN(const Section light, write_field_reference(venue, draft, input, fit));
  TOUCHLINE_TRY(write_sections(venue, {light, section_of("colors", colors, ""), section_of("color", entries)}));
  std::printf("%s: %zu colors in %zu boxes written\n", venue.c_str(), entries.size(), fit.learned.boxes.size());
  if (preview.empty()) return {};
  std::error_code error;
  fs::create_directories(preview, error);
  for (const auto& [image, picture] : input.pictures) {
    hal::Picture drawn;
    drawn.width_px = picture.frame().width_px;
    drawn.height_px = picture.frame().height_px;
    drawn.rgb8 = preview_rgb(input, fit, picture);
    const std::string path = (fs::path(preview) / (fs::path(image).stem().string() + ".png")).string();
    TOUCHLINE_TRY(hal::write_picture(path, drawn));
  }
  return {};
}

}  // namespace touchline::calibrate
