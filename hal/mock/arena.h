#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/time.h"
#include "core/types.h"
#include "hal/clock.h"
#include "hal/device_parameters.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/radio_channel.h"
#include "hal/mock/renderer.h"
#include "hal/mock/sensor.h"
#include "hal/mock/world.h"

namespace touchline::hal::mock {

/// One frame that the camera has taken, before it is drawn.
struct Shot {
  Snapshot begin, end;
  Instant capture_time{}, ready{};
  std::uint32_t sequence = 0;
};

/// World, radio and camera on one time line. Time moves when somebody asks for it, in steps of the world; what is due
/// on the way (packets, time-outs, exposures) happens in the order of time, on the world's steps: a packet acts on the
/// first step after its arrival, a shutter opens and closes with the first one that ends after its time. A camera that
/// exposes for longer than its rate allows takes fewer pictures. Nothing is allocated after construction.
class Arena {
 public:
  // Not zero: an instant that nobody has set is told apart from one at the begin.
  static constexpr Instant kBegin{std::chrono::seconds(1)};

  /// `camera`: format, size, rate and buffers; `radio`: the line's speed. `begin`: the instant of arena time 0.
  /// The parameters must be valid (hal::mock::validate).
  Arena(const ArenaParameters& parameters, const CameraSettings& camera, const RadioSettings& radio, std::uint64_t seed,
        Instant begin = kBegin);
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;
  ~Arena() = default;

  [[nodiscard]] Instant now() const { return now_; }
  /// Does nothing for instants that have passed.
  void advance_to(Instant instant);
  [[nodiscard]] bool faulty(FaultKind kind) const { return faulty(kind, now_); }
  [[nodiscard]] bool faulty(FaultKind kind, Instant at) const;
  [[nodiscard]] const std::vector<ArenaFault>& faults() const { return parameters_.fault; }
  [[nodiscard]] Instant begin() const { return begin_; }

  void start_camera();
  void stop_camera() { streaming_ = false; }
  /// Somebody holds a buffer, or gives it back. The camera drops a frame when no buffer is left for it.
  void hold_buffer() { ++held_; }
  void release_buffer() { --held_; }
  /// When the next frame will be in memory, if the camera streams.
  [[nodiscard]] std::optional<Instant> next_ready() const;
  /// The oldest frame that is in memory by now.
  std::optional<Shot> take_shot();
  /// Draws it; `out` holds layout_of() bytes.
  void draw(const Shot& shot, std::span<std::uint8_t> out);

  /// Exposure time and gain of `settings` against those of the construction, where both are given, make the pictures
  /// brighter or darker.
  void adjust_camera(const CameraSettings& settings);
  [[nodiscard]] const CameraSettings& camera() const { return camera_; }
  [[nodiscard]] World& world() { return world_; }
  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] RadioChannel& channel() { return channel_; }
  [[nodiscard]] const RadioChannel& channel() const { return channel_; }
  [[nodiscard]] const Lens& lens() const { return renderer_.lens(); }
  /// Whoever shares the arena with another thread holds it during a call.
  [[nodiscard]] std::mutex& mutex() { return mutex_; }

 private:
  void open_or_close_shutter();
  [[nodiscard]] Instant exposure_begin(std::uint64_t frame) const;

  const ArenaParameters parameters_;
  const CameraSettings camera_;
  World world_;
  RadioChannel channel_;
  Renderer renderer_;
  Sensor sensor_;
  Instant begin_, now_, stepped_;

  bool streaming_ = false;
  Instant first_exposure_{};
  std::uint64_t next_frame_ = 0;
  std::optional<Shot> exposing_;
  Instant exposing_since_{};
  FixedVector<Shot, 32> waiting_;  // as many as a driver may have buffers
  int held_ = 0;
  std::mutex mutex_;
};

/// Arena time as the system's clock: it stands still while the processor works and jumps when somebody waits.
class ArenaClock : public Clock {
 public:
  explicit ArenaClock(Arena& arena) : arena_(arena) {}
  [[nodiscard]] Instant now() const override { return arena_.now(); }
  void sleep_until(Instant instant) override { arena_.advance_to(instant); }

 private:
  Arena& arena_;
};

}  // namespace touchline::hal::mock
