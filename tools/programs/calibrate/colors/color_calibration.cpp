#include "tools/programs/calibrate/colors/color_calibration.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "tools/programs/calibrate/colors/color_names.h"
#include "tools/programs/calibrate/colors/mirror_check.h"
#include "tools/programs/command_line/formatted.h"

namespace touchline::calibrate {
namespace {

namespace fs = std::filesystem;

// Largest number of pictures that are tried; more pictures add little about the lamps, and take time.
constexpr std::size_t kMaxTriedPictures = 4;

// Colors learned from some of the clicks or pictures, and how well they perform.
struct Trial {
  DetectedColors found;
  std::optional<int> recognized;  // SelfCheck::recognized(); empty: nothing can be learned
  bool passed = false;            // SelfCheck::passed()

  [[nodiscard]] bool is_worse_than(const Trial& other) const {
    return recognized < other.recognized || (recognized == other.recognized && other.passed && !passed);
  }
  [[nodiscard]] std::string text() const {
    if (!recognized) return "learns no colors";
    return formatted("finds %d robots and balls%s", *recognized,
                     passed ? "" : ", and patches that are no known robot's");
  }
};

// Tests the colors of `trial`; leaves `trial` as it is if nothing can be learned.
Result<void> check_trial(const ColorFiles& files, ColorFitInput input, Trial& trial) {
  TOUCHLINE_TRY_ASSIGN(const VisibleByPicture visible, take_detected(trial.found, input));
  TOUCHLINE_TRY(check_all_colors(files.team, files.colors, input.clicks));
  TOUCHLINE_TRY_ASSIGN(const ColorFit fit, fit_colors(input));
  const fs::path venue(files.venue);
  const std::string copy =
      (venue.parent_path() / (venue.stem().string() + "-trial" + venue.extension().string())).string();
  const Result<void> written = write_copy(files.venue, color_sections(files.draft, fit), copy);
  Result<SelfCheck> check = Error{ErrorCode::kIo, ""};
  if (written.ok()) check = self_check(copy, files.team, input.pictures, visible, "");
  std::error_code error;
  fs::remove(copy, error);
  TOUCHLINE_TRY(written);
  if (!check.ok()) return check.error();
  trial.recognized = check.value().recognized();
  trial.passed = check.value().passed();
  return {};
}

Result<Trial> try_clicks(const ColorFiles& files, const ColorFitInput& input, const std::vector<Click>& clicks) {
  Trial trial;
  TOUCHLINE_TRY_ASSIGN(trial.found, auto_detect_colors(files.draft, files.colors, clicks, input.pictures));
  static_cast<void>(check_trial(files, input, trial));  // Colors from which nothing can be learned count as worst.
  return trial;
}

// Returns colors from all pictures, or from a single picture if its colors recognize more: under other lamps, patches
// of one color may look like patches of another.
Result<DetectedColors> detect_without_clicks(const ColorFiles& files, const ColorFitInput& input) {
  TOUCHLINE_TRY_ASSIGN(Trial best, try_clicks(files, input, {}));
  if (input.pictures.size() == 1 || input.pictures.size() > kMaxTriedPictures) return std::move(best.found);
  for (const auto& [image, picture] : input.pictures) {
    Trial one;
    Result<DetectedColors> found = auto_detect_colors(files.draft, files.colors, {}, {{image, picture}});
    if (!found.ok()) return found.error();
    one.found = std::move(found).value();
    static_cast<void>(check_trial(files, input, one));
    if (best.is_worse_than(one)) best = std::move(one);
  }
  return std::move(best.found);
}

Result<DetectedColors> detect(const ColorFiles& files, const ColorFitInput& input) {
  if (input.clicks.empty()) return detect_without_clicks(files, input);
  TOUCHLINE_TRY_ASSIGN(DetectedColors all, auto_detect_colors(files.draft, files.colors, input.clicks, input.pictures));
  if (std::none_of(all.uses.begin(), all.uses.end(), [](const ClickUse& use) { return use.used; })) return all;
  Trial with_all;
  with_all.found = std::move(all);
  static_cast<void>(check_trial(files, input, with_all));
  if (with_all.passed) return std::move(with_all.found);
  TOUCHLINE_TRY_ASSIGN(Trial best, try_clicks(files, input, {}));
  if (!with_all.is_worse_than(best)) return std::move(with_all.found);
  std::vector<Click> kept;
  std::vector<std::size_t> numbers;
  std::vector<ClickUse> uses = with_all.found.uses;
  for (std::size_t i = 0; i < input.clicks.size(); ++i) {
    if (!uses[i].used) continue;
    kept.push_back(input.clicks[i]);
    TOUCHLINE_TRY_ASSIGN(Trial trial, try_clicks(files, input, kept));
    if (trial.is_worse_than(best)) {
      kept.pop_back();
      uses[i] = {false, formatted("with it, the self-check %s; without it, it %s; is its color right?",
                                  trial.text().c_str(), best.text().c_str())};
    } else {
      numbers.push_back(i);
      best = std::move(trial);
    }
  }
  for (std::size_t k = 0; k < numbers.size(); ++k) uses[numbers[k]] = best.found.uses[k];
  best.found.uses = std::move(uses);
  return std::move(best.found);
}

}  // namespace

Result<DetectedColors> detect_with_clicks(const ColorFiles& files, const ColorFitInput& input) {
  TOUCHLINE_TRY_ASSIGN(DetectedColors found, detect(files, input));
  const auto mirror = mirror_doubt(files.draft, files.colors, input.clicks, input.pictures, found);
  if (mirror) found.doubts = {*mirror};
  return found;
}

Result<void> write_copy(const std::string& venue, const std::vector<Section>& sections, const std::string& copy) {
  std::error_code error;
  fs::copy_file(venue, copy, fs::copy_options::overwrite_existing, error);
  if (error) return failure(ErrorCode::kIo, "%s: %s", copy.c_str(), error.message().c_str());
  TOUCHLINE_TRY(write_sections(copy, sections));
  fs::remove(copy + ".bak", error);
  return {};
}

std::string describe_left_out(const DetectedColors& found, const ColorFitInput& input) {
  if (found.images.size() == input.pictures.size()) return "";
  return formatted(
      "colors are from %s alone: with colors from all %zu pictures, less is recognized in them; is their light the "
      "same?",
      found.images.front().c_str(), input.pictures.size());
}

Result<VisibleByPicture> take_detected(const DetectedColors& found, ColorFitInput& input) {
  if (!found.doubts.empty()) {
    std::string text = "the colors are not certain:";
    for (const DetectionDoubt& doubt : found.doubts) {
      text += "\n  " + doubt.text + (doubt.option.empty() ? "" : ": " + doubt.option);
    }
    return Error{ErrorCode::kInconsistent, text};
  }
  input.clicks = found.clicks;
  input.unclear = found.unclear;
  input.things = found.things;
  input.learned_from = found.images;
  for (const TeamMarking& marking : found.input.teams) {
    if (marking.team_color == kBackground) continue;
    input.uses[found.input.colors[marking.team_color - 1U].name] = ColorUse::kTeam;
    for (const RobotMarking& robot : marking.robots) {
      for (const ColorId color : robot.colors) {
        if (color != found.input.ball) {
          input.uses.try_emplace(found.input.colors[color - 1U].name, ColorUse::kIdentification);
        }
      }
    }
  }
  if (found.input.ball != kBackground) input.uses[found.input.colors[found.input.ball - 1U].name] = ColorUse::kBall;
  VisibleByPicture visible;
  for (std::size_t t = 0; t < found.input.teams.size(); ++t) {
    const TeamMarking& marking = found.input.teams[t];
    if (marking.team_color == kBackground) continue;
    const auto& named = found.assignment.named;
    std::vector<std::size_t> patches = found.assignment.colors[marking.team_color - 1U].patches;
    for (const AssignedRobot& robot : named) {  // in odd light, nothing is learned from the robot's team patch
      const bool is_new = std::find(patches.begin(), patches.end(), robot.team_patch) == patches.end();
      if (robot.team == t && is_new) patches.push_back(robot.team_patch);
    }
    for (const std::size_t patch : patches) {
      const auto robot = std::find_if(named.begin(), named.end(),
                                      [patch](const AssignedRobot& one) { return one.team_patch == patch; });
      const auto& unlisted = found.assignment.unlisted;
      const bool listed = std::none_of(unlisted.begin(), unlisted.end(),
                                       [patch](const AssignedRobot& one) { return one.team_patch == patch; });
      visible[found.images[found.input.picture[patch]]].robots.push_back(
          {static_cast<Team>(t), robot == named.end() ? kUnknownId : marking.robots[robot->robot].id,
           found.input.patches[patch].center, listed});
    }
  }
  if (found.input.ball != kBackground) {
    for (const std::size_t patch : found.assignment.colors[found.input.ball - 1U].patches)
      visible[found.images[found.input.picture[patch]]].ball = found.input.patches[patch].center;
  }
  return visible;
}

Result<void> check_all_colors(const std::string& team_path, const TeamColors& team, const std::vector<Click>& clicks) {
  std::string missing;
  for (const std::string& name : team.names) {
    if (std::none_of(clicks.begin(), clicks.end(), [&](const Click& c) { return c.color == name; }))
      missing += " " + name;
  }
  if (missing.empty()) return {};
  return failure(ErrorCode::kNotFound, "%s: these colors have no click:%s", team_path.c_str(), missing.c_str());
}

std::vector<OddColor> find_odd_colors(const ColorFit& fit, const std::vector<std::string>& accepted) {
  std::vector<OddColor> out;
  for (std::size_t c = 0; c < fit.names.size(); ++c) {
    const Rgb seen{static_cast<double>(fit.shown_rgb[c][0]), static_cast<double>(fit.shown_rgb[c][1]),
                   static_cast<double>(fit.shown_rgb[c][2])};
    const std::string& name = fit.names[c];
    const bool is_accepted = std::find(accepted.begin(), accepted.end(), name) != accepted.end();
    if (!is_accepted && !is_plausible(usual_rgb(name), seen)) {
      out.push_back({name, std::string(most_similar_name(seen)), seen});
    }
  }
  return out;
}

std::vector<Section> color_sections(const VenueDraft& venue, const ColorFit& fit) {
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
  config::LightEntry light = venue.file.light;
  light.reference.clear();
  return {section_of("light", light, ""), section_of("colors", colors, ""), section_of("color", entries)};
}

}  // namespace touchline::calibrate
