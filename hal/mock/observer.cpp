#include "hal/mock/observer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/geometry/angle.h"
#include "hal/mock/rigid_body.h"

namespace touchline::hal::mock {
namespace {

constexpr std::array<std::uint64_t, 2> kViewStream{9, 10};  // by Side

// Returns whether the segment from `from` to `to` meets the square of this half side around the origin.
bool meets_square(Vector2 from, Vector2 to, double half_m) {
  double first = 0.0, last = 1.0;
  const auto clip = [&](double at, double step) {
    if (std::abs(step) < 1e-12) return std::abs(at) <= half_m;
    double enters = (-half_m - at) / step, leaves = (half_m - at) / step;
    if (enters > leaves) std::swap(enters, leaves);
    first = std::max(first, enters);
    last = std::min(last, leaves);
    return first <= last;
  };
  return clip(from.x, to.x - from.x) && clip(from.y, to.y - from.y);
}

float squared(double value) { return static_cast<float>(value * value); }

}  // namespace

Observer::Observer(const ArenaParameters& parameters, Side side, std::uint64_t seed)
    : parameters_(parameters.view),
      side_(side),
      robot_half_side_m_(0.5 * parameters.robot_side_m),
      robot_height_m_(parameters.robot_height_m),
      ball_radius_m_(parameters.ball_radius_m),
      camera_m_(parameters.camera.position_m),
      random_(seed, kViewStream[static_cast<std::size_t>(side)]) {}

Pose Observer::in_own_coordinates(Vector2 position, double theta) const {
  const double sign = side_ == Side::kOwn ? 1.0 : -1.0;
  const double turned = side_ == Side::kOwn ? theta : theta + std::numbers::pi;
  return {{static_cast<float>(sign * position.x), static_cast<float>(sign * position.y)}, wrap_to_float(turned)};
}

void Observer::drift(Bias& bias, const Placement& seen, double position_sigma_m, double heading_sigma_rad) {
  const Vector2 at{seen.x_m, seen.y_m};
  // A turn moves the patches over the pixels as a way does: by the angle times half the robot's side.
  const double moved =
      bias.begun ? length(at - bias.at) + robot_half_side_m_ * std::abs(wrap_angle(seen.theta_rad - bias.theta)) : 1e9;
  bias.at = at;
  bias.theta = seen.theta_rad;
  bias.begun = true;
  // An Ornstein-Uhlenbeck process in the way instead of time: correlation exp(-way / lasts).
  const double kept = std::exp(-moved / parameters_.bias_lasts_m), fresh = std::sqrt(1.0 - kept * kept);
  const auto next = [&](double value, double sigma) { return kept * value + fresh * sigma * random_.normal(); };
  bias.position_m.x = next(bias.position_m.x, position_sigma_m);
  bias.position_m.y = next(bias.position_m.y, position_sigma_m);
  bias.heading_rad = next(bias.heading_rad, heading_sigma_rad);
}

void Observer::observe_robot(const World& world, std::size_t robot, const Placement& truth, bool is_hidden,
                             Sightings& out) {
  Bias& bias = robots_[robot];
  drift(bias, truth, parameters_.robot_bias_m, parameters_.heading_bias_rad);
  const Vector2 noise{random_.normal(), random_.normal()};
  const double turn = random_.normal();
  // A hidden robot draws the same random numbers, so that it changes nothing else.
  if (random_.bernoulli(parameters_.miss) || is_hidden) return;
  RobotSighting seen;
  seen.team = world.side(robot) == side_ ? Team::kOwn : Team::kOpponent;
  seen.id = static_cast<RobotId>(world.id(robot));
  seen.has_heading = true;
  const Vector2 at = Vector2{truth.x_m, truth.y_m} + bias.position_m + parameters_.robot_noise_m * noise;
  seen.pose = in_own_coordinates(at, truth.theta_rad + bias.heading_rad + parameters_.heading_noise_rad * turn);
  seen.noise.xx = seen.noise.yy = squared(parameters_.robot_noise_m) + squared(parameters_.robot_bias_m);
  seen.noise.tt = squared(parameters_.heading_noise_rad) + squared(parameters_.heading_bias_rad);
  seen.lasting_share = seen.noise.xx > 0.0f ? squared(parameters_.robot_bias_m) / seen.noise.xx : 0.0f;
  seen.lasts_m = static_cast<float>(parameters_.bias_lasts_m);
  seen.confidence = 1.0f;
  out.robots.push_back(seen);
}

bool Observer::is_ball_hidden(const Snapshot& all, std::uint32_t hidden) const {
  const Vector2 ball{all.ball.x_m, all.ball.y_m}, camera{camera_m_[0], camera_m_[1]};
  if (robot_height_m_ <= ball_radius_m_) return false;
  // The ray from the ball's center to the camera leaves the height of the robots at this share of its way.
  const double share = (robot_height_m_ - ball_radius_m_) / (camera_m_[2] - ball_radius_m_);
  const Vector2 end = ball + share * (camera - ball);
  for (std::size_t i = 0; i < all.robots.size(); ++i) {
    // The field's appearance lies over an invisible robot, and a ball beside it is seen.
    if ((hidden >> i & 1U) != 0) continue;
    const Placement& robot = all.robots[i];
    const Vector2 center{robot.x_m, robot.y_m};
    if (meets_square(rotated(ball - center, -robot.theta_rad), rotated(end - center, -robot.theta_rad),
                     robot_half_side_m_)) {
      return true;
    }
  }
  return false;
}

void Observer::observe_ball(const Snapshot& all, std::uint32_t hidden, Sightings& out) {
  drift(ball_, all.ball, parameters_.ball_bias_m, 0.0);
  const Vector2 noise{random_.normal(), random_.normal()};
  out.ball = {};
  if (random_.bernoulli(parameters_.miss) || is_ball_hidden(all, hidden)) return;
  const Vector2 at = Vector2{all.ball.x_m, all.ball.y_m} + ball_.position_m + parameters_.ball_noise_m * noise;
  out.ball.seen = true;
  out.ball.position = in_own_coordinates(at, 0.0).position;
  const float variance = squared(parameters_.ball_noise_m) + squared(parameters_.ball_bias_m);
  out.ball.sigma_m = std::sqrt(variance);
  out.ball.lasting_share = variance > 0.0f ? squared(parameters_.ball_bias_m) / variance : 0.0f;
  out.ball.lasts_m = static_cast<float>(parameters_.bias_lasts_m);
  out.ball.confidence = 1.0f;
}

void Observer::observe(const World& world, Sightings& out, std::uint32_t hidden) {
  const Snapshot all = world.snapshot();
  out.robots.clear();
  out.verdicts.clear();
  out.cut_short = false;
  for (std::size_t i = 0; i < all.robots.size(); ++i) {
    observe_robot(world, i, all.robots[i], (hidden >> i & 1U) != 0, out);
  }
  observe_ball(all, hidden, out);
}

}  // namespace touchline::hal::mock
