#include "firmware/network/ssl_vision.h"

#include <firmware/network/proto/ssl_vision.pb.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "hal/poses/protobuf.h"

namespace touchline::network {
namespace {

static_assert(SSL_WrapperPacket_size <= kMaxDatagramBytes);
static_assert(std::size(SSL_DetectionFrame{}.robots_blue) == kMaxRobots);

constexpr float kMmPerM = 1000.0f;

std::int32_t millimeters(float length_m) { return static_cast<std::int32_t>(std::lround(length_m * kMmPerM)); }

/// Returns the pixel of a robot's team patch, as SSL-Vision does.
PixelPoint pixel_of(const RobotSighting& robot) {
  for (const PatchSighting& patch : robot.patches) {
    if (patch.role == PatchRole::kTeam) return patch.center;
  }
  return robot.patches.empty() ? PixelPoint{} : robot.patches[0].center;
}

SSL_DetectionRobot detection_of(const RobotSighting& robot, float height_m) {
  const PixelPoint pixel = pixel_of(robot);
  SSL_DetectionRobot out = SSL_DetectionRobot_init_zero;
  out.confidence = robot.confidence;
  out.has_robot_id = robot.id != kUnknownId;
  if (out.has_robot_id) out.robot_id = static_cast<std::uint32_t>(int{robot.id});
  out.x = robot.pose.position.x_m * kMmPerM;
  out.y = robot.pose.position.y_m * kMmPerM;
  out.has_orientation = robot.has_heading;
  if (out.has_orientation) out.orientation = robot.pose.theta_rad;
  out.pixel_x = pixel.u_px;
  out.pixel_y = pixel.v_px;
  out.has_height = true;
  out.height = height_m * kMmPerM;
  return out;
}

void add_line(SSL_GeometryFieldSize& field, const char* name, SSL_FieldShapeType type, Vector2f from, Vector2f to,
              float thickness) {
  SSL_FieldLineSegment& line = field.field_lines[field.field_lines_count++];
  std::strncpy(line.name, name, sizeof line.name - 1);
  line.p1 = from;
  line.p2 = to;
  line.thickness = thickness;
  line.has_type = true;
  line.type = type;
}

/// Names and directions are those of SSL-Vision's updateFieldLinesAndArcs() in src/shared/util/field.cpp (commit
/// 01e09d8).
void add_lines(SSL_GeometryFieldSize& field, const FieldParameters& parameters) {
  const float x = 0.5f * parameters.length_m * kMmPerM, y = 0.5f * parameters.width_m * kMmPerM;
  const float thickness = parameters.line_width_m * kMmPerM;
  const auto add = [&](const char* name, SSL_FieldShapeType type, Vector2f from, Vector2f to) {
    add_line(field, name, type, from, to, thickness);
  };
  add("TopTouchLine", SSL_FieldShapeType_TopTouchLine, {-x, y}, {x, y});
  add("BottomTouchLine", SSL_FieldShapeType_BottomTouchLine, {-x, -y}, {x, -y});
  add("LeftGoalLine", SSL_FieldShapeType_LeftGoalLine, {-x, -y}, {-x, y});
  add("RightGoalLine", SSL_FieldShapeType_RightGoalLine, {x, -y}, {x, y});
  add("HalfwayLine", SSL_FieldShapeType_HalfwayLine, {0, -y}, {0, y});
  add("CenterLine", SSL_FieldShapeType_CenterLine, {-x, 0}, {x, 0});
}

/// Adds both areas, if the field has them; the side along the goal line is the goal line itself.
void add_penalty_areas(SSL_GeometryFieldSize& field, const FieldParameters& parameters) {
  if (parameters.penalty_area_depth_m <= 0.0f || parameters.penalty_area_width_m <= 0.0f) return;
  field.has_penalty_area_depth = field.has_penalty_area_width = true;
  field.penalty_area_depth = millimeters(parameters.penalty_area_depth_m);
  field.penalty_area_width = millimeters(parameters.penalty_area_width_m);
  const float goal = 0.5f * parameters.length_m * kMmPerM;
  const float front = goal - parameters.penalty_area_depth_m * kMmPerM;
  const float y = 0.5f * parameters.penalty_area_width_m * kMmPerM;
  const float thickness = parameters.line_width_m * kMmPerM;
  const auto add = [&](const char* name, SSL_FieldShapeType type, Vector2f from, Vector2f to) {
    add_line(field, name, type, from, to, thickness);
  };
  add("LeftPenaltyStretch", SSL_FieldShapeType_LeftPenaltyStretch, {-front, -y}, {-front, y});
  add("RightPenaltyStretch", SSL_FieldShapeType_RightPenaltyStretch, {front, -y}, {front, y});
  // Left and right are as the goalkeeper sees them.
  add("LeftFieldLeftPenaltyStretch", SSL_FieldShapeType_LeftFieldLeftPenaltyStretch, {-goal, y}, {-front, y});
  add("LeftFieldRightPenaltyStretch", SSL_FieldShapeType_LeftFieldRightPenaltyStretch, {-goal, -y}, {-front, -y});
  add("RightFieldLeftPenaltyStretch", SSL_FieldShapeType_RightFieldLeftPenaltyStretch, {goal, -y}, {front, -y});
  add("RightFieldRightPenaltyStretch", SSL_FieldShapeType_RightFieldRightPenaltyStretch, {goal, y}, {front, y});
}

void add_center_circle(SSL_GeometryFieldSize& field, const FieldParameters& parameters) {
  if (parameters.center_circle_m <= 0.0f) return;
  SSL_FieldCircularArc& arc = field.field_arcs[field.field_arcs_count++];
  std::strncpy(arc.name, "CenterCircle", sizeof arc.name - 1);
  arc.center = {0, 0};
  arc.radius = parameters.center_circle_m * kMmPerM;
  arc.a1 = 0.0f;
  arc.a2 = 2.0f * std::numbers::pi_v<float>;
  arc.thickness = parameters.line_width_m * kMmPerM;
  arc.has_type = true;
  arc.type = SSL_FieldShapeType_CenterCircle;
  field.has_center_circle_radius = true;
  field.center_circle_radius = millimeters(parameters.center_circle_m);
}

SSL_GeometryCameraCalibration calibration_message(const SslCalibration& c, const VenueGeometry& geometry,
                                                  std::uint32_t camera_id) {
  const auto to_float = [](double value) { return static_cast<float>(value); };
  SSL_GeometryCameraCalibration out = SSL_GeometryCameraCalibration_init_zero;
  out.camera_id = camera_id;
  out.focal_length = to_float(c.focal_length_px);
  out.principal_point_x = to_float(c.principal_point_px[0]);
  out.principal_point_y = to_float(c.principal_point_px[1]);
  out.distortion = to_float(c.distortion);
  out.q0 = to_float(c.q[0]);
  out.q1 = to_float(c.q[1]);
  out.q2 = to_float(c.q[2]);
  out.q3 = to_float(c.q[3]);
  out.tx = to_float(c.t_mm[0]);
  out.ty = to_float(c.t_mm[1]);
  out.tz = to_float(c.t_mm[2]);
  out.has_derived_camera_world_tx = out.has_derived_camera_world_ty = out.has_derived_camera_world_tz = true;
  out.derived_camera_world_tx = to_float(c.position_mm[0]);
  out.derived_camera_world_ty = to_float(c.position_mm[1]);
  out.derived_camera_world_tz = to_float(c.position_mm[2]);
  out.has_pixel_image_width = out.has_pixel_image_height = true;
  out.pixel_image_width = geometry.width_px;
  out.pixel_image_height = geometry.height_px;
  return out;
}

std::size_t encode(SSL_WrapperPacket& packet, std::span<std::byte> out) {
  packet.has_source = true;
  packet.source = SSL_Source_SSL_SOURCE_OTHER;
  return hal::encode_message(SSL_WrapperPacket_fields, &packet, out);
}

}  // namespace

Status SslVisionEncoder::configure(const VenueGeometry& geometry) {
  const float height_m = std::max(geometry.robot_height_m[0], geometry.robot_height_m[1]);
  geometry_ = geometry;
  calibration_.reset();
  // A source of poses has no pictures and no calibration.
  if (geometry.width_px == 0) return {};
  if (const Status status = CameraModel().configure(geometry.camera); !status.ok()) return status;
  SslCalibration calibration;
  const Status fitted = fit_ssl_calibration(geometry.camera, geometry.field, geometry.width_px, geometry.height_px,
                                            height_m, calibration);
  calibration_ = fitted.ok() ? std::optional(calibration) : std::nullopt;
  return {};
}

std::size_t SslVisionEncoder::encode_detection(const OutputFrame& frame, std::span<std::byte> out) const {
  const Snapshot& snapshot = frame.snapshot;
  SSL_WrapperPacket packet = SSL_WrapperPacket_init_zero;
  packet.has_detection = true;
  SSL_DetectionFrame& detection = packet.detection;
  detection.frame_number = static_cast<std::uint32_t>(snapshot.number);
  detection.t_capture = frame.captured_unix_s;
  detection.t_sent = frame.sent_unix_s;
  detection.camera_id = frame.camera_id;
  detection.has_t_capture_camera = true;
  detection.t_capture_camera = seconds(snapshot.captured.time_since_epoch());
  if (snapshot.ball.seen) {
    SSL_DetectionBall& ball = detection.balls[detection.balls_count++];
    ball.confidence = snapshot.ball.confidence;
    ball.has_area = true;
    ball.area = snapshot.ball.area_px;
    ball.x = snapshot.ball.position.x_m * kMmPerM;
    ball.y = snapshot.ball.position.y_m * kMmPerM;
    ball.pixel_x = snapshot.ball.center.u_px;
    ball.pixel_y = snapshot.ball.center.v_px;
  }
  for (const RobotSighting& robot : snapshot.robots) {
    const float height_m = frame.robot_height_m[static_cast<std::size_t>(robot.team)];
    const SSL_DetectionRobot message = detection_of(robot, height_m);
    if (frame.color_of(robot.team) == TeamColor::kYellow) {
      detection.robots_yellow[detection.robots_yellow_count++] = message;
    } else {
      detection.robots_blue[detection.robots_blue_count++] = message;
    }
  }
  return encode(packet, out);
}

std::size_t SslVisionEncoder::encode_geometry(std::uint32_t camera_id, std::span<std::byte> out) const {
  const FieldParameters& parameters = geometry_.field;
  SSL_WrapperPacket packet = SSL_WrapperPacket_init_zero;
  packet.has_geometry = true;
  SSL_GeometryFieldSize& field = packet.geometry.field;
  field.field_length = millimeters(parameters.length_m);
  field.field_width = millimeters(parameters.width_m);
  field.goal_width = millimeters(parameters.goal_width_m);
  field.goal_depth = millimeters(parameters.goal_depth_m);
  field.boundary_width = millimeters(parameters.margin_m);
  field.has_line_thickness = true;
  field.line_thickness = millimeters(parameters.line_width_m);
  field.has_ball_radius = true;
  field.ball_radius = geometry_.ball_radius_m * kMmPerM;
  add_lines(field, parameters);
  add_penalty_areas(field, parameters);
  add_center_circle(field, parameters);
  if (calibration_) {
    packet.geometry.calib[packet.geometry.calib_count++] = calibration_message(*calibration_, geometry_, camera_id);
  }
  return encode(packet, out);
}

}  // namespace touchline::network
