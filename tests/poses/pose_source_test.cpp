// Packets of simulators and vision systems, written by protobuf's own library with the senders' definitions.
#include "hal/poses/pose_source.h"

#include <gtest/gtest.h>
#include <tests/network/firasim.pb.h>
#include <tests/network/ssl_tracked.pb.h>
#include <tests/network/ssl_vision.pb.h>

#include <chrono>
#include <limits>
#include <memory>
#include <string>

namespace touchline::hal {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kSimulator = 0x7f000001;

class Source : public ::testing::Test {
 protected:
  void begin(PoseProtocol protocol, bool own_is_yellow = false) {
    PoseSourceSettings settings;
    settings.protocol = protocol;
    settings.teams.own_is_yellow = own_is_yellow;
    for (RobotId id = 0; id < 3; ++id) settings.teams.own_ids.push_back(id);
    source_ = std::make_unique<PoseSource>(settings);
  }
  template <class Message>
  Result<bool> take(const Message& message, std::uint64_t sender = kSimulator) {
    return take_bytes(message.SerializeAsString(), sender);
  }
  Result<bool> take_bytes(const std::string& bytes, std::uint64_t sender = kSimulator) {
    now_ += 16ms;
    return source_->take(std::as_bytes(std::span(bytes)), sender, now_, *out_);
  }
  [[nodiscard]] const Sightings& sightings() const { return out_->sightings; }

  static fira_message::Environment environment(std::uint32_t step) {
    fira_message::Environment message;
    message.set_step(step);
    message.mutable_frame()->mutable_ball()->set_x(0.125);
    fira_message::Robot& blue = *message.mutable_frame()->add_robots_blue();
    blue.set_robot_id(2);
    blue.set_x(-0.5);
    blue.set_y(0.25);
    blue.set_orientation(7.0);
    message.mutable_frame()->add_robots_yellow()->set_x(0.5);
    message.set_goals_blue(4);
    return message;
  }

  static SSL_WrapperPacket detection(std::uint32_t number, std::uint32_t camera = 0) {
    SSL_WrapperPacket message;
    SSL_DetectionFrame& frame = *message.mutable_detection();
    frame.set_frame_number(number);
    frame.set_camera_id(camera);
    frame.set_t_capture(1.7e9 + 0.016 * number);
    frame.set_t_sent(1.7e9 + 0.016 * number + 0.005);
    SSL_DetectionRobot& robot = *frame.add_robots_blue();
    robot.set_confidence(0.9f);
    robot.set_robot_id(1);
    robot.set_x(-1250.0f);
    robot.set_y(500.0f);
    robot.set_orientation(1.5f);
    robot.set_pixel_x(0.0f);
    robot.set_pixel_y(0.0f);
    SSL_DetectionBall& ball = *frame.add_balls();
    ball.set_confidence(1.0f);
    ball.set_x(100.0f);
    ball.set_y(-200.0f);
    ball.set_pixel_x(0.0f);
    ball.set_pixel_y(0.0f);
    return message;
  }

  static TrackerWrapperPacket tracked(std::uint32_t number, const std::string& uuid = "a") {
    TrackerWrapperPacket message;
    message.set_uuid(uuid);
    message.set_source_name("ER-FORCE");
    TrackedFrame& frame = *message.mutable_tracked_frame();
    frame.set_frame_number(number);
    frame.set_timestamp(1.7e9 + 0.016 * number);
    TrackedRobot& robot = *frame.add_robots();
    robot.mutable_robot_id()->set_id(0);
    robot.mutable_robot_id()->set_team_color(TEAM_COLOR_YELLOW);
    robot.mutable_pos()->set_x(1.5f);
    robot.mutable_pos()->set_y(-0.5f);
    robot.set_orientation(0.5f);
    robot.set_visibility(1.0f);
    TrackedBall& ball = *frame.add_balls();
    ball.mutable_pos()->set_x(2.0f);
    ball.mutable_pos()->set_y(1.0f);
    ball.mutable_pos()->set_z(0.0f);
    return message;
  }

