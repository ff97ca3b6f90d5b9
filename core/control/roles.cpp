#include "core/control/roles.h"

#include "core/linear_assignment.h"

namespace touchline {

void Roles::assign(const Players& players, const Openings& openings, double hysteresis_s) {
  constexpr std::size_t kSize = kMaxRobotsPerTeam + 1;
  std::array<double, kSize> row_potential{}, column_potential{}, slack{};
  std::array<std::size_t, kSize> row_of{}, before{};
  std::array<bool, kSize> visited{};
  const auto cost = [&](std::size_t opening, std::size_t player) {
    const Opening& job = openings[opening];
    bool holds = false;
    for (const Held& held : held_) holds = holds || (held.id == players[player].id && held.job == job.job);
    return job.weight * (job.time_s[player] - (holds ? hysteresis_s : 0.0));
  };
  const std::size_t columns = players.size() + 1;
  solve_assignment<double>(openings.size(), players.size(), cost,
                           {{row_potential.data(), openings.size() + 1},
                            {column_potential.data(), columns},
                            {slack.data(), columns},
                            {row_of.data(), columns},
                            {before.data(), columns},
                            {visited.data(), columns}});
  FixedVector<Held, kMaxRobotsPerTeam> held;
  for (std::size_t i = 0; i < players.size(); ++i) {
    const int opening = static_cast<int>(row_of[i + 1]) - 1;
    if (opening >= 0) held.push_back({players[i].id, opening, openings[static_cast<std::size_t>(opening)].job});
  }
  held_ = held;
}

int Roles::opening_of(RobotId id) const {
  for (const Held& held : held_) {
    if (held.id == id) return held.opening;
  }
  return -1;
}

RobotId Roles::holder_of(int opening) const {
  for (const Held& held : held_) {
    if (held.opening == opening) return held.id;
  }
  return kUnknownId;
}

}  // namespace touchline
