#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>

#include "core/pipeline.h"

namespace touchline::testing {

/// Combines the results of steps into one number, bit by bit (FNV-1a), without the frame and the stages' times.
class TraceDigest {
 public:
  void add(const StepTrace& trace) {
    for (const RobotSighting& robot : trace.sightings.robots) {
      add_all(robot.team, robot.id, robot.has_heading, robot.confidence, robot.doubt, robot.noise.xx, robot.noise.tt);
      add(robot.pose);
    }
    const BallSighting& ball = trace.sightings.ball;
    add_all(ball.seen, ball.position.x_m, ball.position.y_m, ball.confidence, trace.regions.size(), trace.runs.size());
    add_all(trace.tracks.capture_time, trace.tracks.action_time, trace.tracks.ball.state);
    const BallTrack& ball_track = trace.tracks.ball;
    add_all(ball_track.position_at_action.x_m, ball_track.position_at_action.y_m, ball_track.sigma_m);
    for (const RobotTrack& robot : trace.tracks.robots) {
      add_all(robot.team, robot.id, robot.state, robot.confidence, robot.sigma[0], robot.sigma[2], robot.innovation2);
      add(robot.pose);
      add(robot.pose_at_action);
      add(robot.twist_at_action);
    }
    add(trace.commands.stop);
    for (const RobotCommand& robot : trace.commands.robots) {
      add_all(robot.id, robot.source, robot.role, robot.wheels.left_mps, robot.wheels.right_mps);
      add(robot.twist);
    }
    add(trace.packets);
    const PictureTrace& picture = trace.picture;
    add_all(picture.repeats, picture.replays, picture.overloads, picture.hides_field, picture.contradicts,
            picture.jumps, picture.stands, picture.repeated_share, picture.repeated_s, picture.field_share,
            picture.overload_frames, picture.commanded, picture.standing, picture.contradicting);
    add_all(trace.light.brightness, trace.light.patches, trace.reports.packets, trace.reports.foreign_bytes);
    for (const RobotReport& robot : trace.reports.robots) {
      add_all(robot.last.id, robot.last.battery_v, robot.last.link_percent, robot.heard, robot.battery_low);
      const WheelSpeeds wheels = robot.last.wheels.value_or(WheelSpeeds{});
      add_all(wheels.left_mps, wheels.right_mps);
    }
    const DriveReports& drives = trace.drives;
    add_all(drives.delay_s.stated, drives.delay_s.used, drives.lag_s.used, drives.robots.size());
    for (const RobotDrive& robot : drives.robots) add_all(robot.id, robot.gain[0].used, robot.gain[1].used);
    add_all(trace.status.code(), trace.inputs_status.code(), trace.overload, trace.revoked);
  }
  void add(const OutgoingPackets& packets) {
    for (const OutgoingPacket& outgoing : packets) {
      add(outgoing.receiver);
      for (const std::byte byte : outgoing.packet) add(byte);
    }
  }
  template <class Scalar>
  requires std::is_scalar_v<Scalar>
  void add(Scalar value) {
    std::array<unsigned char, sizeof(Scalar)> bytes;
    std::memcpy(bytes.data(), &value, sizeof(Scalar));
    for (const unsigned char byte : bytes) value_ = (value_ ^ byte) * 0x100000001b3U;
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  void add(Instant instant) { add(instant.time_since_epoch().count()); }
  void add(const Pose& pose) { add_all(pose.position.x_m, pose.position.y_m, pose.theta_rad); }
  void add(const Twist& twist) { add_all(twist.v_mps, twist.w_radps); }
  template <class... Values>
  void add_all(const Values&... values) {
    (add(values), ...);
  }

  std::uint64_t value_ = 0xcbf29ce484222325U;
};

}  // namespace touchline::testing