  Instant now_{10s};
  std::unique_ptr<PoseSource> source_;
  std::unique_ptr<MergedPoses> out_ = std::make_unique<MergedPoses>();
};

TEST_F(Source, FirasimsEnvironmentIsInMetersAndRadians) {
  begin(PoseProtocol::kFirasim);
  ASSERT_TRUE(take(environment(1)).value());
  ASSERT_EQ(sightings().robots.size(), 2u);
  const RobotSighting& own = sightings().robots[0];
  EXPECT_EQ(own.team, Team::kOwn);
  EXPECT_EQ(own.id, 2);
  EXPECT_EQ(own.pose.position.x_m, -0.5f);
  EXPECT_NEAR(own.pose.theta_rad, 7.0 - 2.0 * 3.14159265, 1e-6) << "headings are within half a turn";
  EXPECT_GT(own.confidence, 0.99f);
  EXPECT_EQ(sightings().robots[1].team, Team::kOpponent);
  EXPECT_EQ(sightings().robots[1].id, 0);
  EXPECT_EQ(sightings().ball.position.x_m, 0.125f);
  EXPECT_EQ(out_->capture_time, now_) << "FIRASim sends no time";
}

TEST_F(Source, AsTheYellowTeamTheTeamsAreExchanged) {
  begin(PoseProtocol::kFirasim, true);
  ASSERT_TRUE(take(environment(1)).value());
  EXPECT_EQ(sightings().robots[0].team, Team::kOpponent);
  EXPECT_EQ(sightings().robots[1].team, Team::kOwn);
}

TEST_F(Source, SslVisionIsInMillimeters) {
  begin(PoseProtocol::kSslVision);
  ASSERT_TRUE(take(detection(1)).value());
  EXPECT_FLOAT_EQ(sightings().robots[0].pose.position.x_m, -1.25f);
  EXPECT_FLOAT_EQ(sightings().robots[0].pose.position.y_m, 0.5f);
  EXPECT_EQ(sightings().robots[0].pose.theta_rad, 1.5f);
  EXPECT_EQ(sightings().robots[0].confidence, 0.9f);
  EXPECT_FLOAT_EQ(sightings().ball.position.y_m, -0.2f);
  EXPECT_NEAR(seconds(now_ - out_->capture_time), 0.005, 1e-6) << "the time from capture to sending";
}

TEST_F(Source, SslVisionsGeometryHasNoPoses) {
  begin(PoseProtocol::kSslVision);
  SSL_WrapperPacket message;
  SSL_GeometryFieldSize& field = *message.mutable_geometry()->mutable_field();
  field.set_field_length(9000);
  field.set_field_width(6000);
  field.set_goal_width(1000);
  field.set_goal_depth(180);
  field.set_boundary_width(300);
  const Result<bool> taken = take(message);
  ASSERT_TRUE(taken.ok()) << taken.text();
  EXPECT_FALSE(taken.value());
}

TEST_F(Source, TrackedPacketsAreInMeters) {
  begin(PoseProtocol::kSslTracked, true);
  ASSERT_TRUE(take(tracked(1)).value());
  EXPECT_EQ(sightings().robots[0].team, Team::kOwn);
  EXPECT_EQ(sightings().robots[0].pose.position.x_m, 1.5f);
  EXPECT_EQ(sightings().robots[0].pose.theta_rad, 0.5f);
  EXPECT_EQ(sightings().ball.position.x_m, 2.0f);
}

TEST_F(Source, WhatATrackerPredictsIsNotSeen) {
  begin(PoseProtocol::kSslTracked, true);
  TrackerWrapperPacket message = tracked(1);
  message.mutable_tracked_frame()->mutable_robots(0)->set_visibility(0.0f);
  message.mutable_tracked_frame()->mutable_balls(0)->set_visibility(0.0f);
  ASSERT_TRUE(take(message).value());
  EXPECT_TRUE(sightings().robots.empty());
  EXPECT_FALSE(sightings().ball.seen);
}

TEST_F(Source, OfTwoTrackersInAGroupTheFirstIsFollowed) {
  begin(PoseProtocol::kSslTracked);
  ASSERT_TRUE(take(tracked(1, "a")).value());
  EXPECT_FALSE(take(tracked(500, "b")).value()) << "from the same address";
  EXPECT_TRUE(take(tracked(2, "a")).value());
  EXPECT_EQ(source_->counters().foreign, 1u);
}

TEST_F(Source, LateAndDoubledPacketsAreCountedAndLostOnesLeaveAGap) {
  begin(PoseProtocol::kFirasim);
  ASSERT_TRUE(take(environment(10)).value());
  const std::uint32_t first = source_->sequence();
  EXPECT_FALSE(take(environment(10)).value());
  EXPECT_TRUE(take(environment(13)).value());
  EXPECT_EQ(source_->sequence() - first, 3u) << "two are missing";
  EXPECT_FALSE(take(environment(12)).value());
  EXPECT_TRUE(take(environment(14)).value());
  EXPECT_EQ(source_->sequence() - first, 4u);
  EXPECT_EQ(source_->counters().doubled, 1u);
  EXPECT_EQ(source_->counters().late, 1u);
}

TEST_F(Source, CamerasCountForThemselves) {
  begin(PoseProtocol::kSslVision);
  for (std::uint32_t i = 0; i < 10; ++i) {
    ASSERT_TRUE(take(detection(1000 + i, 0)).ok());
    ASSERT_TRUE(take(detection(7 + i, 1), kSimulator + 1).ok());
  }
  EXPECT_EQ(source_->counters().sum(), 0u);
}

TEST_F(Source, MalformedPacketsSayWhatIsWrong) {
  begin(PoseProtocol::kFirasim);
  EXPECT_EQ(take_bytes("no protobuf").code(), ErrorCode::kCorruptFrame);
  EXPECT_EQ(take_bytes("").text(), "no frame, which FIRASim always sends");
  fira_message::Environment far = environment(1);
  far.mutable_frame()->mutable_ball()->set_x(500.0);
  EXPECT_EQ(take(far).text(), "a position is far outside of the field");
  far.mutable_frame()->mutable_ball()->set_x(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(take(far).code(), ErrorCode::kOutOfRange);
  begin(PoseProtocol::kSslVision);
  EXPECT_EQ(take(detection(1, 16)).text(), "camera_id = 16 is above 15");
  EXPECT_EQ(source_->counters().malformed, 1u);
}

}  // namespace
}  // namespace touchline::hal
