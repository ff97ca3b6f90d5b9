#pragma once

#include "core/step_inputs.h"
#include "core/types.h"
#include "firmware/recording/field_archive.h"

// The members of each value that a recording holds. A struct that gets a member no longer compiles here, because a
// structured binding names all of them: a recording must not miss an input silently.
namespace touchline::recording {

template <auto kLast>
using LastIs = std::integral_constant<decltype(kLast), kLast>;
template <>
struct LastOf<Team> : LastIs<Team::kOpponent> {};
template <>
struct LastOf<PatchRole> : LastIs<PatchRole::kIdentification> {};
template <>
struct LastOf<IdDoubt> : LastIs<IdDoubt::kOverload> {};
template <>
struct LastOf<TrackState> : LastIs<TrackState::kLost> {};
template <>
struct LastOf<CommandSource> : LastIs<CommandSource::kExpired> {};
template <>
struct LastOf<PlayRole> : LastIs<PlayRole::kSupporter> {};
template <>
struct LastOf<ExternalCommand::Kind> : LastIs<ExternalCommand::Kind::kPose> {};
template <>
struct LastOf<GamePhase> : LastIs<GamePhase::kRunning> {};
template <>
struct LastOf<Restart> : LastIs<Restart::kFreeKick> {};
template <>
struct LastOf<AdaptationMode> : LastIs<AdaptationMode::kFrozen> {};

template <class Archive, Of<PixelPoint> Value>
void fields(Archive& archive, Value& value) {
  auto& [u, v] = value;
  archive(u, v);
}
template <class Archive, Of<FieldPoint> Value>
void fields(Archive& archive, Value& value) {
  auto& [x, y] = value;
  archive(x, y);
}
template <class Archive, Of<Pose> Value>
void fields(Archive& archive, Value& value) {
  auto& [position, theta] = value;
  archive(position, theta);
}
template <class Archive, Of<Twist> Value>
void fields(Archive& archive, Value& value) {
  auto& [v, w] = value;
  archive(v, w);
}
template <class Archive, Of<PoseCovariance> Value>
void fields(Archive& archive, Value& value) {
  auto& [xx, yy, tt, xy, xt, yt] = value;
  archive(xx, yy, tt, xy, xt, yt);
}
template <class Archive, Of<WheelSpeeds> Value>
void fields(Archive& archive, Value& value) {
  auto& [left, right] = value;
  archive(left, right);
}

// --- Sightings ------------------------------------------------------------------------------------------------------

template <class Archive, Of<PatchSighting> Value>
void fields(Archive& archive, Value& value) {
  auto& [role, patch, color, center] = value;
  archive(role, patch, color, center);
  if constexpr (!std::is_const_v<Value>) {
    if (patch >= kMaxPatches || color > kMaxColors) archive.refuse();
  }
}
template <class Archive, Of<RobotSighting> Value>
void fields(Archive& archive, Value& value) {
  auto& [team, id, has_heading, pose, residual, noise, lasting_share, lasts, confidence, patches, doubt, is_by_track] =
      value;
  static_cast<void>(is_by_track);  // matters only while the picture is there
  archive(team, id, has_heading, pose, residual, noise, lasting_share, lasts, confidence, patches, doubt);
}
template <class Archive, Of<BallSighting> Value>
void fields(Archive& archive, Value& value) {
  auto& [seen, position, center, area, sigma, confidence, lasting_share, lasts] = value;
  archive(seen, position, center, area, sigma, confidence, lasting_share, lasts);
}
/// Without the verdicts on single regions, which no later stage uses.
template <class Archive, Of<Sightings> Value>
void fields(Archive& archive, Value& value) {
  auto& [ball, robots, verdicts, cut_short] = value;
  archive(ball, robots, cut_short);
}

// --- Tracks, commands, packets --------------------------------------------------------------------------------------

template <class Archive, Of<RobotTrack> Value>
void fields(Archive& archive, Value& value) {
  auto& [team, id, state, pose, twist, pose_at_action, twist_at_action, sigma, xy_covariance, innovation2, last_seen,
         confidence] = value;
  archive(team, id, state, pose, twist, pose_at_action, twist_at_action, sigma, xy_covariance, innovation2, last_seen,
          confidence);
}
template <class Archive, Of<BallTrack> Value>
void fields(Archive& archive, Value& value) {
  auto& [state, position, velocity, position_at_action, velocity_at_action, sigma, innovation2, last_seen, confidence] =
      value;
  archive(state, position, velocity, position_at_action, velocity_at_action, sigma, innovation2, last_seen, confidence);
}
template <class Archive, Of<Tracks> Value>
void fields(Archive& archive, Value& value) {
  auto& [capture_time, action_time, ball, robots] = value;
  archive(capture_time, action_time, ball, robots);
}
template <class Archive, Of<RobotCommand> Value>
void fields(Archive& archive, Value& value) {
  auto& [id, twist, wheels, source, role] = value;
  archive(id, twist, wheels, source, role);
}
template <class Archive, Of<Commands> Value>
void fields(Archive& archive, Value& value) {
  auto& [stop, robots] = value;
  archive(stop, robots);
}
template <class Archive, Of<OutgoingPacket> Value>
void fields(Archive& archive, Value& value) {
  auto& [packet, receiver] = value;
  auto to = static_cast<std::uint64_t>(receiver);
  archive(packet, to);
  if constexpr (!std::is_const_v<Value>) receiver = static_cast<std::size_t>(to);
}

template <class Archive, Of<DriveCorrections::Wheels> Value>
void fields(Archive& archive, Value& value) {
  auto& [id, factor] = value;
  archive(id, factor);
}
template <class Archive, Of<DriveCorrections> Value>
void fields(Archive& archive, Value& value) {
  auto& [more_delay, lag, wheels] = value;
  archive(more_delay, lag, wheels);
}

// --- Inputs ---------------------------------------------------------------------------------------------------------

template <class Archive, Of<ExternalCommand> Value>
void fields(Archive& archive, Value& value) {
  auto& [id, kind, twist, wheels, target, has_heading, received] = value;
  archive(id, kind, twist, wheels, target, has_heading, received);
}
template <class Archive, Of<TelemetryPart> Value>
void fields(Archive& archive, Value& value) {
  auto& [bytes, sender] = value;
  auto count = static_cast<std::uint64_t>(bytes), from = static_cast<std::uint64_t>(sender);
  archive(count, from);
  if constexpr (!std::is_const_v<Value>) {
    bytes = static_cast<std::size_t>(count);
    sender = static_cast<std::size_t>(from);
  }
}
template <class Archive, Of<TeamAssignment> Value>
void fields(Archive& archive, Value& value) {
  auto& [colors_exchanged, sides_exchanged, height] = value;
  archive(colors_exchanged, sides_exchanged, height);
}
template <class Archive, Of<GameSituation> Value>
void fields(Archive& archive, Value& value) {
  auto& [phase, restart, ours, lines_up] = value;
  archive(phase, restart, ours, lines_up);
}
template <class Archive, Of<PictureCheckSettings> Value>
void fields(Archive& archive, Value& value) {
  auto& [stop_after, unusable_frames] = value;
  archive(stop_after, unusable_frames);
}
/// Without new settings: a recording has the files' text, from which a replay makes them.
template <class Archive, Of<StepEvents> Value>
void fields(Archive& archive, Value& value) {
  auto& [tables, adaptation, adaptation_mode, control, reset, picture_acknowledged, radio_opened, telemetry,
         telemetry_parts, telemetry_received] = value;
  archive(adaptation_mode, reset, picture_acknowledged, radio_opened, telemetry, telemetry_parts, telemetry_received);
}
template <class Archive, Of<StepInputs> Value>
void fields(Archive& archive, Value& value) {
  // `was_unusable` and `drives` are for a replay only, which takes them from StepHeader::is_unusable and
  // StepMessage::drives.
  auto& [now, action_delay, radio_delay, lateness, commands, teams, situation, halt, observing, picture_check,
         was_unusable, drives, events] = value;
  archive(now, action_delay, radio_delay, lateness, commands, teams, situation, halt, observing, picture_check, events);
}

}  // namespace touchline::recording
