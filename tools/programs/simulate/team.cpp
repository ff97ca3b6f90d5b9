#include "tools/programs/simulate/team.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "firmware/arena_sides.h"
#include "hal/mock/strategies/strategy_catalog.h"
#include "tools/programs/simulate/release_0_1/play.h"

namespace touchline::simulate {
namespace {

using hal::mock::StrategyCatalog;
using hal::mock::StrategyEntry;

const StrategyCatalog& catalog() {
  static const StrategyCatalog all = [] {
    StrategyCatalog made;
    made.add({"release-0.1",
              "the built-in play of release 0.1, frozen",
              [](std::uint64_t) { return hal::mock::make_strategy<release_0_1::Play>(); },
              {}});
    return made;
  }();
  return all;
}

// The game is played on the field that both sides know: that of the venue, whatever [arena.field] says. The robots of
// the arena that the team file knows stand where they do there, in proportion.
void move_to_venue(config::Configuration& configuration) {
  hal::mock::ArenaParameters& arena = configuration.board.arena;
  hal::mock::ArenaField& field = arena.field;
  const FieldParameters& venue = configuration.venue.field;
  const double length = static_cast<double>(venue.length_m) / field.length_m;
  const double width = static_cast<double>(venue.width_m) / field.width_m;
  field.length_m = static_cast<double>(venue.length_m);
  field.width_m = static_cast<double>(venue.width_m);
  field.goal_width_m = static_cast<double>(venue.goal_width_m);
  field.goal_depth_m = static_cast<double>(venue.goal_depth_m);
  field.circle_radius_m = static_cast<double>(venue.center_circle_m);
  const auto is_unknown = [&](const hal::mock::ArenaRobot& robot) {
    const auto& known = robot.team == hal::mock::Side::kOwn ? configuration.team.own : configuration.team.opponent;
    return std::none_of(known.robot.begin(), known.robot.end(),
                        [&](const config::RobotEntry& entry) { return entry.id == robot.id; });
  };
  std::erase_if(arena.robot, is_unknown);
  for (hal::mock::ArenaRobot& robot : arena.robot) {
    robot.x_m *= length;
    robot.y_m *= width;
  }
}

// Returns the key among the overrides that move_to_venue() would overwrite.
std::optional<std::string> overwritten_key(const std::vector<std::string>& overrides) {
  for (const std::string& override : overrides) {
    for (const char* name : {"length_m", "width_m", "goal_width_m", "goal_depth_m", "circle_radius_m"}) {
      std::string key = std::string("arena.field.") + name;
      if (override.starts_with(key + "=")) return key;
    }
  }
  return std::nullopt;
}

bool is_file(const std::string& team) { return team.ends_with(".toml"); }

}  // namespace

std::string strategies_text() { return catalog().help(); }

std::vector<std::string> strategy_names() {
  std::vector<std::string> names;
  for (const StrategyEntry& entry : catalog().entries()) names.emplace_back(entry.name);
  return names;
}

Result<std::vector<std::string>> preset_overrides(std::string_view preset) {
  std::vector<std::string> overrides{"arena.preset=" + std::string(preset)};
  if (preset == "mirosot") return overrides;
  // As in docs/arena.md. The lag stays 0.08 s, as in boards/firasim/team.toml.
  const auto add = [&](const char* wheel_base_m, const char* mass_ratio) {
    for (const char* each : {"control.ball.deceleration_mps2=0.0765", "control.ball.damping_per_s=0",
                             "control.ball.wall_restitution=0.295", "control.ball.robot_restitution=0.03"}) {
      overrides.emplace_back(each);
    }
    overrides.push_back(std::string("control.drive.wheel_base_m=") + wheel_base_m);
    overrides.push_back(std::string("control.ball.mass_ratio=") + mass_ratio);
    return overrides;
  };
  if (preset == "rsim") return add("0.0775", "0.279");
  if (preset == "firasim") return add("0.085", "0.048");
  return failure(ErrorCode::kNotFound, "there is no parameter set \"%.*s\"; choose mirosot, rsim or firasim",
                 static_cast<int>(preset.size()), preset.data());
}

Result<Team> load_team(const std::string& board, const std::string& team, const std::vector<std::string>& overrides) {
  Team out;
  out.name = team;
  out.strategy = is_file(team) ? "play" : team;
  if (catalog().find(out.strategy) == nullptr) {
    return failure(ErrorCode::kNotFound,
                   "there is no strategy \"%s\"; there are %s, or the path of a team file (.toml)", team.c_str(),
                   catalog().names().c_str());
  }
  std::vector<std::string> settings;
  // A strategy plays, also on a board whose own robots wait for a program outside.
  if (!is_file(team)) settings.emplace_back("control.play.enabled=true");
  settings.insert(settings.end(), overrides.begin(), overrides.end());
  if (const auto key = overwritten_key(overrides)) {
    return failure(ErrorCode::kInconsistent, "--set %s: games are played on the field of the venue file; set field.*",
                   key->c_str());
  }
  auto configuration = std::make_shared<config::Configuration>();
  TOUCHLINE_TRY(config::load({board, "", is_file(team) ? team : "", settings}, *configuration));
  move_to_venue(*configuration);
  if (const auto violation = hal::mock::find_violation(configuration->board.arena)) {
    return failure(ErrorCode::kInconsistent, "%s: arena.%s on the field of the venue file: %s", board.c_str(),
                   violation->key.c_str(), violation->message.c_str());
  }
  out.configuration = std::move(configuration);
  return out;
}

Result<hal::mock::StrategyPointer> make_strategy(const Team& team, std::uint64_t seed) {
  return catalog().create(team.strategy, seed);
}

ControlParameters control_of(const Team& team) {
  return parameters_for(*catalog().find(team.strategy), team.configuration->pipeline.control);
}

Result<Player> make_player(const Team& team, const hal::mock::ArenaParameters& arena, hal::mock::Side side,
                           std::uint64_t seed) {
  Player player;
  hal::mock::SideSettings settings = side_settings(*team.configuration, side);
  TOUCHLINE_TRY_ASSIGN(player.strategy, make_strategy(team, seed));
  settings.strategy = player.strategy.get();
  settings.pipeline.control = control_of(team);
  player.side = std::make_unique<hal::mock::SimulatedSide>(arena, side, seed);
  if (const Status status = player.side->configure(settings); !status.ok()) {
    return failure(status.code(), "%s: its pipeline refuses the settings", team.name.c_str());
  }
  return player;
}

}  // namespace touchline::simulate
