#include "tools/programs/log/csv.h"

#include <cmath>

#include "tools/programs/command_line/formatted.h"

namespace touchline::log {
namespace {

constexpr std::string_view kHeader =
    "time_s,session,frame,kind,object,team,id,x_m,y_m,theta_rad,v_mps,w_radps,confidence,state\n";

std::string_view word_of(TrackState state) {
  switch (state) {
    case TrackState::kNew:
      return "new";
    case TrackState::kSeen:
      return "seen";
    case TrackState::kCoasting:
      return "coasting";
    case TrackState::kLost:
      break;
  }
  return "lost";
}

std::optional<int> known(RobotId id) { return id == kUnknownId ? std::nullopt : std::optional(int{id}); }

std::string cell(const std::optional<double>& value) { return value ? formatted("%.6g", *value) : std::string(); }

/// Quotes a text that would be several cells.
std::string quoted(std::string_view text) {
  if (text.find_first_of(",\"\n") == std::string_view::npos) return std::string(text);
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + '"';
}

}  // namespace

Result<void> CsvWriter::open(const std::string& path) {
  TOUCHLINE_TRY(file_.open(path));
  return file_.write(kHeader);
}

Result<void> CsvWriter::write(const Row& row) {
  line_ = formatted("%.6f,%s,%llu,%.*s,%.*s,%s,%s", row.time_s, row.session ? std::to_string(*row.session).c_str() : "",
                    static_cast<unsigned long long>(row.frame), static_cast<int>(row.kind.size()), row.kind.data(),
                    static_cast<int>(row.object.size()), row.object.data(), quoted(row.team).c_str(),
                    row.id ? std::to_string(*row.id).c_str() : "");
  for (const auto* value : {&row.x_m, &row.y_m, &row.theta_rad, &row.v_mps, &row.w_radps, &row.confidence}) {
    line_ += ',';
    line_ += cell(*value);
  }
  line_ += ',';
  line_ += row.state;
  line_ += '\n';
  ++rows_;
  return file_.write(line_);
}

Result<void> CsvWriter::add_tracks(const Tracks& tracks, const RecordedFrame& frame, Row row) {
  row.kind = "track";
  row.object = "robot";
  for (const RobotTrack& robot : tracks.robots) {
    row.team = frame.color_of(robot.team);
    row.id = known(robot.id);
    row.x_m = static_cast<double>(robot.pose.position.x_m);
    row.y_m = static_cast<double>(robot.pose.position.y_m);
    row.theta_rad = static_cast<double>(robot.pose.theta_rad);
    row.v_mps = static_cast<double>(robot.twist.v_mps);
    row.w_radps = static_cast<double>(robot.twist.w_radps);
    row.confidence = static_cast<double>(robot.confidence);
    row.state = word_of(robot.state);
    TOUCHLINE_TRY(write(row));
  }
  const BallTrack& ball = tracks.ball;
  if (ball.state == TrackState::kLost) return {};
  Row out{row.time_s, row.session, row.frame, "track", "ball"};
  out.x_m = static_cast<double>(ball.position.x_m);
  out.y_m = static_cast<double>(ball.position.y_m);
  out.theta_rad = std::atan2(static_cast<double>(ball.velocity.y_m), static_cast<double>(ball.velocity.x_m));
  out.v_mps = std::hypot(static_cast<double>(ball.velocity.x_m), static_cast<double>(ball.velocity.y_m));
  out.confidence = static_cast<double>(ball.confidence);
  out.state = word_of(ball.state);
  return write(out);
}

Result<void> CsvWriter::add(const RecordedFrame& frame) {
  const Snapshot& snapshot = frame.output.snapshot;
  const Row base{frame.output.captured_unix_s, frame.session, snapshot.number, "sighting"};
  for (const RobotSighting& robot : snapshot.robots) {
    Row row = base;
    row.object = "robot";
    row.team = frame.color_of(robot.team);
    row.id = known(robot.id);
    row.x_m = static_cast<double>(robot.pose.position.x_m);
    row.y_m = static_cast<double>(robot.pose.position.y_m);
    if (robot.has_heading) row.theta_rad = static_cast<double>(robot.pose.theta_rad);
    row.confidence = static_cast<double>(robot.confidence);
    TOUCHLINE_TRY(write(row));
  }
  if (snapshot.ball.seen) {
    Row row = base;
    row.object = "ball";
    row.x_m = static_cast<double>(snapshot.ball.position.x_m);
    row.y_m = static_cast<double>(snapshot.ball.position.y_m);
    row.confidence = static_cast<double>(snapshot.ball.confidence);
    TOUCHLINE_TRY(write(row));
  }
  TOUCHLINE_TRY(add_tracks(snapshot.tracks, frame, base));
  for (const RobotCommand& command : frame.commands.robots) {
    Row row = base;
    row.kind = "command";
    row.object = "robot";
    row.team = frame.color_of(Team::kOwn);
    row.id = known(command.id);
    // The robots got a stop instead of the velocities.
    row.v_mps = frame.commands.stop ? 0.0 : static_cast<double>(command.twist.v_mps);
    row.w_radps = frame.commands.stop ? 0.0 : static_cast<double>(command.twist.w_radps);
    TOUCHLINE_TRY(write(row));
  }
  return {};
}

Result<bool> CsvWriter::add(const hal::SslLogMessage& message) {
  const bool is_tracker = message.type == hal::kSslTracker;
  if (!is_tracker && message.type != hal::kSslVision && message.type != hal::kSslVision2010) return true;
  const auto protocol = is_tracker ? hal::PoseProtocol::kSslTracked : hal::PoseProtocol::kSslVision;
  const Result<bool> decoded = hal::decode_poses(protocol, message.data, poses_);
  if (!decoded.ok()) return false;
  if (!decoded.value()) return true;
  const Row base{static_cast<double>(message.time_ns) * 1e-9, std::nullopt, poses_.number,
                 is_tracker ? "track" : "sighting"};
  for (const hal::SentRobot& robot : poses_.robots) {
    Row row = base;
    row.object = "robot";
    row.team = robot.is_yellow ? "yellow" : "blue";
    row.id = known(robot.id);
    row.x_m = static_cast<double>(robot.pose.position.x_m);
    row.y_m = static_cast<double>(robot.pose.position.y_m);
    if (robot.has_heading) row.theta_rad = static_cast<double>(robot.pose.theta_rad);
    row.confidence = static_cast<double>(robot.confidence);
    TOUCHLINE_TRY(write(row));
  }
  for (const hal::SentBall& ball : poses_.balls) {
    Row row = base;
    row.object = "ball";
    row.x_m = static_cast<double>(ball.position.x_m);
    row.y_m = static_cast<double>(ball.position.y_m);
    row.confidence = static_cast<double>(ball.confidence);
    TOUCHLINE_TRY(write(row));
  }
  return true;
}

}  // namespace touchline::log
