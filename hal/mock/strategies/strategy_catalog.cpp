#include "hal/mock/strategies/strategy_catalog.h"

#include <algorithm>

#include "core/control/play.h"
#include "hal/mock/strategies/follow.h"
#include "hal/mock/strategies/pusher.h"
#include "hal/mock/strategies/stand.h"
#include "hal/mock/strategies/univector.h"
#include "hal/mock/strategies/wall.h"

namespace touchline::hal::mock {
namespace {

// The published programs send speeds without a ramp, so the motors and the tires alone limit the acceleration. UnBrain
// spins with up to 60 rad/s.
DriveParameters published_drive(const UnivectorGains& gains) {
  DriveParameters drive;
  drive.max_speed_mps = drive.max_wheel_speed_mps = gains.max_wheel_mps;
  drive.max_turn_radps = 60.0;
  drive.max_wheel_acceleration_mps2 = 100.0;
  return drive;
}

}  // namespace

StrategyCatalog::StrategyCatalog() {
  add({"stand", "no robot moves", [](std::uint64_t) { return make_strategy<Stand>(); }, {}});
  add({"follow",
       "the nearest robot drives straight at the ball, the others wander, 0.35 m/s",
       [](std::uint64_t seed) { return make_strategy<Follow>(seed); },
       {}});
  add({"univector", "univector fields as VSSS teams publish them: attacker, goalkeeper, assistants, 0.8 m/s",
       [](std::uint64_t) { return make_strategy<Univector>(kUnivector); }, published_drive(kUnivector)});
  add({"univector-fast", "the same with the published limit of 2.0 m/s",
       [](std::uint64_t) { return make_strategy<Univector>(kUnivectorFast); }, published_drive(kUnivectorFast)});
  add({"pusher", "all robots but the goalkeeper push the ball, and other robots, at 1.2 m/s",
       [](std::uint64_t) { return make_strategy<Pusher>(); }, published_drive(Pusher::kGains)});
  add({"wall", "a wall of defenders in front of the goal; one robot pushes the ball away, 0.8 m/s",
       [](std::uint64_t) { return make_strategy<Wall>(); }, published_drive(Wall::kGains)});
  add({"play", "the built-in play of this version", [](std::uint64_t) { return make_strategy<Play>(); }, {}});
}

const StrategyEntry* StrategyCatalog::find(std::string_view name) const {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const StrategyEntry& entry) { return entry.name == name; });
  return found == entries_.end() ? nullptr : &*found;
}

std::string StrategyCatalog::names() const {
  std::string names;
  for (const StrategyEntry& entry : entries_) names.append(names.empty() ? "" : ", ").append(entry.name);
  return names;
}

std::string StrategyCatalog::help() const {
  std::size_t width = 0;
  for (const StrategyEntry& entry : entries_) width = std::max(width, entry.name.size());
  std::string help;
  for (const StrategyEntry& entry : entries_) {
    help.append(entry.name).append(width + 2 - entry.name.size(), ' ').append(entry.description).append("\n");
  }
  return help;
}

Result<StrategyPointer> StrategyCatalog::create(std::string_view name, std::uint64_t seed) const {
  if (const StrategyEntry* entry = find(name)) return entry->create(seed);
  return failure(ErrorCode::kNotFound, "there is no strategy \"%.*s\"; choose one of %s", static_cast<int>(name.size()),
                 name.data(), names().c_str());
}

ControlParameters parameters_for(const StrategyEntry& entry, const ControlParameters& team) {
  ControlParameters parameters = team;
  if (entry.drive) {
    parameters.drive = *entry.drive;
    parameters.drive.wheel_base_m = team.drive.wheel_base_m;
  }
  return parameters;
}

}  // namespace touchline::hal::mock
