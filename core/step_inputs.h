#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "core/adaptation.h"
#include "core/control/control_parameters.h"
#include "core/control/external_command.h"
#include "core/control/referee_state.h"
#include "core/region/region_scanner.h"
#include "core/supervision/picture_check.h"
#include "core/types.h"

namespace touchline {

// At 30 frames per second more than 115200 baud can deliver.
constexpr std::size_t kMaxTelemetryBytes = 512;

// Reports of all robots in one frame, five times over for reports that came in parts.
constexpr std::size_t kMaxTelemetryParts = 5 * kMaxRobotsPerTeam;

/// Consecutive bytes of telemetry that one robot has sent.
struct TelemetryPart {
  std::size_t bytes = 0;
  std::size_t sender = kAllRobots;  // index of the layout's receivers; kAllRobots: unknown
};

/// The referee's assignment of colors and sides to the teams.
struct TeamAssignment {
  bool colors_exchanged = false;    // each team has the team color of the other one
  bool sides_exchanged = false;     // the own team defends the half with positive x
  std::array<float, 2> height_m{};  // height of the markers, by Team; 0: as configured

  friend bool operator==(const TeamAssignment&, const TeamAssignment&) = default;
};

/// What happened since the last step. Each event takes effect once, in the order of the members; the caller clears them
/// after the step.
struct StepEvents {
  // New thresholds, light map and region of interest, and the adaptation that belongs to them. Tracks and game
  // continue. Both are too large for a value; whoever reloads owns them, and a recording has to copy what they
  // point to before the step. The pipeline uses `tables` until others replace them, and copies `adaptation`. See
  // RegionScanner::exchange. Null: unchanged.
  ScanTables* tables = nullptr;
  const Adaptation* adaptation = nullptr;
  std::optional<AdaptationMode> adaptation_mode;  // wanted by a person; nullopt: unchanged
  std::optional<ControlParameters> control;       // new limits, gains and rules; nullopt: unchanged
  // Tracks and game begin anew after a long gap, for example because the camera was reopened.
  bool reset = false;
  // A person has started the robots, so the picture is trusted again (PictureCheck::acknowledge()).
  bool picture_acknowledged = false;
  // The radio was opened, so the next packets contain the layout's bytes for the start.
  bool radio_opened = false;
  // Bytes of the robots' telemetry, who has sent them (bytes beyond the parts: unknown), and the time at which the last
  // of them were received.
  FixedVector<std::byte, kMaxTelemetryBytes> telemetry;
  FixedVector<TelemetryPart, kMaxTelemetryParts> telemetry_parts;
  Instant telemetry_received{};
};

/// Everything that a step depends on beside its frame, the configuration and the former steps: two pipelines with the
/// same configuration that get the same frames and inputs give the same traces. The loop fills it; a recording can
/// store it, and another source of frames (a replay, the other side of an arena) can feed it. All times are on the
/// clock of Frame::capture_time. The default inputs are those of a frame on its own: nobody sends, commands or halts.
struct StepInputs {
  // Time of the step: arrival of the frame, or the time of a stop without a frame. The age of commands ends here.
  Instant now{};
  // Time from the capture of a frame until its commands act: the measured latency of the loop plus the delay of radio
  // and robots. Range 0 to 1 s.
  Duration action_delay{};
  // The part of it that the files state: from the last byte of a packet until the wheels react.
  Duration radio_delay{};
  // How much later than the action delay each receiver's commands act, because the packets of other robots take the
  // line first. The index is that of the team file's list own.robot.
  std::array<Duration, kMaxRobotsPerTeam> lateness{};
  // Commands of other programs and of the console's driver (Controller::set_external), with their times of reception.
  ExternalCommands commands;
  // The referee's assignment. New team colors reset tracks and game; positions remain in the venue's coordinates.
  TeamAssignment teams;
  // The referee's decision. Robots stand in phases in which they may neither play nor line up.
  GameSituation situation;
  // Reasons for which robots must stand, as bits of the firmware's Halt (also the referee's, and the silence of a
  // driver). With any of them, stop commands replace the controller's output.
  std::uint32_t halt = 0;
  // The commands are not sent (a replay, or robots that another program drives), so the filters treat them as unknown.
  bool observing = false;
  // Limits of the checks whose results are in StepTrace::picture.
  PictureCheckSettings picture_check;
  // Whether the frame's picture was unusable (PictureTrace::is_unusable()), for a replay that does not have it; tracks
  // begin anew after unusable pictures. nullopt: the checks tell.
  std::optional<bool> was_unusable;
  // What the measured drives changed, for a replay that does not know what was measured before. nullopt: as the
  // pipeline has measured.
  std::optional<DriveCorrections> drives;
  StepEvents events;
};
static_assert(std::is_trivially_copyable_v<StepInputs>, "a recorder copies it");

/// Returns the inputs of a program that only watches: StepInputs::observing.
inline StepInputs observing_inputs() {
  StepInputs inputs;
  inputs.observing = true;
  return inputs;
}

}  // namespace touchline
