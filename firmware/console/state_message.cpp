#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/control/play_table.h"
#include "firmware/console/messages.h"
#include "firmware/console/protocol.h"
#include "firmware/report/trace_json.h"

namespace touchline::console {
namespace {

using report::JsonWriter;
using report::kMeterStep;
using report::kRadianStep;
using report::kSpeedStep;
using report::write_identity;
using report::write_number;

constexpr double kVarianceStep = 1e-9;
constexpr double kOutlineStep = 0.1;
constexpr double kMillisecondStep = 1e-3;

std::string_view word_of_phase(GamePhase phase) {
  constexpr std::array<std::string_view, 5> kWords{"no referee", "halt", "stop", "prepare", "running"};
  return kWords[static_cast<std::size_t>(phase)];
}

void write_place(JsonWriter& json, FieldPoint place) {
  write_number(json, "x_m", place.x_m, kMeterStep);
  write_number(json, "y_m", place.y_m, kMeterStep);
}

void write_pixel(JsonWriter& json, PixelPoint pixel) {
  write_number(json, "u_px", pixel.u_px, kOutlineStep);
  write_number(json, "v_px", pixel.v_px, kOutlineStep);
}

template <class List, class Write>
void write_list(JsonWriter& json, std::string_view key, const List& list, const Write& write) {
  json.key(key);
  json.begin_array();
  for (const auto& element : list) write(element);
  json.end_array();
}

void write_ball(JsonWriter& json, const BallSighting& ball) {
  if (!ball.seen) return json.null();
  json.begin_object();
  write_place(json, ball.position);
  write_pixel(json, ball.center);
  write_number(json, "confidence", ball.confidence, report::kConfidenceStep);
  json.end_object();
}

void write_outline(JsonWriter& json, const Scene& scene, const RobotSighting& robot) {
  json.begin_array();
  for (const PixelPoint pixel : outline_px(scene, robot)) {
    if (!robot.has_heading) break;
    json.begin_array();
    json.number(report::rounded(static_cast<double>(pixel.u_px), kOutlineStep));
    json.number(report::rounded(static_cast<double>(pixel.v_px), kOutlineStep));
    json.end_array();
  }
  json.end_array();
}

void write_sighting(JsonWriter& json, const Scene& scene, const RobotSighting& robot) {
  const MarkerLayout& layout = scene.configuration->pipeline.marker.teams[index_of(robot.team)].layout;
  json.begin_object();
  write_identity(json, word_of(robot.team), robot.id);
  write_place(json, robot.pose.position);
  json.key("heading_rad");
  if (robot.has_heading) {
    json.number(report::rounded(static_cast<double>(robot.pose.theta_rad), kRadianStep));
  } else {
    json.null();
  }
  write_pixel(json, scene.model.to_pixel(robot.pose.position, layout.height_m));
  write_number(json, "confidence", robot.confidence, report::kConfidenceStep);
  if (robot.doubt != IdDoubt::kNone) {
    json.key("doubt");
    json.string(describe(robot.doubt));
  }
  json.key("outline_px");
  write_outline(json, scene, robot);
  json.end_object();
}

void write_truth(JsonWriter& json, const hal::TruePlaces& truth) {
  json.begin_object();
  json.key("ball");
  json.begin_object();
  write_place(json, truth.ball);
  json.end_object();
  write_list(json, "robots", truth.robots, [&](const hal::TruePlaces::Robot& robot) {
    json.begin_object();
    write_identity(json, word_of(robot.team), robot.id);
    write_place(json, robot.pose.position);
    write_number(json, "heading_rad", robot.pose.theta_rad, kRadianStep);
    json.end_object();
  });
  json.end_object();
}

void write_ball_track(JsonWriter& json, const BallTrack& ball) {
  if (ball.state == TrackState::kLost) return json.null();
  json.begin_object();
  json.key("seen");
  json.boolean(ball.state != TrackState::kCoasting);
  write_place(json, ball.position);
  write_number(json, "vx_mps", ball.velocity.x_m, kSpeedStep);
  write_number(json, "vy_mps", ball.velocity.y_m, kSpeedStep);
  write_number(json, "sigma_m", ball.sigma_m, kMeterStep);
  json.key("action");
  json.begin_object();
  write_place(json, ball.position_at_action);
  json.end_object();
  write_number(json, "confidence", ball.confidence, report::kConfidenceStep);
  json.end_object();
}

void write_track(JsonWriter& json, const RobotTrack& robot) {
  json.begin_object();
  write_identity(json, word_of(robot.team), robot.id);
  json.key("seen");
  json.boolean(robot.state != TrackState::kCoasting);
  write_place(json, robot.pose.position);
  write_number(json, "heading_rad", robot.pose.theta_rad, kRadianStep);
  write_number(json, "speed_mps", robot.twist.v_mps, kSpeedStep);
  write_number(json, "turn_radps", robot.twist.w_radps, kSpeedStep);
  write_number(json, "sigma_x_m", robot.sigma[0], kMeterStep);
  write_number(json, "sigma_y_m", robot.sigma[1], kMeterStep);
  write_number(json, "covariance_xy_m2", robot.xy_covariance_m2, kVarianceStep);
  write_number(json, "sigma_heading_rad", robot.sigma[2], kRadianStep);
  json.key("action");
  json.begin_object();
  write_place(json, robot.pose_at_action.position);
  write_number(json, "heading_rad", robot.pose_at_action.theta_rad, kRadianStep);
  json.end_object();
  write_number(json, "confidence", robot.confidence, report::kConfidenceStep);
  json.end_object();
}

std::string_view word_of_source(const RobotCommand& command, const ConsoleInput& console) {
  switch (command.source) {
    case CommandSource::kPlay:
      return "play";
    case CommandSource::kExpired:
      return "expired";
    case CommandSource::kExternal:
      break;
  }
  const bool is_console = std::any_of(console.commands.begin(), console.commands.end(),
                                      [&](const ExternalCommand& own) { return own.id == command.id; });
  return is_console ? "console" : "external";
}

void write_command(JsonWriter& json, const RobotCommand& command, const ConsoleInput& console) {
  json.begin_object();
  json.key("id");
  json.integer(command.id);
  write_number(json, "left_mps", command.wheels.left_mps, kSpeedStep);
  write_number(json, "right_mps", command.wheels.right_mps, kSpeedStep);
  json.key("source");
  json.string(word_of_source(command, console));
  json.end_object();
}

std::string_view word_of_role(PlayRole role) {
  constexpr std::array<std::string_view, 4> kWords{"", "goalkeeper", "attacker", "supporter"};
  return kWords[static_cast<std::size_t>(role)];
}

void write_role(JsonWriter& json, const RobotCommand& command) {
  if (command.role == PlayRole::kNone) return;
  json.begin_object();
  json.key("id");
  json.integer(command.id);
  json.key("role");
  json.string(word_of_role(command.role));
  json.end_object();
}

// Words of a decision's lines in the tables of the play.
void write_decision(JsonWriter& json, const PlayDecision& decision) {
  const auto write_text = [&](const char* key, std::string_view text) {
    json.key(key);
    json.string(text);
  };
  json.begin_object();
  json.key("id");
  json.integer(decision.id);
  if (decision.job_line < job_table().size()) write_text("job", job_table()[decision.job_line].name);
  if (decision.skill_line < skill_table().size()) {
    write_text("skill", skill_table()[decision.skill_line].name);
    write_text("why", skill_table()[decision.skill_line].reason);
  }
  if (decision.target) {
    json.key("target");
    json.begin_object();
    write_place(json, *decision.target);
    if (decision.direction_rad) write_number(json, "heading_rad", *decision.direction_rad, kRadianStep);
    json.end_object();
  }
  if (decision.time_s >= 0.0f) write_number(json, "time_s", decision.time_s, kMillisecondStep);
  json.end_object();
}

void write_score(JsonWriter& json, const std::optional<Score>& of_referee, const std::optional<Score>& told) {
  const std::optional<Score>& score = of_referee ? of_referee : told;
  if (!score) return json.null();
  json.begin_object();
  json.key("own");
  json.integer(score->own);
  json.key("opponent");
  json.integer(score->opponent);
  json.key("source");
  json.string(of_referee ? "referee" : "console");
  json.end_object();
}

void write_picture(JsonWriter& json, const PictureTrace& picture) {
  json.begin_object();
  write_number(json, "repeated", picture.repeated_share, 1e-3);
  write_number(json, "repeated_s", picture.repeated_s, 1e-3);
  json.key("field");
  if (picture.field_share >= 0.0f) {
    json.number(report::rounded(static_cast<double>(picture.field_share), 1e-3));
  } else {
    json.null();
  }
  for (const auto& [key, count] : {std::pair{"overload_frames", std::int64_t{picture.overload_frames}},
                                   {"commanded", picture.commanded},
                                   {"standing", picture.standing},
                                   {"contradicting", picture.contradicting}}) {
    json.key(key);
    json.integer(count);
  }
  json.end_object();
}

}  // namespace

void write_halt(JsonWriter& json, std::uint32_t halt) {
  write_list(json, "halt", kHaltDescriptions, [&](const HaltDescription& reason) {
    if ((halt & reason.bit) != 0) json.string(reason.word);
  });
}

void write_state(JsonWriter& json, const Scene& scene, const Snapshot& snapshot, const ConsoleInput& console,
                 const hal::UnixTimeOffset& unix_time, const std::optional<Score>& told) {
  json.begin_object();
  json.key("type");
  json.string("state");
  json.key("number");
  json.integer(static_cast<std::int64_t>(snapshot.number));
  json.key("frame");
  json.integer(snapshot.frame_sequence);
  write_number(json, "captured_s", captured_unix_s(snapshot, unix_time), report::kSecondStep);
  write_number(json, "sent_s", seconds(unix_time.to_unix(snapshot.machine_sent)), report::kSecondStep);
  write_number(json, "latency_ms", seconds(snapshot.latency) * 1e3, kMillisecondStep);
  json.key("ball");
  write_ball(json, snapshot.ball);
  write_list(json, "robots", snapshot.robots, [&](const RobotSighting& robot) { write_sighting(json, scene, robot); });
  if (snapshot.truth.is_known) {
    json.key("truth");
    write_truth(json, snapshot.truth);
  }
  json.key("ball_track");
  write_ball_track(json, snapshot.tracks.ball);
  write_list(json, "tracks", snapshot.tracks.robots, [&](const RobotTrack& robot) { write_track(json, robot); });
  write_list(json, "commands", snapshot.commands.robots,
             [&](const RobotCommand& command) { write_command(json, command, console); });
  json.key("stop");
  json.boolean(snapshot.commands.stop);
  write_halt(json, snapshot.halt);
  json.key("stop_number");
  json.integer(snapshot.stop_number);
  json.key("waits_for_start");
  json.boolean(snapshot.is_held || (snapshot.halt & kHaltConsole) != 0);
  json.key("picture");
  write_picture(json, snapshot.picture);
  json.key("referee");
  json.begin_object();
  json.key("phase");
  json.string(word_of_phase(snapshot.referee.phase));
  json.end_object();
  json.key("score");
  write_score(json, snapshot.referee.score, told);
  write_list(json, "roles", snapshot.commands.robots, [&](const RobotCommand& command) { write_role(json, command); });
  write_list(json, "play", snapshot.play, [&](const PlayDecision& decision) { write_decision(json, decision); });
  write_number(json, "brightness", snapshot.light.brightness, 1e-3);
  write_list(json, "stages_ms", snapshot.stage_time,
             [&](Duration time) { json.number(report::rounded(seconds(time) * 1e3, kMillisecondStep)); });
  json.end_object();
}

std::array<PixelPoint, 4> outline_px(const Scene& scene, const RobotSighting& robot) {
  const MarkerLayout& layout = scene.configuration->pipeline.marker.teams[index_of(robot.team)].layout;
  const float half = layout.robot_side_m / 2;
  constexpr std::array<std::array<float, 2>, 4> kCorners{{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
  const float cosine = std::cos(robot.pose.theta_rad), sine = std::sin(robot.pose.theta_rad);
  std::array<PixelPoint, 4> corners{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const float forward = half * kCorners[i][0], left = half * kCorners[i][1];
    const FieldPoint point{robot.pose.position.x_m + cosine * forward - sine * left,
                           robot.pose.position.y_m + sine * forward + cosine * left};
    corners[i] = scene.model.to_pixel(point, layout.height_m);
  }
  return corners;
}

double captured_unix_s(const Snapshot& snapshot, const hal::UnixTimeOffset& unix_time) {
  // For simulated time, convert the capture to the machine's clock: on both clocks, the capture is equally long before
  // the packet.
  return seconds(unix_time.to_unix(snapshot.machine_sent - (snapshot.sent - snapshot.captured)));
}

}  // namespace touchline::console
