#include <algorithm>
#include <utility>

#include "firmware/config/error_list.h"
#include "firmware/config/layout_choice.h"
#include "firmware/config/resolve.h"
#include "firmware/config/resolve_radio.h"
#include "firmware/config/standard_layouts.h"
#include "firmware/config/wording.h"

namespace touchline::config {
namespace {

class TeamResolver {
 public:
  TeamResolver(const TeamFile& file, const Locations& where, const VenueFile& venue, const Locations& venue_where,
               Markers markers)
      : file_(file), where_(where), venue_(venue), venue_where_(venue_where), markers_(markers) {}

  ColorId color(const std::string& name, const std::string& key) {
    if (name.empty()) return kBackground;
    const ColorId id = color_id(venue_, name);
    if (venue_.color.empty()) {
      // Reports the missing colors once instead of once for each color.
      if (!std::exchange(told_of_no_colors_, true)) {
        add(key, venue_where_.file() + " has no colors yet; calibrate them with touchline-calibrate colors --venue " +
                     venue_where_.file() + " --team " + where_.file() + " --picture ...");
      }
    } else if (id == kBackground) {
      std::vector<std::string_view> names;
      for (const ColorEntry& entry : venue_.color) names.push_back(entry.name);
      add(key, "no color \"" + name + "\" in " + venue_where_.file() + suggestion(name, names, "colors"));
    }
    return id;
  }

  void team(const TeamEntry& entry, const std::string& name, TeamMarking& out) {
    out.max_robots = static_cast<std::uint8_t>(entry.max_robots);
    out.robots.clear();
    out.team_color = color(entry.color, name + ".color");
    if (!layout(entry, name + ".layout", out.layout)) return;
    const auto identification = std::count_if(out.layout.patches.begin(), out.layout.patches.end(),
                                              [](const auto& p) { return p.role == PatchRole::kIdentification; });
    if (entry.robot.size() > kMaxRobotsPerTeam) {
      add(name + ".robot",
          std::to_string(entry.robot.size()) + " robots; a team has at most " + std::to_string(kMaxRobotsPerTeam));
      return;
    }
    for (std::size_t i = 0; i < entry.robot.size(); ++i) {
      robot(entry, i, element(name + ".robot", i), static_cast<std::size_t>(identification), out);
    }
  }

  void add(const std::string& key, const std::string& message) { errors_.add(where_.of(key), key, message); }
  [[nodiscard]] Result<void> result() const { return errors_.result(); }

 private:
  bool layout(const TeamEntry& team, const std::string& key, MarkerLayout& out) {
    const std::optional<MarkerLayout> chosen = chosen_layout(file_, team);
    if (!chosen) {
      std::vector<std::string_view> names;
      for (const StandardLayout& standard : standard_layouts()) names.push_back(standard.name);
      for (const LayoutEntry& entry : file_.layout) names.push_back(entry.name);
      add(key, "no [[layout]] is named \"" + team.layout + "\"" + suggestion(team.layout, names, "layouts"));
      return false;
    }
    out = *chosen;
    for (std::size_t i = 0; i < file_.layout.size(); ++i) {
      if (file_.layout[i].name == team.layout) return patches(file_.layout[i], element("layout", i));
    }
    return true;
  }

  bool patches(const LayoutEntry& entry, const std::string& key) {
    const std::size_t before = errors_.size();
    if (entry.patch.empty() && markers_ == Markers::kSeen) add(key, "\"" + entry.name + "\" has no [[layout.patch]]");
    if (entry.patch.size() > kMaxPatches) {
      add(key + ".patch",
          std::to_string(entry.patch.size()) + " patches; a robot has at most " + std::to_string(kMaxPatches));
    }
    for (std::size_t i = 0; i < entry.patch.size(); ++i) {
      const PatchEntry& patch = entry.patch[i];
      const std::string patch_key = element(key + ".patch", i);
      if ((patch.role == PatchRole::kTeam) != (i == 0)) {
        add(patch_key + ".role", "the first patch, and no other, must be the team patch");
      }
      if (patch.length_m <= 0.0f || patch.width_m <= 0.0f) {
        add(patch_key, "length_m and width_m must be above 0");
      }
      if (std::max(std::abs(patch.x_m), std::abs(patch.y_m)) > entry.robot_side_m / 2) {
        add(patch_key,
            "the patch's center lies outside of the robot, whose side is " + number_text(entry.robot_side_m) + " m");
      }
    }
    return errors_.size() == before;
  }

