#include "tools/programs/calibrate/colors/color_calibration.h"

#include <algorithm>

#include "tools/programs/calibrate/colors/color_names.h"

namespace touchline::calibrate {

Result<VisibleRobots> take_detected(const DetectedColors& found, ColorFitInput& input) {
  if (!found.doubts.empty()) {
    std::string text = "the colors are not certain:";
    for (const DetectionDoubt& doubt : found.doubts) {
      text += "\n  " + doubt.text + (doubt.option.empty() ? "" : ": " + doubt.option);
    }
    return Error{ErrorCode::kInconsistent, text};
  }
  input.clicks = found.clicks;
  input.unclear = found.unclear;
  VisibleRobots robots;
  for (std::size_t t = 0; t < found.input.teams.size(); ++t) {
    const TeamMarking& marking = found.input.teams[t];
    if (marking.team_color == kBackground) continue;
    for (const std::size_t patch : found.assignment.colors[marking.team_color - 1U].patches) {
      const auto& named = found.assignment.named;
      const auto robot = std::find_if(named.begin(), named.end(),
                                      [patch](const AssignedRobot& one) { return one.team_patch == patch; });
      robots[found.images[found.input.picture[patch]]].push_back(
          {static_cast<Team>(t), robot == named.end() ? kUnknownId : marking.robots[robot->robot].id,
           found.input.patches[patch].center});
    }
  }
  return robots;
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
