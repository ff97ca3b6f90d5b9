#pragma once

#include <random>

#include "core/geometry/angle.h"
#include "core/identification/drive_estimator.h"
#include "core/identification/drive_excitation.h"
#include "hal/mock/radio_channel.h"
#include "tests/mock/noise_free_arena.h"

namespace touchline {

struct SimulatedCamera {
  double rate_hz = 60.0, latency_s = 0.006;
  double position_sigma_m = 0.0001, heading_sigma_rad = 0.001;
  double miss = 0.0;  // share of the pictures in which the robot is not found
};

/// Measures robot 0 of the arena's physics and radio, without pictures: 20 s take 20 ms.
class SimulatedMeasurement {
 public:
  SimulatedMeasurement(const hal::mock::ArenaParameters& parameters, const SimulatedCamera& camera, std::uint64_t seed,
                       const ExcitationLimits& limits = {}, int baud = 115200)
      : camera_(camera),
        world_(parameters, seed),
        channel_(parameters, baud, seed),
        excitation_(limits, seed),
        random_(static_cast<unsigned>(seed)) {
    excitation_.set_center(pose().position);
  }

  WheelWiring wiring;         // of the robot
  bool stands = false;        // commands are recorded, but none are sent
  double stiction_mps = 0.0;  // slower commands move nothing, faster ones are obeyed completely

  void run(double duration_s) {
    const Instant end = now_ + from_seconds(duration_s);
    while (now_ < end) step();
  }

  [[nodiscard]] Pose pose() const {
    const hal::mock::Placement placement = world_.snapshot().robots[0];
    return {{static_cast<float>(placement.x_m), static_cast<float>(placement.y_m)}, wrap_to_float(placement.theta_rad)};
  }
  [[nodiscard]] const hal::mock::World& world() const { return world_; }
  [[nodiscard]] double farthest_m() const { return farthest_; }

  DriveEstimator estimator;

 private:
  void step() {
    world_.step();
    now_ += std::chrono::milliseconds(1);
    channel_.deliver(now_, world_);
    const hal::mock::Placement at = world_.snapshot().robots[0];
    farthest_ = std::max(farthest_, std::hypot(at.x_m - start_.x_m, at.y_m - start_.y_m));
    if (now_ >= next_frame_) {
      next_frame_ = next_frame_ + from_seconds(1.0 / camera_.rate_hz);
      captured_ = now_;
      seen_ = pose();
      answer_ = now_ + from_seconds(camera_.latency_s);
    }
    if (now_ < answer_) return;
    answer_ = Instant::max();
    if (std::uniform_real_distribution<double>()(random_) >= camera_.miss) {
      std::normal_distribution<double> normal;
      seen_.position.x_m += static_cast<float>(camera_.position_sigma_m * normal(random_));
      seen_.position.y_m += static_cast<float>(camera_.position_sigma_m * normal(random_));
      seen_.theta_rad =
          wrap_to_float(static_cast<double>(seen_.theta_rad) + camera_.heading_sigma_rad * normal(random_));
      estimator.add_sighting(captured_, seen_);
    }
    if (now_ > solved_) {
      solved_ = now_ + from_seconds(DriveExcitation::kProbe_s);
      estimator.solve();
      const DriveEstimate& estimate = estimator.estimate();
      if (!excitation_.knows_wiring() && estimate.is_wiring_known) excitation_.set_wiring(estimate.wiring);
      if (estimate.lag_s.is_known) excitation_.set_lag(estimate.lag_s.value);
    }
    const WheelSpeeds wheels = excitation_.next(estimator.pose_after_commands(now_), now_);
    // The packet has whole millimeters per second.
    const auto rounded = [](float speed) { return 0.001f * std::round(1000.0f * speed); };
    const WheelSpeeds command{rounded(wheels.left_mps), rounded(wheels.right_mps)};
    const WheelSpeeds driven = wiring.wheels_of(command);
    const auto moved = [this](float speed) {
      return std::abs(static_cast<double>(speed)) < stiction_mps ? 0.0 : static_cast<double>(speed);
    };
    const std::array<hal::mock::Drive, 1> drives{{{0, moved(driven.left_mps), moved(driven.right_mps)}}};
    const Packet packet = hal::mock::packet_of(drives, sequence_++);
    if (!stands) static_cast<void>(channel_.send(bytes_of(packet), now_));
    static_cast<void>(estimator.add_command(std::max(now_, channel_.drained()), command));
  }

  SimulatedCamera camera_;
  hal::mock::World world_;
  hal::mock::RadioChannel channel_;
  DriveExcitation excitation_;
  std::mt19937 random_;
  Instant now_{}, next_frame_{}, captured_{}, answer_ = Instant::max();
  Pose seen_;
  Instant solved_{from_seconds(DriveExcitation::kProbe_s + 0.5)};
  hal::mock::Placement start_ = world_.snapshot().robots[0];
  double farthest_ = 0.0;
  std::uint8_t sequence_ = 0;
};

}  // namespace touchline
