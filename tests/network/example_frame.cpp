#include "tests/network/example_frame.h"

namespace touchline::network {
namespace {

RobotSighting sighting(Team team, RobotId id, Pose pose, bool has_heading) {
  RobotSighting robot;
  robot.team = team;
  robot.id = id;
  robot.pose = pose;
  robot.has_heading = has_heading;
  robot.residual_m = has_heading ? 0.0004f : 0.0f;
  robot.confidence = has_heading ? 0.9876f : 0.625f;
  const ColorId color = team == Team::kOwn ? 2 : 3;
  if (has_heading) robot.patches.push_back({PatchRole::kIdentification, 1, 4, {300.5f, 201.25f}});
  robot.patches.push_back({PatchRole::kTeam, 0, color, {310.0f + static_cast<float>(id), 200.0f}});
  return robot;
}

RobotTrack track(Team team, RobotId id, TrackState state, Pose pose, Twist twist) {
  RobotTrack robot;
  robot.team = team;
  robot.id = id;
  robot.state = state;
  robot.pose = pose;
  robot.twist = twist;
  robot.confidence = 0.9995f;
  return robot;
}

}  // namespace

Snapshot example_snapshot() {
  Snapshot snapshot;
  snapshot.number = 41;
  snapshot.frame_sequence = 50;
  snapshot.width_px = 640;
  snapshot.height_px = 480;
  snapshot.captured = Instant(from_seconds(12.25));
  snapshot.received = Instant(from_seconds(12.26));
  snapshot.sent = Instant(from_seconds(12.263));
  snapshot.ball = {true, {-0.5123f, 0.25f}, {123.5f, 321.25f}, 90, 0.0f, 0.8125f};
  snapshot.robots.push_back(sighting(Team::kOwn, 3, {{0.6612f, 0.5f}, -2.0227f}, true));
  snapshot.robots.push_back(sighting(Team::kOwn, kUnknownId, {{-0.1f, -0.2f}, 0.0f}, false));
  snapshot.robots.push_back(sighting(Team::kOpponent, 0, {{1.0f, -0.75f}, 3.125f}, true));
  snapshot.tracks.capture_time = snapshot.captured;
  snapshot.tracks.ball.state = TrackState::kSeen;
  snapshot.tracks.ball.position = {-0.5125f, 0.2505f};
  snapshot.tracks.ball.velocity = {0.5f, -0.25f};
  snapshot.tracks.robots.push_back(
      track(Team::kOwn, 3, TrackState::kSeen, {{0.6615f, 0.5005f}, -2.02f}, {0.5f, 1.25f}));
  snapshot.tracks.robots.push_back(track(Team::kOwn, 1, TrackState::kCoasting, {{-0.3f, 0.1f}, 0.5f}, {-0.25f, 0.0f}));
  snapshot.tracks.robots.push_back(
      track(Team::kOpponent, kUnknownId, TrackState::kNew, {{0.1f, 0.1f}, 0.0f}, {0.0f, 0.0f}));
  snapshot.tracks.robots.push_back(
      track(Team::kOpponent, 0, TrackState::kSeen, {{1.0005f, -0.7505f}, 3.12f}, {0.0f, -3.5f}));
  snapshot.commands.stop = false;
  snapshot.referee.phase = GamePhase::kRunning;
  snapshot.referee.received = Instant(from_seconds(12.2));
  snapshot.referee.score = Score{2, 1};
  snapshot.referee.restart = Restart::kFreeKick;
  snapshot.referee.half = 2;
  snapshot.commands.robots.push_back({3, {0.4f, 1.0f}, {0.365f, 0.435f}});
  RobotReport report;
  report.last = {3, 17, 7.412f, 98};
  report.heard = Instant(from_seconds(12.013));
  snapshot.reports.robots.push_back(report);
  report.last = {1, 4, 0.0f, kLinkUnknown};
  snapshot.reports.robots.push_back(report);
  return snapshot;
}

Snapshot fullest_snapshot() {
  Snapshot snapshot = example_snapshot();
  snapshot.number = 123456789012;
  snapshot.ball = {true, {-10.12345f, -10.12345f}, {-1234.567f, -1234.567f}, 4294967295u, 0.0f, 0.12345f};
  snapshot.tracks.ball.position = {-10.12345f, -10.12345f};
  snapshot.tracks.ball.velocity = {-10.12345f, -10.12345f};
  snapshot.robots.clear();
  snapshot.tracks.robots.clear();
  snapshot.commands.robots.clear();
  snapshot.reports.robots.clear();
  while (!snapshot.robots.full()) {
    const Team team = snapshot.robots.size() < kMaxRobotsPerTeam ? Team::kOwn : Team::kOpponent;
    const auto id = static_cast<RobotId>(127 - snapshot.robots.size());
    RobotSighting robot = sighting(team, id, {{-10.12345f, -10.12345f}, -3.12345f}, true);
    while (!robot.patches.full()) robot.patches.push_back({PatchRole::kIdentification, 1, 4, {-1234.567f, -1234.567f}});
    snapshot.robots.push_back(robot);
    snapshot.tracks.robots.push_back(track(team, id, TrackState::kCoasting, robot.pose, {-10.12345f, -100.12345f}));
  }
  for (RobotId id = 127; !snapshot.commands.robots.full(); --id) {
    snapshot.commands.robots.push_back({id, {-10.12345f, -100.12345f}, {-10.12345f, -10.12345f}});
    RobotReport report;
    report.last = {id, 17, 17.412f, 100, WheelSpeeds{-10.12345f, -10.12345f}};
    snapshot.reports.robots.push_back(report);
  }
  return snapshot;
}

OutputFrame example_output(const Snapshot& snapshot) {
  return {.snapshot = snapshot,
          .captured_unix_s = 1700000000.123456,
          .sent_unix_s = 1700000000.136,
          .own = TeamColor::kBlue,
          .camera_id = 2,
          .robot_height_m = {0.075f, 0.08f}};
}

VenueGeometry example_geometry() {
  VenueGeometry geometry;
  geometry.field.center_circle_m = 0.25f;
  // boards/mock/venue.toml
  geometry.camera.full = {559.05255f,
                          559.0975f,
                          321.87827f,
                          238.56964f,
                          -0.35717735f,
                          0.19421884f,
                          -0.0701541f,
                          -0.00029702982f,
                          0.00012308729f,
                          {3.0890722f, -0.032563932f, -0.06736899f},
                          {0.09848146f, -0.12213055f, 2.2966902f}};
  geometry.width_px = 640;
  geometry.height_px = 480;
  geometry.ball_radius_m = 0.02135f;
  geometry.robot_height_m = {0.075f, 0.08f};
  return geometry;
}

}  // namespace touchline::network
