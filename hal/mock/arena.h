#pragma once

#include <atomic>
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
#include "hal/mock/game.h"
#include "hal/mock/picture_faults.h"
#include "hal/mock/radio_channel.h"
#include "hal/mock/renderer.h"
#include "hal/mock/sensor.h"
#include "hal/result.h"
#include "hal/true_places.h"

namespace touchline::hal::mock {

/// One exposure of the camera, not yet rendered: the scene when the shutter opens for the first row, and when it closes
/// for the last row.
struct Exposure {
  Snapshot begin, end;
  RowTiming rows;
  Instant capture_time{}, ready{};  // middle of the first row's exposure; time at which the picture is in memory
  std::uint32_t sequence = 0;
  double led = 0.0;  // share of the exposure in which the LED was on
};

/// How fast the time of an arena passes, as a person wants it. Any thread may change it.
class ArenaPace {
 public:
  void pause() { frames_.store(0, std::memory_order_relaxed); }
  void resume() { frames_.store(kWithoutEnd, std::memory_order_relaxed); }
  /// Pauses after so many frames, beside those of earlier calls.
  void step(int frames) {
    change([frames](int left) { return left == kWithoutEnd ? frames : left + frames; });
  }
  /// `speed`: times real time, for a clock that follows real time.
  void set_speed(double speed) { speed_.store(speed, std::memory_order_relaxed); }
  [[nodiscard]] double speed() const { return speed_.load(std::memory_order_relaxed); }
  /// Returns whether the time stands still until a change.
  [[nodiscard]] bool stands() const { return frames_.load(std::memory_order_relaxed) == 0; }
  /// The camera has taken a frame. One that was already due when the time was stopped is none of the next step's.
  void count_frame() {
    change([](int left) { return left > 0 ? left - 1 : left; });
  }

 private:
  static constexpr int kWithoutEnd = -1;

  template <typename Change>
  void change(Change next) {
    int left = frames_.load(std::memory_order_relaxed);
    while (!frames_.compare_exchange_weak(left, next(left), std::memory_order_relaxed)) {
    }
  }

  std::atomic<int> frames_{kWithoutEnd};  // until the time stands still
  std::atomic<double> speed_{1.0};
};

/// Runs a game and its camera on one time line. Time advances only by advance_to(), in steps of the world. Packets,
/// time-outs and exposures take effect in the order of time, on these steps: a packet on the first step after its
/// arrival, the opening and closing of the shutter on the first step at or after its time. If the exposure time or the
/// time of the readout is longer than the frame period, the camera takes fewer pictures. A rolling shutter exposes the
/// first rows of a picture while it still reads the last ones of the picture before. Nothing is allocated after
/// construction, except by inject().
class Arena {
 public:
  static constexpr Instant kBegin = Game::kBegin;

  /// `camera`: format, size, rate and number of buffers; `radio`: baud rate; `begin`: the instant of arena time 0.
  /// The parameters must have no violation (hal::mock::find_violation()).
  Arena(const ArenaParameters& parameters, const CameraSettings& camera, const RadioSettings& radio, std::uint64_t seed,
        Instant begin = kBegin);
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;
  ~Arena() = default;

  [[nodiscard]] Instant now() const { return now_; }
  /// Advances the time to `instant`. Does nothing if this time has passed.
  void advance_to(Instant instant);
  [[nodiscard]] bool fault_active(FaultKind kind) const { return fault_active(kind, now_); }
  [[nodiscard]] bool fault_active(FaultKind kind, Instant at) const;
  [[nodiscard]] const std::vector<ArenaFault>& faults() const { return faults_; }
  /// Returns the robots that pictures captured at this time do not show, as the function of this name.
  [[nodiscard]] std::uint32_t hidden_robots(Instant at) const;
  /// Adds a fault to those of the parameters; allocates. It must have no violation (hal::mock::find_violation()).
  void inject(const ArenaFault& fault);
  [[nodiscard]] ArenaPace& pace() { return pace_; }
  [[nodiscard]] const ArenaParameters& parameters() const { return parameters_; }
  [[nodiscard]] Instant begin() const { return game_.begin(); }

