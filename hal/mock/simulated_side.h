#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/pipeline.h"
#include "core/step_inputs.h"
#include "core/types.h"
#include "hal/line_time.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/observer.h"
#include "hal/mock/radio_channel.h"
#include "hal/mock/random.h"
#include "hal/mock/world.h"

namespace touchline::hal::mock {

/// How one side of a game sees its robots and reaches them.
struct SideSettings {
  PipelineParameters pipeline;
  Strategy* strategy = nullptr;  // plays instead of the built-in play; must outlive the side. Null: the built-in play
  double rate_hz = 60.0;         // of its camera
  // Time from the capture of a frame until it is in memory.
  Duration frame_latency{};
  // What the side believes: time from the last byte sent until the wheels react, and times on the line.
  Duration radio_delay{};
  LineTime line{};
};

/// Time from the middle of the exposure until a picture of this sensor is in memory.
inline Duration frame_latency(const SensorParameters& sensor) {
  return from_seconds(0.5 * sensor.exposure_s + sensor.readout_s + sensor.transfer_s);
}

/// Exchanges the teams of a pipeline's parameters, so that the opponent's robots become the own ones.
PipelineParameters for_opponent(PipelineParameters parameters);

/// One side of a game without pictures: it sees the world with the errors of its view, and its own pipeline tracks,
/// decides and sends packets, as the firmware's loop does with a camera. Processing takes no time. Nothing is allocated
/// after construction. The object is large (fixed memory).
class SimulatedSide {
 public:
  SimulatedSide(const ArenaParameters& parameters, Side side, std::uint64_t seed);

  /// Errors of Pipeline::configure().
  Status configure(const SideSettings& settings);

  /// Inputs of the next step: commands of other programs, referee, halts. The side fills times and delays itself, and
  /// clears the events after the step.
  [[nodiscard]] StepInputs& inputs() { return inputs_; }
  /// Tells the side before a step whether its robots must stand, and whether everything was put elsewhere, so that
  /// tracks begin anew.
  void hold(bool stands, bool restarts);
  /// Sets whether the camera delivers no frames, and whether the radio sends no packets.
  void set_faults(bool camera_stalled, bool radio_lost) {
    camera_stalled_ = camera_stalled;
    radio_lost_ = radio_lost;
  }
  /// Sets the robots that the camera does not see from now on: bit i is ArenaParameters::robot[i].
  void set_hidden_robots(std::uint32_t robots) { hidden_robots_ = robots; }
  /// Tells the side the referee's decision, and whether the teams play on each other's half.
  void set_referee(const GameSituation& situation, bool sides_exchanged) {
    inputs_.situation = situation;
    inputs_.teams.sides_exchanged = sides_exchanged;
  }
  /// Calls `on_step` after each step; `trace` is valid during the call. Null: nobody is called.
  void set_observer(void (*on_step)(void* context, const StepTrace& trace), void* context) {
    on_step_ = on_step;
    context_ = context;
  }
  /// Takes a frame if one is due, processes frames that have arrived, and sends their packets. Called by Game after
  /// each step of the world.
  void advance(Instant now, const World& world, RadioChannel& channel);

  [[nodiscard]] std::uint64_t frames() const { return frames_; }

 private:
  struct PendingFrame {
    Sightings sightings;
    Instant captured{}, arrives{};
    std::uint64_t number = 0;
  };

  void capture(Instant now, const World& world);
  void process(const PendingFrame& pending, Instant now, RadioChannel& channel);

  const ViewParameters view_;
  SideSettings settings_;
  Observer observer_;
  Random random_;
  std::unique_ptr<Pipeline> pipeline_;
  StepInputs inputs_;
  // A ring in the order of capture. With 200 frames per second and 30 ms of latency, six frames are on their way; a
  // late one, which delays those behind it, needs more.
  std::array<PendingFrame, 16> pending_;
  std::size_t first_ = 0, waiting_ = 0;
  std::uint64_t next_frame_ = 0, frames_ = 0;
  std::optional<std::uint64_t> reset_at_frame_;  // the first frame after everything was put elsewhere
  Instant begin_{};
  bool begun_ = false;
  bool camera_stalled_ = false, radio_lost_ = false;
  std::uint32_t hidden_robots_ = 0;
  Duration packet_time_{};
  void (*on_step_)(void* context, const StepTrace& trace) = nullptr;
  void* context_ = nullptr;
};

}  // namespace touchline::hal::mock
