#pragma once

#include <cstdint>
#include <optional>

#include "core/identification/wheel_wiring.h"
#include "core/types.h"

namespace touchline {

struct ExcitationLimits {
  double max_speed_mps = 0.5;  // of a wheel
  // Largest change of a wheel's speed at once. With a lag of 40 ms, 0.3 m/s ask for the acceleration at which tires
  // begin to slide (a friction of 0.8).
  double max_step_mps = 0.3;
  double radius_m = 0.15;  // the robot's center stays nearer to the place of the start
  double wheel_base_m = 0.07;
};

/// Wheel speeds that show delay, lag and gains. As long as the wiring is unknown, one wheel at a time drives to and
/// fro, which ends where it began for any wiring. Then both wheels jump to random speeds at random times; they are
/// chosen so that the robot comes back to the place of the start, so that it needs little room.
class DriveExcitation {
 public:
  /// The same `seed` gives the same choices at the same poses.
  DriveExcitation(const ExcitationLimits& limits, std::uint64_t seed) : limits_(limits), random_(seed) {}
  /// Sets the place around which the robot drives.
  void set_center(FieldPoint center) { center_ = center; }
  /// Ends the test of the wiring.
  void set_wiring(const WheelWiring& wiring);
  /// Slow wheels get more time for each speed.
  void set_lag(double lag_s) { lag_s_ = lag_s; }
  [[nodiscard]] bool knows_wiring() const { return wiring_.has_value(); }
  /// The time that one wheel after the other needs to show what it does.
  static constexpr double kProbe_s = 2.0;
  /// Wheel speeds for the command that acts at `acts_at`, when the robot's pose will be `pose`.
  WheelSpeeds next(const Pose& pose, Instant acts_at);

 private:
  [[nodiscard]] WheelSpeeds probe(Instant acts_at);
  [[nodiscard]] std::uint64_t bits();
  [[nodiscard]] double uniform() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }
  [[nodiscard]] double speed_near(double now_mps);

  ExcitationLimits limits_;
  std::uint64_t random_;
  FieldPoint center_;
  double lag_s_ = 0.08;
  std::optional<WheelWiring> wiring_;
  WheelSpeeds wheels_;  // on the robot's left and right
  Instant begin_{}, until_{};
  bool has_begun_ = false;
};

}  // namespace touchline
