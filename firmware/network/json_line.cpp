#include "firmware/network/json_line.h"

#include <array>
#include <charconv>
#include <optional>

namespace touchline::network {
namespace {

using report::JsonWriter;
using report::write_number;

constexpr double kVoltStep = 1e-3;

const char* word_of(GamePhase phase) {
  switch (phase) {
    case GamePhase::kNoReferee:
      return "no referee";
    case GamePhase::kHalt:
      return "halt";
    case GamePhase::kStop:
      return "stop";
    case GamePhase::kPrepare:
      return "prepare";
    case GamePhase::kRunning:
      return "running";
  }
  return "";
}

// nullptr: the referee does not say.
const char* word_of(Restart restart) {
  switch (restart) {
    case Restart::kNone:
      return nullptr;
    case Restart::kKickOff:
      return "kick-off";
    case Restart::kFreeBall:
      return "free ball";
    case Restart::kPenalty:
      return "penalty";
    case Restart::kGoalKick:
      return "goal kick";
    case Restart::kFreeKick:
      return "free kick";
  }
  return nullptr;
}

// Returns who takes the restart. nullptr: nobody does, or the referee does not say.
const char* taker_of(const RefereeState& referee) {
  if (referee.restart == Restart::kNone || referee.restart == Restart::kFreeBall) return nullptr;
  return referee.restart_is_ours ? "own" : "opponent";
}

void write_text(JsonWriter& json, std::string_view key, const char* text) {
  json.key(key);
  if (text == nullptr) return json.null();
  json.string(text);
}

// Writes null for 0, by which a referee says nothing.
void write_count(JsonWriter& json, std::string_view key, std::uint8_t count) {
  json.key(key);
  if (count == 0) return json.null();
  json.integer(count);
}

void write_id_key(JsonWriter& json, RobotId id) {
  std::array<char, 4> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), int{id});
  json.key({text.data(), static_cast<std::size_t>(end - text.data())});
}

/// Writes {"blue":{"3":{"x":...}},"yellow":{}}. The robots are members of an object, because a plotter shows each
/// member as a series, and the series then stay the same if another robot is lost.
void write_robots(JsonWriter& json, const Snapshot& snapshot, const report::TraceNames& names) {
  json.begin_object();
  for (const Team team : {Team::kOwn, Team::kOpponent}) {
    const std::string& name = names.teams[static_cast<std::size_t>(team)];
    if (name.empty()) continue;  // this team is not detected
    json.key(name);
    json.begin_object();
    for (const RobotTrack& robot : snapshot.tracks.robots) {
      if (robot.team != team || robot.id == kUnknownId) continue;
      write_id_key(json, robot.id);
      json.begin_object();
      write_number(json, "x", robot.pose.position.x_m, report::kMeterStep);
      write_number(json, "y", robot.pose.position.y_m, report::kMeterStep);
      write_number(json, "theta", robot.pose.theta_rad, report::kRadianStep);
      write_number(json, "v", robot.twist.v_mps, report::kSpeedStep);
      write_number(json, "w", robot.twist.w_radps, report::kSpeedStep);
      write_number(json, "confidence", robot.confidence, report::kConfidenceStep);
      json.key("seen");
      json.boolean(robot.state != TrackState::kCoasting);
      json.end_object();
    }
    json.end_object();
  }
  json.end_object();
}

void write_commands(JsonWriter& json, const Commands& commands) {
  json.begin_object();
  for (const RobotCommand& command : commands.robots) {
    write_id_key(json, command.id);
    json.begin_object();
    write_number(json, "v", command.twist.v_mps, report::kSpeedStep);
    write_number(json, "w", command.twist.w_radps, report::kSpeedStep);
    write_number(json, "left", command.wheels.left_mps, report::kSpeedStep);
    write_number(json, "right", command.wheels.right_mps, report::kSpeedStep);
    json.end_object();
  }
  json.end_object();
}

