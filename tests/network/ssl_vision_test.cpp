// SSL-Vision's packets, decoded by protobuf's own library with the receivers' definitions.
#include "firmware/network/ssl_vision.h"

#include <gtest/gtest.h>
#include <tests/network/ssl_vision.pb.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "tests/network/example_frame.h"

namespace touchline::network {
namespace {

class SslVision : public ::testing::Test {
 protected:
  SslVision() { EXPECT_TRUE(encoder_.configure(example_geometry()).ok()); }

  SSL_WrapperPacket detection(const OutputFrame& frame) {
    return parsed(datagram([&](auto out) { return encoder_.encode_detection(frame, out); }));
  }
  SSL_WrapperPacket geometry(std::uint32_t camera_id) {
    return parsed(datagram([&](auto out) { return encoder_.encode_geometry(camera_id, out); }));
  }
  // ParseFromString fails if a required field is absent.
  static SSL_WrapperPacket parsed(const std::string& bytes) {
    SSL_WrapperPacket packet;
    EXPECT_GT(bytes.size(), 0u);
    EXPECT_TRUE(packet.ParseFromString(bytes)) << packet.InitializationErrorString();
    EXPECT_EQ(packet.source(), SSL_SOURCE_OTHER);
    return packet;
  }

  SslVisionEncoder encoder_;
};

TEST_F(SslVision, DetectionHasFrameAndTimes) {
  const Snapshot snapshot = example_snapshot();
  const SSL_WrapperPacket packet = detection(example_output(snapshot));
  ASSERT_TRUE(packet.has_detection());
  EXPECT_FALSE(packet.has_geometry());
  EXPECT_EQ(packet.detection().frame_number(), 41u);
  EXPECT_EQ(packet.detection().camera_id(), 2u);
  EXPECT_EQ(packet.detection().t_capture(), 1700000000.123456);
  EXPECT_EQ(packet.detection().t_sent(), 1700000000.136);
  EXPECT_EQ(packet.detection().t_capture_camera(), 12.25);
}

TEST_F(SslVision, DetectionHasTheBallInMillimetersAndPixels) {
  Snapshot snapshot = example_snapshot();
  const SSL_WrapperPacket packet = detection(example_output(snapshot));
  ASSERT_EQ(packet.detection().balls_size(), 1);
  const SSL_DetectionBall& ball = packet.detection().balls(0);
  EXPECT_FLOAT_EQ(ball.x(), -512.3f);
  EXPECT_FLOAT_EQ(ball.y(), 250.0f);
  EXPECT_EQ(ball.pixel_x(), 123.5f);
  EXPECT_EQ(ball.pixel_y(), 321.25f);
  EXPECT_EQ(ball.area(), 90u);
  EXPECT_FALSE(ball.has_z());
  EXPECT_EQ(ball.confidence(), 0.8125f);
  snapshot.ball.seen = false;
  EXPECT_EQ(detection(example_output(snapshot)).detection().balls_size(), 0);
}

TEST_F(SslVision, DetectionHasRobotsByColor) {
  const Snapshot snapshot = example_snapshot();
  const SSL_WrapperPacket packet = detection(example_output(snapshot));
  ASSERT_EQ(packet.detection().robots_blue_size(), 2);
  ASSERT_EQ(packet.detection().robots_yellow_size(), 1);
  const SSL_DetectionRobot& robot = packet.detection().robots_blue(0);
  EXPECT_EQ(robot.robot_id(), 3u);
  EXPECT_FLOAT_EQ(robot.x(), 661.2f);
  EXPECT_FLOAT_EQ(robot.y(), 500.0f);
  EXPECT_EQ(robot.orientation(), -2.0227f);
  // The pixel is that of the team patch, which is not the first patch in the list.
  EXPECT_EQ(robot.pixel_x(), 313.0f);
  EXPECT_EQ(robot.pixel_y(), 200.0f);
  EXPECT_FLOAT_EQ(robot.height(), 75.0f);
  EXPECT_EQ(robot.confidence(), 0.9876f);
  const SSL_DetectionRobot& unknown = packet.detection().robots_blue(1);
  EXPECT_FALSE(unknown.has_robot_id());
  EXPECT_FALSE(unknown.has_orientation());
  EXPECT_EQ(unknown.confidence(), 0.625f);
  const SSL_DetectionRobot& opponent = packet.detection().robots_yellow(0);
  EXPECT_TRUE(opponent.has_robot_id());
  EXPECT_EQ(opponent.robot_id(), 0u);
  EXPECT_FLOAT_EQ(opponent.height(), 80.0f);
}

TEST_F(SslVision, TheOwnTeamCanBeYellow) {
  const Snapshot snapshot = example_snapshot();
  OutputFrame frame = example_output(snapshot);
  frame.own = TeamColor::kYellow;
  const SSL_WrapperPacket packet = detection(frame);
  EXPECT_EQ(packet.detection().robots_yellow_size(), 2);
  EXPECT_EQ(packet.detection().robots_blue_size(), 1);
}

TEST_F(SslVision, GeometryHasTheFieldAndItsLines) {
  const SSL_WrapperPacket packet = geometry(2);
  ASSERT_TRUE(packet.has_geometry());
  EXPECT_FALSE(packet.has_detection());
  const SSL_GeometryFieldSize& field = packet.geometry().field();
  EXPECT_EQ(field.field_length(), 2200);
  EXPECT_EQ(field.field_width(), 1800);
  EXPECT_EQ(field.goal_width(), 400);
  EXPECT_EQ(field.goal_depth(), 150);
  EXPECT_EQ(field.boundary_width(), 100);
  EXPECT_EQ(field.line_thickness(), 10);
  EXPECT_FLOAT_EQ(field.ball_radius(), 21.35f);
  std::set<std::string> names;
  for (const SSL_FieldLineSegment& line : field.field_lines()) {
    names.insert(line.name());
    EXPECT_EQ(SSL_FieldShapeType_Name(line.type()), line.name());
    EXPECT_EQ(line.thickness(), 10.0f);
  }
  EXPECT_EQ(names, (std::set<std::string>{"TopTouchLine", "BottomTouchLine", "LeftGoalLine", "RightGoalLine",
                                          "HalfwayLine", "CenterLine"}));
  EXPECT_EQ(field.field_lines(0).p1().x(), -1100.0f);
  EXPECT_EQ(field.field_lines(0).p1().y(), 900.0f);
  ASSERT_EQ(field.field_arcs_size(), 1);
  EXPECT_EQ(field.field_arcs(0).name(), "CenterCircle");
  EXPECT_EQ(field.field_arcs(0).radius(), 250.0f);
  EXPECT_FLOAT_EQ(field.field_arcs(0).a2(), 2.0f * std::numbers::pi_v<float>);
}

TEST_F(SslVision, GeometryHasTheCalibration) {
  const SSL_WrapperPacket packet = geometry(2);
  ASSERT_EQ(packet.geometry().calib_size(), 1);
  const SSL_GeometryCameraCalibration& calibration = packet.geometry().calib(0);
  EXPECT_EQ(calibration.camera_id(), 2u);
  EXPECT_EQ(calibration.pixel_image_width(), 640u);
  EXPECT_EQ(calibration.pixel_image_height(), 480u);
  EXPECT_NEAR(calibration.derived_camera_world_tx(), 98.5f, 10.0f);
  EXPECT_NEAR(calibration.derived_camera_world_ty(), -122.1f, 10.0f);
  EXPECT_NEAR(calibration.derived_camera_world_tz(), 2296.7f, 30.0f);
  const float norm =
      std::hypot(std::hypot(calibration.q0(), calibration.q1()), std::hypot(calibration.q2(), calibration.q3()));
  EXPECT_NEAR(norm, 1.0f, 1e-5f);
}

TEST_F(SslVision, GeometryHasThePenaltyAreas) {
  VenueGeometry other = example_geometry();
  other.field.penalty_area_depth_m = 0.15f;
  other.field.penalty_area_width_m = 0.7f;
  ASSERT_TRUE(encoder_.configure(other).ok());
  const SSL_WrapperPacket packet = geometry(2);
  const SSL_GeometryFieldSize& field = packet.geometry().field();
  EXPECT_EQ(field.penalty_area_depth(), 150);
  EXPECT_EQ(field.penalty_area_width(), 700);
  ASSERT_EQ(field.field_lines_size(), 12);
  // Ends of the lines, in millimeters.
  const std::map<std::string, std::array<float, 4>> expected{
      {"LeftPenaltyStretch", {-950, -350, -950, 350}},
      {"RightPenaltyStretch", {950, -350, 950, 350}},
      {"LeftFieldLeftPenaltyStretch", {-1100, 350, -950, 350}},
      {"LeftFieldRightPenaltyStretch", {-1100, -350, -950, -350}},
      {"RightFieldLeftPenaltyStretch", {1100, -350, 950, -350}},
      {"RightFieldRightPenaltyStretch", {1100, 350, 950, 350}}};
  std::size_t found = 0;
  for (const SSL_FieldLineSegment& line : field.field_lines()) {
    EXPECT_EQ(SSL_FieldShapeType_Name(line.type()), line.name());
    const auto ends = expected.find(line.name());
    if (ends == expected.end()) continue;
    ++found;
    const std::array<float, 4> actual{line.p1().x(), line.p1().y(), line.p2().x(), line.p2().y()};
    for (std::size_t i = 0; i < actual.size(); ++i) EXPECT_NEAR(actual[i], ends->second[i], 1e-3f) << line.name();
  }
  EXPECT_EQ(found, expected.size());
}

TEST_F(SslVision, WithoutPenaltyAreasNoneAreSent) {
  const SSL_WrapperPacket packet = geometry(2);
  EXPECT_FALSE(packet.geometry().field().has_penalty_area_depth());
  EXPECT_FALSE(packet.geometry().field().has_penalty_area_width());
}

TEST_F(SslVision, WithoutCenterCircleThereIsNoArc) {
  VenueGeometry other = example_geometry();
  other.field.center_circle_m = 0.0f;
  ASSERT_TRUE(encoder_.configure(other).ok());
  EXPECT_EQ(geometry(0).geometry().field().field_arcs_size(), 0);
}

TEST_F(SslVision, TheFullestFrameFitsIntoADatagram) {
  const Snapshot snapshot = fullest_snapshot();
  const SSL_WrapperPacket packet = detection(example_output(snapshot));
  EXPECT_EQ(packet.detection().robots_blue_size() + packet.detection().robots_yellow_size(), 22);
  EXPECT_EQ(packet.detection().frame_number(), static_cast<std::uint32_t>(123456789012));
}

TEST_F(SslVision, TooSmallAMemoryGivesNothing) {
  const Snapshot snapshot = example_snapshot();
  const std::string whole =
      datagram([&](auto out) { return encoder_.encode_detection(example_output(snapshot), out); });
  std::vector<std::byte> memory(whole.size());
  EXPECT_EQ(encoder_.encode_detection(example_output(snapshot), memory), whole.size());
  memory.pop_back();
  EXPECT_EQ(encoder_.encode_detection(example_output(snapshot), memory), 0u);
}

TEST_F(SslVision, ACameraThatSeesTooLittleHasNoCalibration) {
  VenueGeometry other = example_geometry();
  other.width_px = other.height_px = 4;
  ASSERT_TRUE(encoder_.configure(other).ok());
  EXPECT_FALSE(encoder_.calibration().has_value());
  EXPECT_EQ(geometry(0).geometry().calib_size(), 0);
  EXPECT_EQ(geometry(0).geometry().field().field_length(), 2200);
}

TEST_F(SslVision, RejectsAnUnusableCamera) {
  VenueGeometry other = example_geometry();
  other.camera.full.fx_px = 0.0f;
  EXPECT_EQ(encoder_.configure(other).code(), ErrorCode::kOutOfRange);
}

}  // namespace
}  // namespace touchline::network
