#include "firmware/console/foxglove_messages.h"

#include <cmath>

#include "firmware/console/foxglove_client.h"
#include "firmware/console/foxglove_schemas.h"
#include "firmware/console/protocol.h"
#include "firmware/report/base64.h"
#include "firmware/report/trace_json.h"

namespace touchline::console {
namespace {

using report::JsonWriter;
using report::kMeterStep;
using report::kPixelStep;
using report::write_number;
using Rgb = std::array<std::uint8_t, 3>;

// Numbers of Foxglove's schemas.
constexpr int kLineLoop = 2;   // foxglove.PointsAnnotation: closed
constexpr int kLineStrip = 0;  // foxglove.LinePrimitive: open
constexpr Rgb kFieldLines{230, 230, 230}, kText{255, 255, 255}, kShade{0, 0, 0};
constexpr double kColorStep = 1e-3;
constexpr int kCircleCorners = 32;

void write_word(JsonWriter& json, std::string_view key, std::string_view text) {
  json.key(key);
  json.string(text);
}

void write_whole(JsonWriter& json, std::string_view key, std::int64_t value) {
  json.key(key);
  json.integer(value);
}

void write_time(JsonWriter& json, std::string_view key, double time_s) {
  const double whole = std::floor(time_s);
  json.key(key);
  json.begin_object();
  write_whole(json, "sec", static_cast<std::int64_t>(whole));
  write_whole(json, "nsec", static_cast<std::int64_t>((time_s - whole) * 1e9));
  json.end_object();
}

void write_color(JsonWriter& json, std::string_view key, const Rgb& rgb, double opacity) {
  json.key(key);
  json.begin_object();
  write_number(json, "r", rgb[0] / 255.0, kColorStep);
  write_number(json, "g", rgb[1] / 255.0, kColorStep);
  write_number(json, "b", rgb[2] / 255.0, kColorStep);
  write_number(json, "a", opacity, kColorStep);
  json.end_object();
}

void write_vector(JsonWriter& json, double x, double y, double z) {
  json.begin_object();
  write_number(json, "x", x, kMeterStep);
  write_number(json, "y", y, kMeterStep);
  write_number(json, "z", z, kMeterStep);
  json.end_object();
}

void write_pose(JsonWriter& json, FieldPoint place, double z_m, double heading_rad) {
  json.key("pose");
  json.begin_object();
  json.key("position");
  write_vector(json, static_cast<double>(place.x_m), static_cast<double>(place.y_m), z_m);
  json.key("orientation");
  json.begin_object();
  write_number(json, "x", 0.0, kMeterStep);
  write_number(json, "y", 0.0, kMeterStep);
  write_number(json, "z", std::sin(heading_rad / 2), kMeterStep);
  write_number(json, "w", std::cos(heading_rad / 2), kMeterStep);
  json.end_object();
  json.end_object();
}

// Foxglove's origin is the corner of the first pixel, ours its center.
void write_pixel_point(JsonWriter& json, PixelPoint pixel, int divisor) {
  json.begin_object();
  write_number(json, "x", (static_cast<double>(pixel.u_px) + 0.5) / divisor, kPixelStep);
  write_number(json, "y", (static_cast<double>(pixel.v_px) + 0.5) / divisor, kPixelStep);
  json.end_object();
}

std::string name_of_robot(Team team, RobotId id) {
  return std::string(word_of(team)) + " " + (id == kUnknownId ? std::string("?") : std::to_string(id));
}

Rgb color_of_team(const Scene& scene, Team team) {
  return rgb_of(scene, scene.configuration->pipeline.marker.teams[index_of(team)].team_color);
}

void write_ball_circle(JsonWriter& json, const FoxgloveFrame& frame, int divisor) {
  const BallParameters& parameters = frame.scene.configuration->pipeline.marker.ball;
  const BallSighting& ball = frame.snapshot.ball;
  // The circle is as wide as the ball appears at its position.
  const PixelPoint beside =
      frame.scene.model.to_pixel({ball.position.x_m + parameters.radius_m, ball.position.y_m}, parameters.radius_m);
  const PixelPoint center = frame.scene.model.to_pixel(ball.position, parameters.radius_m);
  const double radius_px =
      std::hypot(static_cast<double>(beside.u_px - center.u_px), static_cast<double>(beside.v_px - center.v_px));
  json.begin_object();
  write_time(json, "timestamp", frame.captured_s);
  json.key("position");
  write_pixel_point(json, ball.center, divisor);
  write_number(json, "diameter", 2 * radius_px / divisor, kPixelStep);
  write_number(json, "thickness", 2.0, kPixelStep);
  write_color(json, "fill_color", kShade, 0.0);
  write_color(json, "outline_color", rgb_of(frame.scene, parameters.color), 1.0);
  json.end_object();
}

void write_robot_outline(JsonWriter& json, const FoxgloveFrame& frame, const RobotSighting& robot, int divisor) {
  json.begin_object();
  write_time(json, "timestamp", frame.captured_s);
  write_whole(json, "type", kLineLoop);
  json.key("points");
  json.begin_array();
  for (const PixelPoint corner : outline_px(frame.scene, robot)) write_pixel_point(json, corner, divisor);
  json.end_array();
  write_color(json, "outline_color", color_of_team(frame.scene, robot.team), 1.0);
  write_color(json, "fill_color", kShade, 0.0);
  write_number(json, "thickness", 2.0, kPixelStep);
  json.end_object();
}

void write_robot_label(JsonWriter& json, const FoxgloveFrame& frame, const RobotSighting& robot, int divisor) {
  const MarkerLayout& layout = frame.scene.configuration->pipeline.marker.teams[index_of(robot.team)].layout;
  json.begin_object();
  write_time(json, "timestamp", frame.captured_s);
  json.key("position");
  write_pixel_point(json, frame.scene.model.to_pixel(robot.pose.position, layout.height_m), divisor);
  write_word(json, "text", name_of_robot(robot.team, robot.id));
  write_number(json, "font_size", 14.0, kPixelStep);
  write_color(json, "text_color", kText, 1.0);
  write_color(json, "background_color", kShade, 0.5);
  json.end_object();
}

void begin_entity(JsonWriter& json, std::string_view id, double captured_s) {
  json.begin_object();
  write_time(json, "timestamp", captured_s);
  write_word(json, "frame_id", "field");
  write_word(json, "id", id);
  write_time(json, "lifetime", 0.0);  // 0: until it is replaced
  json.key("frame_locked");
  json.boolean(false);
}

void write_line(JsonWriter& json, const std::vector<FieldPoint>& points) {
  json.begin_object();
  write_whole(json, "type", kLineStrip);
  write_pose(json, {}, 0.0, 0.0);
  write_number(json, "thickness", 2.0, kPixelStep);
  json.key("scale_invariant");
  json.boolean(true);
  json.key("points");
  json.begin_array();
  for (const FieldPoint point : points) {
    write_vector(json, static_cast<double>(point.x_m), static_cast<double>(point.y_m), 0.0);
  }
  json.end_array();
  write_color(json, "color", kFieldLines, 1.0);
  json.end_object();
}

void write_field_entity(JsonWriter& json, const FoxgloveFrame& frame) {
  const FieldParameters& field = frame.scene.configuration->pipeline.marker.field;
  const float x = field.length_m / 2, y = field.width_m / 2, goal_y = field.goal_width_m / 2;
  begin_entity(json, "lines", frame.captured_s);
  json.key("lines");
  json.begin_array();
  write_line(json, {{-x, -y}, {x, -y}, {x, y}, {-x, y}, {-x, -y}});
  write_line(json, {{0.0f, -y}, {0.0f, y}});
  for (const float side : {-1.0f, 1.0f}) {
    const float back = side * (x + field.goal_depth_m), area = side * (x - field.penalty_area_depth_m);
    const float area_y = field.penalty_area_width_m / 2;
    write_line(json, {{side * x, -goal_y}, {back, -goal_y}, {back, goal_y}, {side * x, goal_y}});
    if (field.penalty_area_depth_m > 0.0f)
      write_line(json, {{side * x, -area_y}, {area, -area_y}, {area, area_y}, {side * x, area_y}});
  }
  if (field.center_circle_m > 0.0f) {
    std::vector<FieldPoint> circle;
    for (int i = 0; i <= kCircleCorners; ++i) {
      const float angle = 6.2831853f * static_cast<float>(i) / kCircleCorners;
      circle.push_back({field.center_circle_m * std::cos(angle), field.center_circle_m * std::sin(angle)});
    }
    write_line(json, circle);
  }
  json.end_array();
  json.end_object();
}

void write_game_entity(JsonWriter& json, const FoxgloveFrame& frame) {
  const MarkerParameters& marker = frame.scene.configuration->pipeline.marker;
  const Tracks& tracks = frame.snapshot.tracks;
  begin_entity(json, "game", frame.captured_s);
  json.key("cubes");
  json.begin_array();
  for (const RobotTrack& robot : tracks.robots) {
    const MarkerLayout& layout = marker.teams[index_of(robot.team)].layout;
    const auto side = static_cast<double>(layout.robot_side_m), height = static_cast<double>(layout.height_m);
    json.begin_object();
    write_pose(json, robot.pose.position, height / 2, static_cast<double>(robot.pose.theta_rad));
    json.key("size");
    write_vector(json, side, side, height);
    write_color(json, "color", color_of_team(frame.scene, robot.team),
                robot.state == TrackState::kCoasting ? 0.4 : 1.0);
    json.end_object();
  }
  json.end_array();
  json.key("spheres");
  json.begin_array();
  if (tracks.ball.state != TrackState::kLost) {
    const auto radius = static_cast<double>(marker.ball.radius_m);
    json.begin_object();
    write_pose(json, tracks.ball.position, radius, 0.0);
    json.key("size");
    write_vector(json, 2 * radius, 2 * radius, 2 * radius);
    write_color(json, "color", rgb_of(frame.scene, marker.ball.color),
                tracks.ball.state == TrackState::kCoasting ? 0.4 : 1.0);
    json.end_object();
  }
  json.end_array();
  json.key("texts");
  json.begin_array();
  for (const RobotTrack& robot : tracks.robots) {
    const auto height = static_cast<double>(marker.teams[index_of(robot.team)].layout.height_m);
    json.begin_object();
    write_pose(json, robot.pose.position, 2 * height, 0.0);
    json.key("billboard");
    json.boolean(true);
    write_number(json, "font_size", 14.0, kPixelStep);
    json.key("scale_invariant");
    json.boolean(true);
    write_color(json, "color", kText, 1.0);
    write_word(json, "text", name_of_robot(robot.team, robot.id));
    json.end_object();
  }
  json.end_array();
  json.end_object();
}

}  // namespace

void write_foxglove_server_info(JsonWriter& json, const Scene& scene, std::string_view session) {
  json.begin_object();
  write_word(json, "op", "serverInfo");
  write_word(json, "name", "touchline " + scene.version + ", board " + scene.configuration->board.name);
  json.key("capabilities");
  json.begin_array();
  json.end_array();
  write_word(json, "sessionId", session);
  json.end_object();
}

void write_foxglove_channels(JsonWriter& json) {
  json.begin_object();
  write_word(json, "op", "advertise");
  json.key("channels");
  json.begin_array();
  for (std::size_t i = 0; i < kFoxgloveChannels; ++i) {
    const FoxgloveSchema schema = foxglove_schema(static_cast<FoxgloveChannel>(i));
    json.begin_object();
    write_whole(json, "id", static_cast<std::int64_t>(i + 1));
    write_word(json, "topic", schema.topic);
    write_word(json, "encoding", "json");
    write_word(json, "schemaName", schema.name);
    write_word(json, "schema", schema.text);
    write_word(json, "schemaEncoding", "jsonschema");
    json.end_object();
  }
  json.end_array();
  json.end_object();
}

void write_foxglove_error(JsonWriter& json, std::string_view text) {
  constexpr int kErrorLevel = 2;
  json.begin_object();
  write_word(json, "op", "status");
  write_whole(json, "level", kErrorLevel);
  write_word(json, "message", text);
  json.end_object();
}

void write_foxglove_picture(JsonWriter& json, std::span<const std::byte> jpeg, double captured_s) {
  json.begin_object();
  write_time(json, "timestamp", captured_s);
  write_word(json, "frame_id", "camera");
  write_word(json, "format", "jpeg");
  write_word(json, "data", report::base64_of(jpeg));
  json.end_object();
}

void write_foxglove_annotations(JsonWriter& json, const FoxgloveFrame& frame, int divisor) {
  json.begin_object();
  json.key("circles");
  json.begin_array();
  if (frame.snapshot.ball.seen) write_ball_circle(json, frame, divisor);
  json.end_array();
  json.key("points");
  json.begin_array();
  for (const RobotSighting& robot : frame.snapshot.robots) {
    if (robot.has_heading) write_robot_outline(json, frame, robot, divisor);
  }
  json.end_array();
  json.key("texts");
  json.begin_array();
  for (const RobotSighting& robot : frame.snapshot.robots) write_robot_label(json, frame, robot, divisor);
  json.end_array();
  json.end_object();
}

void write_foxglove_scene(JsonWriter& json, const FoxgloveFrame& frame, bool with_field) {
  json.begin_object();
  json.key("deletions");
  json.begin_array();
  json.end_array();
  json.key("entities");
  json.begin_array();
  if (with_field) write_field_entity(json, frame);
  write_game_entity(json, frame);
  json.end_array();
  json.end_object();
}

}  // namespace touchline::console