void write_telemetry(JsonWriter& json, const Snapshot& snapshot) {
  json.begin_object();
  for (const RobotReport& report : snapshot.reports.robots) {
    write_id_key(json, report.last.id);
    json.begin_object();
    json.key("battery");
    if (report.last.battery_v > 0.0f) {
      json.number(report::rounded(static_cast<double>(report.last.battery_v), kVoltStep));
    } else {
      json.null();
    }
    json.key("link");
    if (report.last.link_percent == kLinkUnknown) {
      json.null();
    } else {
      json.integer(report.last.link_percent);
    }
    if (report.last.wheels) {
      write_number(json, "left", report.last.wheels->left_mps, report::kSpeedStep);
      write_number(json, "right", report.last.wheels->right_mps, report::kSpeedStep);
    }
    write_number(json, "age", seconds(snapshot.sent - report.heard), report::kSecondStep);
    json.end_object();
  }
  json.end_object();
}

void write_score(JsonWriter& json, const std::optional<Score>& score) {
  if (!score) return json.null();
  json.begin_object();
  json.key("own");
  json.integer(score->own);
  json.key("opponent");
  json.integer(score->opponent);
  json.end_object();
}

void write_side(JsonWriter& json, const RefereeState& referee, const report::TraceNames& names) {
  json.begin_object();
  json.key("team");
  json.string(names.teams[static_cast<std::size_t>(Team::kOwn)]);
  json.key("half");
  json.string(referee.own_on_positive_half.value_or(false) ? "positive" : "negative");
  json.end_object();
}

void write_referee(JsonWriter& json, const Snapshot& snapshot) {
  const RefereeState& referee = snapshot.referee;
  if (referee.phase == GamePhase::kNoReferee) return json.null();
  json.begin_object();
  json.key("phase");
  json.string(word_of(referee.phase));
  write_number(json, "age", seconds(snapshot.sent - referee.received), report::kSecondStep);
  write_text(json, "restart", word_of(referee.restart));
  write_text(json, "taken_by", taker_of(referee));
  write_count(json, "quadrant", referee.quadrant);
  write_count(json, "half", referee.half);
  json.end_object();
}

}  // namespace

void write_field(JsonWriter& json, const FieldParameters& field) {
  json.key("field");
  json.begin_object();
  write_number(json, "length", field.length_m, report::kMeterStep);
  write_number(json, "width", field.width_m, report::kMeterStep);
  write_number(json, "goal_width", field.goal_width_m, report::kMeterStep);
  write_number(json, "goal_depth", field.goal_depth_m, report::kMeterStep);
  json.end_object();
}

void write_game_members(JsonWriter& json, const Snapshot& snapshot, const report::TraceNames& names,
                        const FieldParameters& field) {
  json.key("robots");
  write_robots(json, snapshot, names);
  json.key("stop");
  json.boolean(snapshot.commands.stop);
  json.key("halt");
  json.integer(snapshot.halt);
  json.key("phase");
  json.string(word_of(snapshot.referee.phase));
  json.key("commands");
  write_commands(json, snapshot.commands);
  json.key("telemetry");
  write_telemetry(json, snapshot);
  json.key("score");
  write_score(json, snapshot.referee.score);
  json.key("side");
  write_side(json, snapshot.referee, names);
  write_field(json, field);
  json.key("referee");
  write_referee(json, snapshot);
}

std::size_t write_json_line(const OutputFrame& frame, const report::TraceNames& names, const FieldParameters& field,
                            std::string_view device, std::span<std::byte> out) {
  const Snapshot& snapshot = frame.snapshot;
  JsonWriter json({reinterpret_cast<char*>(out.data()), out.size()});
  json.begin_object();
  json.key("schema");
  json.integer(kJsonSchema);
  write_number(json, "timestamp", frame.captured_unix_s, report::kSecondStep);
  write_number(json, "sent", frame.sent_unix_s, report::kSecondStep);
  report::write_frame(json, {snapshot.captured, snapshot.ball, snapshot.robots, snapshot.tracks, snapshot.overload},
                      names, snapshot.number, device);
  write_game_members(json, snapshot, names, field);
  json.end_object();
  json.line_end();
  return json.fits() ? json.size() : 0;
}

}  // namespace touchline::network