  void start_camera();
  void stop_camera() { streaming_ = false; }
  /// A reader takes or returns a buffer. The camera drops a frame if no buffer is free.
  void hold_buffer() { ++held_; }
  void release_buffer() { --held_; }
  /// The time at which the next frame will be in memory; empty if the camera does not stream.
  [[nodiscard]] std::optional<Instant> next_frame_ready() const;
  /// Removes and returns the oldest frame that is in memory; empty if there is none.
  std::optional<Exposure> take_exposure();
  /// Returns where robots and ball were at the capture time of this frame of the present game.
  [[nodiscard]] TruePlaces places_at_capture(const Exposure& exposure) const;
  /// Renders the frame into `out`, which holds the bytes of picture_layout(). Another thread than that which
  /// lets the time pass may call it, if nothing injects faults meanwhile.
  void render(const Exposure& exposure, std::span<std::uint8_t> out);

  /// Moves the robot or ball that the camera shows at `from` to where it shows `to`, within the walls, and stops it.
  /// kNotFound: nothing is at `from`; kBusy: another object is at `to`.
  Result<void> move_object(const PixelPoint& from, const PixelPoint& to);

  /// Switches ArenaParameters::led at now().
  void set_led(bool on);

  /// Scales the brightness by exposure time and gain; a value of 0 (not set) leaves it. The settings at construction
  /// apply from the beginning.
  void adjust_camera(const CameraSettings& settings);
  [[nodiscard]] const CameraSettings& camera() const { return camera_; }
  [[nodiscard]] Game& game() { return game_; }
  [[nodiscard]] const Game& game() const { return game_; }
  [[nodiscard]] World& world() { return game_.world(); }
  [[nodiscard]] const World& world() const { return game_.world(); }
  [[nodiscard]] RadioChannel& channel() { return game_.channel(); }
  [[nodiscard]] const RadioChannel& channel() const { return game_.channel(); }
  [[nodiscard]] const Lens& lens() const { return renderer_.lens(); }
  /// A caller that shares the arena with another thread locks this mutex during each call.
  [[nodiscard]] std::mutex& mutex() { return mutex_; }

 private:
  // An exposure in progress.
  struct OpenShutter {
    Exposure exposure;
    Instant since{};
    std::optional<Duration> led_on_before;  // time at which the LED's row begins
    bool led_known = false;
  };

  void update_shutter();
  void open_shutter();
  void watch_led(OpenShutter& shutter) const;
  void close_shutter(Exposure& exposure, Instant since);
  [[nodiscard]] Instant exposure_begin(std::uint64_t frame) const;
  // Returns how long the LED was on until `instant`, which must not be before the LED's last change.
  [[nodiscard]] Duration led_on_until(Instant instant) const {
    return led_on_time_ + (led_on_ ? instant - led_changed_ : Duration::zero());
  }
  std::span<const std::uint16_t> with_led(std::span<const std::uint16_t> picture, double share);

  const ArenaParameters parameters_;
  const CameraSettings camera_;
  std::vector<ArenaFault> faults_;
  ArenaPace pace_;
  Game game_;
  Renderer renderer_;
  Sensor sensor_;
  PictureFaults picture_faults_;
  Instant now_;

  bool streaming_ = false;
  Instant first_exposure_{};
  std::uint64_t next_frame_ = 0;
  // The next exposure begins when the previous one has taken its exposure time and its readout, so at most three
  // overlap.
  FixedVector<OpenShutter, 3> shutters_;
  bool led_on_ = false;
  Instant led_changed_{};
  Duration led_on_time_{};
  std::vector<std::uint16_t> led_picture_;
  FixedVector<Exposure, 32> waiting_;  // as many as the largest number of buffers in a board file
  int held_ = 0;
  std::mutex mutex_;
};

/// The arena's virtual time as a Clock: it does not advance while the processor works, and jumps in sleep_until(),
/// whose caller does not hold the arena's mutex. Only the thread that sleeps may read the time.
class ArenaClock : public Clock {
 public:
  explicit ArenaClock(Arena& arena) : arena_(arena) {}
  [[nodiscard]] Instant now() const override { return arena_.now(); }
  void sleep_until(Instant instant) override {
    const std::scoped_lock lock(arena_.mutex());
    arena_.advance_to(instant);
  }

 private:
  Arena& arena_;
};

}  // namespace touchline::hal::mock
