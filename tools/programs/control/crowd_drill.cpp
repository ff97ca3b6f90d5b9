#include "tools/programs/control/crowd_drill.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace touchline::control_evaluation {
namespace {

using hal::mock::Side;

constexpr double kReached_m = 0.03;
constexpr double kCrowdMargin_m = 0.10;
// Two goals of one time are so far apart that two robots can stand there without contact, whatever their headings.
constexpr double kApart_m = 0.15;

}  // namespace

Result<CrowdResult> crowd_drill(const config::Configuration& configuration, const CrowdSettings& settings,
                                std::uint64_t seed) {
  DrillSettings of_drill;
  of_drill.seed = seed;
  of_drill.own = settings.own;
  of_drill.opponents = settings.opponents;
  of_drill.strict = settings.strict;
  if (settings.max_speed_mps > 0.0) of_drill.max_speed_mps = settings.max_speed_mps;
  TOUCHLINE_TRY_ASSIGN(const std::unique_ptr<Drill> drill, Drill::make(configuration, of_drill));
  drill->world().place_ball({0.0, 3.0});
  drill->wait(0.3);
  hal::mock::Random random(seed, 102);
  const auto count = static_cast<std::size_t>(settings.own) + static_cast<std::size_t>(settings.opponents);
  std::vector<Vector2> goals(count, Vector2{9.0, 9.0});
  std::vector<int> reached(count, 0);
  std::vector<double> since(count, drill->time_s());
  const auto next_goal = [&](std::size_t robot) {
    for (;;) {
      const Vector2 place = random_place(random, configuration.board.arena, kCrowdMargin_m);
      const bool is_free =
          std::none_of(goals.begin(), goals.end(), [&](Vector2 other) { return distance(other, place) < kApart_m; });
      if (!is_free) continue;
      goals[robot] = place;
      const Side side = drill->world().side(robot);
      // The opponents' side sees the field turned by 180 degrees.
      drill->go(side, static_cast<RobotId>(drill->world().id(robot)), side == Side::kOwn ? place : -place, {});
      since[robot] = drill->time_s();
      return;
    }
  };
  for (std::size_t i = 0; i < count; ++i) next_goal(i);
  CrowdResult result;
  std::array<std::array<double, kMaxRobots>, kMaxRobots> last{};
  int own = 0, mixed = 0;
  const double begin = drill->time_s();
  while (drill->time_s() - begin < settings.duration_s) {
    drill->step();
    const double now = drill->time_s();
    for (std::size_t i = 0; i < count; ++i) {
      for (std::uint32_t others = drill->world().touching(i) & ((1U << i) - 1U); others != 0; others &= others - 1U) {
        const auto other = static_cast<std::size_t>(std::countr_zero(others));
        constexpr double kSameContact_s = 0.2;
        if (now - last[i][other] > kSameContact_s)
          ++(drill->world().side(i) == drill->world().side(other) ? own : mixed);
        last[i][other] = now;
      }
    }
    const hal::mock::Snapshot all = drill->world().snapshot();
    for (std::size_t i = 0; i < count; ++i) {
      result.longest_s = std::max(result.longest_s, now - since[i]);
      if (std::hypot(all.robots[i].x_m - goals[i].x, all.robots[i].y_m - goals[i].y) > kReached_m) continue;
      ++reached[i];
      next_goal(i);
    }
  }
  const double minutes = settings.duration_s / 60.0, robots = static_cast<double>(count);
  int sum = 0;
  for (const int one : reached) sum += one;
  result.goals_per_minute = sum / minutes / robots;
  result.least_goals_per_minute = *std::min_element(reached.begin(), reached.end()) / minutes;
  result.own_contacts = own / minutes / robots;
  result.mixed_contacts = mixed / minutes / robots;
  return result;
}

}  // namespace touchline::control_evaluation