  void robot(const TeamEntry& team, std::size_t index, const std::string& key, std::size_t identification,
             TeamMarking& out) {
    const RobotEntry& entry = team.robot[index];
    const std::string list = key.substr(0, key.rfind('['));
    for (std::size_t j = 0; j < index; ++j) {
      const std::string there = " at " + where_.of(element(list, j));
      if (team.robot[j].id == entry.id) {
        add(key + ".id", "id " + std::to_string(entry.id) + " is already used by the robot" + there);
      }
      if (team.robot[j].colors == entry.colors && !is_without_marker(entry)) {
        add(key + ".colors", "robot " + std::to_string(entry.id) + " has the same colors as robot " +
                                 std::to_string(team.robot[j].id) + there + "; they cannot be distinguished");
      }
    }
    if (entry.colors.size() != identification && !is_without_marker(entry)) {
      add(key + ".colors", "the layout \"" + team.layout + "\" has " + std::to_string(identification) +
                               " identification patches, but the robot has " + std::to_string(entry.colors.size()) +
                               " colors");
      return;
    }
    RobotMarking marking;
    marking.id = static_cast<RobotId>(entry.id);
    for (std::size_t i = 0; i < entry.colors.size(); ++i) {
      const ColorId id = color(entry.colors[i], key + ".colors");
      if (entry.colors[i].empty()) add(key + ".colors", "a color's name is empty");
      marking.colors.push_back(id);
    }
    out.robots.push_back(marking);
  }

  [[nodiscard]] bool is_without_marker(const RobotEntry& robot) const {
    return markers_ == Markers::kUnseen && robot.colors.empty();
  }

  const TeamFile& file_;
  const Locations& where_;
  const VenueFile& venue_;
  const Locations& venue_where_;
  const Markers markers_;
  ErrorList errors_;
  bool told_of_no_colors_ = false;
};

// The team colors and the ball's color must differ.
void check_distinct(TeamResolver& resolver, const TeamFile& team) {
  const std::array<std::pair<const char*, const std::string*>, 3> things{
      {{"own.color", &team.own.color}, {"opponent.color", &team.opponent.color}, {"ball.color", &team.ball.color}}};
  for (std::size_t i = 0; i < things.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (things[i].second->empty() || *things[i].second != *things[j].second) continue;
      resolver.add(things[i].first, "\"" + *things[i].second + "\" is also " + things[j].first);
    }
  }
}

// A team's color and the ball's color identify no robot. Teams without a color are not detected.
void check_identification(TeamResolver& resolver, const TeamFile& team, const Locations& where) {
  const std::array<std::pair<const char*, const std::string*>, 3> things{
      {{"own.color", &team.own.color}, {"opponent.color", &team.opponent.color}, {"ball.color", &team.ball.color}}};
  for (const auto& [name, side] : {std::pair{"own", &team.own}, std::pair{"opponent", &team.opponent}}) {
    if (side->color.empty()) continue;
    for (std::size_t i = 0; i < side->robot.size(); ++i) {
      const std::string key = element(std::string(name) + ".robot", i) + ".colors";
      for (const auto& [other, color] : things) {
        const std::vector<std::string>& own = side->robot[i].colors;
        if (color->empty() || std::find(own.begin(), own.end(), *color) == own.end()) continue;
        resolver.add(key, "\"" + *color + "\" is also " + other + " at " + where.of(other) +
                              "; give the robot's patch another color");
      }
    }
  }
}

// Adds the variances, because the errors are independent.
void add_noise(const NoiseEntry& noise, TrackParameters& track) {
  track.robot.position_jitter_m = std::hypot(track.robot.position_jitter_m, noise.robot_position_m);
  track.robot.heading_jitter_rad = std::hypot(track.robot.heading_jitter_rad, noise.robot_heading_rad);
  track.ball.position_jitter_m = std::hypot(track.ball.position_jitter_m, noise.ball_position_m);
}

}  // namespace

std::optional<bool> own_is_yellow(const TeamFile& team) {
  if (team.own.color == "yellow" || team.opponent.color == "blue") return true;
  if (team.own.color == "blue" || team.opponent.color == "yellow") return false;
  return std::nullopt;
}

Result<void> resolve_team(const TeamFile& team, const Locations& where, const VenueFile& venue,
                          const Locations& venue_where, Markers markers, PipelineParameters& out) {
  TeamResolver resolver(team, where, venue, venue_where, markers);
  resolver.team(team.own, "own", out.marker.teams[static_cast<std::size_t>(Team::kOwn)]);
  resolver.team(team.opponent, "opponent", out.marker.teams[static_cast<std::size_t>(Team::kOpponent)]);
  if (team.own.robot.empty() && where.has("own") && markers == Markers::kSeen) {
    resolver.add("own.robot", "is missing; add an [[own.robot]] for each robot to drive");
  }
  out.marker.ball.color = resolver.color(team.ball.color, "ball.color");
  out.marker.ball.radius_m = team.ball.radius_m;
  check_distinct(resolver, team);
  check_identification(resolver, team, where);
  out.track = team.tracking;
  add_noise(venue.noise, out.track);
  out.control = team.control;
  TOUCHLINE_TRY(resolver.result());
  return resolve_radio(team, where, out);
}

}  // namespace touchline::config
