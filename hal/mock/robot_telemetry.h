#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/radio/telemetry.h"
#include "core/time.h"
#include "core/types.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/random.h"

namespace touchline::hal::mock {

/// What the own robots send back (docs/radio.md), and the air and line that bring it: packets get lost, damaged, cut
/// and late as the others do. Draws from a random stream of its own: who listens does not change the game.
class RobotTelemetrySource {
 public:
  RobotTelemetrySource(const ArenaParameters& parameters, std::uint64_t seed);

  /// A packet that was due at robot `id`; `good`: it could be used.
  void heard(int id, bool good);
  void driven(int id, const WheelSpeeds& wheels);
  /// Lets robots speak and their words arrive, all that is due until `now`.
  void advance(Instant now);
  /// What the port has received: the oldest bytes, which are gone then.
  std::size_t read(std::span<std::byte> into);

 private:
  struct Robot {
    int id = 0;
    Instant next{};  // zero: not yet known
    std::uint8_t sequence = 0;
    float battery_v = 0.0f, speed_mps = 0.0f, link = 1.0f;
  };
  struct Flying {
    Instant arrival{};
    TelemetryPacket packet{};
    std::size_t size = 0;
  };

  void speak(Robot& robot, Instant now);
  void arrive(const Flying& flying);
  Robot* find(int id);

  ChannelParameters parameters_;
  Random random_;
  FixedVector<Robot, kMaxRobots> robots_;
  // At 50 Hz a robot, a second of delay and a second of mean jitter, less would do for most games; what does not fit is
  // lost like any other.
  FixedVector<Flying, 256> flying_;
  FixedVector<std::byte, 4096> received_;  // the buffer of a kernel's serial port
  Instant begin_{};
  bool begun_ = false;
};

}  // namespace touchline::hal::mock
