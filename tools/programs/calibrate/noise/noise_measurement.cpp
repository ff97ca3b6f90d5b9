#include "tools/programs/calibrate/noise/noise_measurement.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/geometry/angle.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

using statistics::mean;

// From this many samples, a standard deviation is known to 13 %.
constexpr std::size_t kMinSightings = 30;
// Sightings farther from the median belong to another object. If more than the remaining share do, the object was
// moved.
constexpr double kSameObject_m = 0.01, kSameObjectShare = 0.9;
// Limits of the difference between the means of the first and the second half of a resting object's sightings: this
// many standard deviations, plus a distance for slow changes of the light and a soft floor.
constexpr double kMoved = 5.0, kSettles_m = 0.0002, kSettles_rad = 0.004;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Returns the unbiased variance.
double variance(const std::vector<double>& values) {
  const double center = mean(values);
  const double sum = std::accumulate(values.begin(), values.end(), 0.0, [center](double total, double value) {
    return total + (value - center) * (value - center);
  });
  return sum / static_cast<double>(values.size() - 1);
}

// Returns the difference between the means of the first and the second half.
double drift(const std::vector<double>& values) {
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  return std::abs(mean({values.begin(), half}) - mean({half, values.end()}));
}

bool has_moved(const std::vector<double>& values, double settles) {
  return drift(values) > settles + kMoved * 2.0 * std::sqrt(variance(values) / static_cast<double>(values.size()));
}

// Returns the standard deviation of the part of a measured variance that the pictures do not show.
double hidden_sigma(double measured_var, double shown_var) {
  return std::sqrt(std::max(0.0, measured_var - shown_var));
}

}  // namespace

void NoiseMeasurement::add(const Sightings& sightings) {
  for (const RobotSighting& robot : sightings.robots) {
    if (robot.id == kUnknownId || !robot.has_heading) continue;
    Observations& seen = robots_[{robot.team, robot.id}];
    seen.x.push_back(static_cast<double>(robot.pose.position.x_m));
    seen.y.push_back(static_cast<double>(robot.pose.position.y_m));
    // Angles are relative to the first one, so that none wraps.
    const double theta = static_cast<double>(robot.pose.theta_rad);
    seen.theta.push_back(seen.theta.empty() ? theta : seen.theta.front() + wrap_angle(theta - seen.theta.front()));
    // Errors that persist while a robot stands do not scatter.
    const float scatters = 1.0f - robot.lasting_share;
    seen.position_var.push_back(0.5 * static_cast<double>(scatters * (robot.noise.xx + robot.noise.yy)));
    seen.heading_var.push_back(static_cast<double>(scatters * robot.noise.tt));
  }
  const BallSighting& ball = sightings.ball;
  if (!ball.seen) return;
  ball_.x.push_back(static_cast<double>(ball.position.x_m));
  ball_.y.push_back(static_cast<double>(ball.position.y_m));
  ball_.position_var.push_back(static_cast<double>((1.0f - ball.lasting_share) * ball.sigma_m * ball.sigma_m));
}

Result<NoiseReport> NoiseMeasurement::report(const std::array<std::string, 2>& teams) const {
  NoiseReport out;
  struct Variances {
    double position = 0.0, heading = 0.0, shown_position = 0.0, shown_heading = 0.0;
  };
  const auto measure = [&out](const std::string& name, Observations seen) -> std::optional<Variances> {
    const auto leave_out = [&](const std::string& why) {
      out.left_out.push_back(name + ": " + why);
      return std::nullopt;
    };
    const std::size_t seen_in = seen.x.size();
    if (seen_in < kMinSightings) {
      return leave_out(formatted("seen in %zu frames, at least %zu are needed", seen_in, kMinSightings));
    }
    const double x = median(seen.x), y = median(seen.y);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < seen.x.size(); ++i) {
      if (std::hypot(seen.x[i] - x, seen.y[i] - y) > kSameObject_m) continue;
      for (auto* values : {&seen.x, &seen.y, &seen.theta, &seen.position_var, &seen.heading_var}) {
        if (!values->empty()) (*values)[kept] = (*values)[i];
      }
      ++kept;
    }
    for (auto* values : {&seen.x, &seen.y, &seen.theta, &seen.position_var, &seen.heading_var}) {
      if (!values->empty()) values->resize(kept);
    }
    const bool turned = !seen.theta.empty() && kept >= kMinSightings && has_moved(seen.theta, kSettles_rad);
    const double share = static_cast<double>(kept) / static_cast<double>(seen_in);
    if (kept < kMinSightings || share < kSameObjectShare || turned || has_moved(seen.x, kSettles_m) ||
        has_moved(seen.y, kSettles_m)) {
      return leave_out("it moved");
    }
    Variances v;
    v.position = 0.5 * (variance(seen.x) + variance(seen.y));
    v.shown_position = mean(seen.position_var);
    if (!seen.theta.empty()) {
      v.heading = variance(seen.theta);
      v.shown_heading = mean(seen.heading_var);
    }
    out.objects.push_back({name, kept, std::sqrt(v.position), std::sqrt(v.heading), std::sqrt(v.shown_position),
                           std::sqrt(v.shown_heading)});
    return v;
  };

  Variances sum;
  std::size_t robots = 0;
  for (const auto& [robot, seen] : robots_) {
    const std::string name = teams[static_cast<std::size_t>(robot.first)] + " " + std::to_string(robot.second);
    const std::optional<Variances> v = measure(name, seen);
    if (!v) continue;
    ++robots;
    sum.position += v->position;
    sum.heading += v->heading;
    sum.shown_position += v->shown_position;
    sum.shown_heading += v->shown_heading;
  }
  if (robots == 0) {
    std::string text = "no robot stands still in the pictures:";
    for (const std::string& line : out.left_out) text += "\n  " + line;
    return Error{ErrorCode::kInconsistent, text};
  }
  const auto count = static_cast<double>(robots);
  out.entry.robot_position_m = hidden_sigma(sum.position / count, sum.shown_position / count);
  out.entry.robot_heading_rad = hidden_sigma(sum.heading / count, sum.shown_heading / count);
  if (ball_.x.empty()) return out;
  if (const std::optional<Variances> v = measure("ball", ball_)) {
    out.has_ball = true;
    out.entry.ball_position_m = hidden_sigma(v->position, v->shown_position);
  }
  return out;
}

}  // namespace touchline::calibrate
