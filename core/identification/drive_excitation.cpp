#include "core/identification/drive_excitation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/vector2.h"

namespace touchline {
namespace {

// Duration of constant speeds. The shortest is about a third of the lag of common robots, so that delay and lag have
// different effects. After the longest, a wheel runs nearly evenly, which shows its gain and its dead zone.
constexpr double kMinDuration_s = 0.05, kMaxLags = 3.0;
constexpr int kCandidates = 24;
// Slower speeds than this share of the maximum could be inside the dead zone, in which a wheel shows nothing.
constexpr double kMinShare = 0.12;

// The position after driving at these speeds for some time, along a chord of the arc.
Vector2 position_after(const Pose& pose, const WheelSpeeds& wheels, double time_s, double wheel_base_m) {
  const double left = static_cast<double>(wheels.left_mps), right = static_cast<double>(wheels.right_mps);
  const double turn = time_s * (right - left) / wheel_base_m, way = 0.5 * time_s * (left + right);
  const double half = 0.5 * turn, chord = std::abs(half) > 1e-6 ? std::sin(half) / half : 1.0;
  return position(pose) + way * chord * unit_vector(heading(pose) + half);
}

}  // namespace

// SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t DriveExcitation::bits() {
  std::uint64_t z = random_ += 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31U);
}

double DriveExcitation::speed_near(double now_mps) {
  const double most = limits_.max_speed_mps;
  const double low = std::max(-most, now_mps - limits_.max_step_mps);
  const double high = std::min(most, now_mps + limits_.max_step_mps);
  const double speed = low + (high - low) * uniform(), lowest = kMinShare * most;
  if (std::abs(speed) >= lowest) return speed;
  return low <= 0.0 && high >= 0.0 ? 0.0 : std::copysign(lowest, now_mps);
}

void DriveExcitation::set_wiring(const WheelWiring& wiring) {
  wiring_ = wiring;
  wheels_ = {};
  until_ = {};
}

// Left forward and backward, then right: each for a quarter of the time.
WheelSpeeds DriveExcitation::probe(Instant acts_at) {
  const double share = std::fmod(seconds(acts_at - begin_) / kProbe_s, 1.0);
  const int part = static_cast<int>(4.0 * share);
  const auto speed = static_cast<float>((part % 2 == 0 ? 1.0 : -1.0) * 0.5 * limits_.max_step_mps);
  return part < 2 ? WheelSpeeds{speed, 0.0f} : WheelSpeeds{0.0f, speed};
}

WheelSpeeds DriveExcitation::next(const Pose& pose, Instant acts_at) {
  if (!has_begun_) begin_ = acts_at;
  has_begun_ = true;
  if (!wiring_) return probe(acts_at);
  if (acts_at < until_) return wiring_->command_of(wheels_);
  const double time_s = kMinDuration_s + kMaxLags * lag_s_ * uniform();
  until_ = acts_at + from_seconds(time_s);
  double nearest = std::numeric_limits<double>::infinity();
  WheelSpeeds chosen;
  for (int i = 0; i < kCandidates && nearest > limits_.radius_m; ++i) {
    const WheelSpeeds candidate{static_cast<float>(speed_near(static_cast<double>(wheels_.left_mps))),
                                static_cast<float>(speed_near(static_cast<double>(wheels_.right_mps)))};
    const double away = distance(position_after(pose, candidate, time_s, limits_.wheel_base_m), to_vector(center_));
    if (away >= nearest) continue;
    nearest = away;
    chosen = candidate;
  }
  wheels_ = chosen;
  return wiring_->command_of(wheels_);
}

}  // namespace touchline
