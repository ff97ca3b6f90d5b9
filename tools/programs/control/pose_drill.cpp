#include "tools/programs/control/pose_drill.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"
#include "tools/programs/control/time_bound.h"

namespace touchline::control_evaluation {
namespace {

using hal::mock::Placement;
using hal::mock::Side;

constexpr double kPi = std::numbers::pi;
constexpr double kNear_m = 0.003, kNear_rad = kPi / 180.0;
constexpr double kStaysFor_s = 0.2;  // an arrival is the begin of this time within the tolerance
constexpr double kPoseMargin_m = 0.12;
constexpr double kTime_s = 5.0;  // of one run
constexpr double kAllowance_s = 0.15;

struct Run {
  double time_s = kTime_s;  // of the arrival; the whole run if there is none
  bool arrived = false;
  double end_m = 0.0, end_rad = 0.0;
};

Run drive(Drill& drill, const Placement& from, const Placement& to) {
  drill.release(Side::kOwn);
  drill.world().place(0, from);
  drill.side(Side::kOwn).inputs().events.reset = true;
  drill.wait(0.3);
  const double begin = drill.time_s();
  drill.go(Side::kOwn, 0, {to.x_m, to.y_m}, to.theta_rad);
  Run run;
  double entered = -1.0;
  while (drill.time_s() - begin < kTime_s) {
    drill.step();
    const Placement at = drill.world().snapshot().robots[0];
    run.end_m = std::hypot(at.x_m - to.x_m, at.y_m - to.y_m);
    run.end_rad = std::abs(wrap_angle(at.theta_rad - to.theta_rad));
    const double now = drill.time_s() - begin;
    const bool is_near = run.end_m < kNear_m && run.end_rad < kNear_rad;
    if (!is_near) {
      entered = -1.0;
      continue;
    }
    if (entered < 0.0) entered = now;
    if (now - entered >= kStaysFor_s && !run.arrived) {
      run.arrived = true;
      run.time_s = entered;
    }
    if (now - entered >= 2.0 * kStaysFor_s) break;
  }
  return run;
}

}  // namespace

Result<PoseResult> pose_drill(const config::Configuration& configuration, int runs, std::uint64_t seed) {
  DrillSettings settings;
  settings.seed = seed;
  TOUCHLINE_TRY_ASSIGN(const std::unique_ptr<Drill> drill, Drill::make(configuration, settings));
  drill->world().place_ball({0.0, 3.0});
  hal::mock::Random random(seed, 101);
  std::vector<double> ratios, ends_m, ends_rad;
  PoseResult result;
  for (int i = 0; i < runs; ++i) {
    const auto pose = [&]() -> Placement {
      const Vector2 place = random_place(random, configuration.board.arena, kPoseMargin_m);
      return {place.x, place.y, 2.0 * kPi * (random.uniform() - 0.5)};
    };
    const Placement from = pose(), to = pose();
    const Run run = drive(*drill, from, to);
    const double bound =
        drill->mean_reaction_s() +
        least_time_s({{from.x_m, from.y_m}, from.theta_rad}, {{to.x_m, to.y_m}, to.theta_rad}, configuration.pipeline);
    ratios.push_back(run.time_s / (bound + kAllowance_s));
    ends_m.push_back(run.end_m);
    ends_rad.push_back(run.end_rad);
    result.mean_s += run.time_s / runs;
    result.bound_s += bound / runs;
    result.arrived += (run.arrived ? 1.0 : 0.0) / runs;
  }
  result.runs = runs;
  result.median = quantile(ratios, 0.5);
  result.p95 = quantile(ratios, 0.95);
  result.median_mm = 1e3 * quantile(ends_m, 0.5);
  result.p95_mm = 1e3 * quantile(ends_m, 0.95);
  result.p95_degrees = 180.0 / kPi * quantile(ends_rad, 0.95);
  return result;
}

}  // namespace touchline::control_evaluation
