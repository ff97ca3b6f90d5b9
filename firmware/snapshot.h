#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/control/referee_state.h"
#include "core/radio/packet_layout.h"
#include "core/step_inputs.h"
#include "core/types.h"
#include "firmware/stop_rules.h"
#include "hal/true_places.h"

namespace touchline {

/// Results of one frame for other threads than the loop's: its StepTrace without pixels, runs and regions. Fixed size,
/// so that it passes through a SnapshotRing.
struct Snapshot {
  std::uint64_t number = 0;          // number of the processed frame, counted from 0, without gaps even across sessions
  std::uint32_t frame_sequence = 0;  // number from the driver; gaps are lost frames
  std::uint16_t width_px = 0, height_px = 0;
  // Times on the loop's clock. `captured` is the middle of the exposure; at `sent` the radio accepted the packet.
  Instant captured{}, received{}, sent{};
  Instant machine_sent{};  // CLOCK_MONOTONIC at `sent`; differs from it in simulated time
  Duration latency{};      // from capture to `sent`, including the processing time of the machine (StepTiming::latency)
  std::array<Duration, kStageCount> stage_time{};
  BallSighting ball;
  FixedVector<RobotSighting, kMaxRobots> robots;
  Tracks tracks;
  hal::TruePlaces truth;
  Commands commands;
  Commands sent_commands;  // Pipeline::sent_commands()
  PlayDecisions play;
  LightTrace light;
  PictureTrace picture;
  RobotReports reports;
  Status status;                   // status of the scan: kUnsupported (no sightings), kFull (see overload)
  bool overload = false;           // a capacity was reached
  std::uint32_t halt = kHaltNone;  // bits of Halt after the frame
  std::uint32_t stop_number = 0;   // ExternalInput::stop_number()
  bool is_held = false;            // StopRules::is_held()
  RefereeState referee;            // referee state in effect; own_on_positive_half is always set
  std::uint32_t packet_bytes = 0;  // of all packets of the frame
  // While a robot is tested (ConsoleInput::tested): its packet of this frame, and all telemetry since the last one.
  FixedVector<std::byte, kMaxPacketBytes> sent_bytes;
  FixedVector<std::byte, kMaxTelemetryBytes> received_bytes;
};
static_assert(std::is_trivially_copyable_v<Snapshot>, "SnapshotRing copies it word by word");

/// Copies the results of the pipeline. The caller sets the other members.
void copy_trace(const StepTrace& trace, Snapshot& out);
/// Copies the bytes of robot `tested`; kUnknownId: none. `layout`: that of the packets.
void copy_bytes(const StepTrace& trace, const PacketLayout& layout, RobotId tested, Snapshot& out);

}  // namespace touchline
