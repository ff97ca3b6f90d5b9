// Tracked packets, decoded by protobuf's own library with the receivers' definitions.
#include "firmware/network/ssl_tracked.h"

#include <gtest/gtest.h>
#include <tests/network/ssl_tracked.pb.h>

#include <cmath>
#include <regex>
#include <string>

#include "tests/network/example_frame.h"

namespace touchline::network {
namespace {

constexpr std::string_view kUuid = "01234567-89ab-4cde-8f01-23456789abcd";

TrackerWrapperPacket tracked(const OutputFrame& frame) {
  const std::string bytes = datagram([&](auto out) { return encode_ssl_tracked(frame, kUuid, out); });
  TrackerWrapperPacket packet;
  EXPECT_TRUE(packet.ParseFromString(bytes)) << packet.InitializationErrorString();
  return packet;
}

TEST(SslTracked, NamesItsSource) {
  const Snapshot snapshot = example_snapshot();
  const TrackerWrapperPacket packet = tracked(example_output(snapshot));
  EXPECT_EQ(packet.uuid(), kUuid);
  EXPECT_EQ(packet.source_name(), "Touchline");
  EXPECT_EQ(packet.tracked_frame().frame_number(), 41u);
  EXPECT_EQ(packet.tracked_frame().timestamp(), 1700000000.123456);
  EXPECT_EQ(packet.tracked_frame().capabilities_size(), 0);
}

TEST(SslTracked, HasTheBallInMeters) {
  Snapshot snapshot = example_snapshot();
  const TrackerWrapperPacket packet = tracked(example_output(snapshot));
  ASSERT_EQ(packet.tracked_frame().balls_size(), 1);
  const TrackedBall& ball = packet.tracked_frame().balls(0);
  EXPECT_EQ(ball.pos().x(), -0.5125f);
  EXPECT_EQ(ball.pos().y(), 0.2505f);
  EXPECT_EQ(ball.pos().z(), 0.0f);
  EXPECT_EQ(ball.vel().x(), 0.5f);
  EXPECT_EQ(ball.vel().y(), -0.25f);
  EXPECT_EQ(ball.visibility(), 1.0f);
  snapshot.tracks.ball.state = TrackState::kCoasting;
  EXPECT_EQ(tracked(example_output(snapshot)).tracked_frame().balls(0).visibility(), 0.0f);
  snapshot.tracks.ball.state = TrackState::kLost;
  EXPECT_EQ(tracked(example_output(snapshot)).tracked_frame().balls_size(), 0);
}

TEST(SslTracked, HasRobotsOfKnownId) {
  const Snapshot snapshot = example_snapshot();
  const TrackerWrapperPacket packet = tracked(example_output(snapshot));
  ASSERT_EQ(packet.tracked_frame().robots_size(), 3);
  const TrackedRobot& robot = packet.tracked_frame().robots(0);
  EXPECT_EQ(robot.robot_id().id(), 3u);
  EXPECT_EQ(robot.robot_id().team_color(), TEAM_COLOR_BLUE);
  EXPECT_EQ(robot.pos().x(), 0.6615f);
  EXPECT_EQ(robot.pos().y(), 0.5005f);
  EXPECT_EQ(robot.orientation(), -2.02f);
  EXPECT_FLOAT_EQ(robot.vel().x(), 0.5f * std::cos(-2.02f));
  EXPECT_FLOAT_EQ(robot.vel().y(), 0.5f * std::sin(-2.02f));
  EXPECT_EQ(robot.vel_angular(), 1.25f);
  EXPECT_EQ(robot.visibility(), 1.0f);
  EXPECT_EQ(packet.tracked_frame().robots(1).visibility(), 0.0f);
  EXPECT_EQ(packet.tracked_frame().robots(2).robot_id().team_color(), TEAM_COLOR_YELLOW);
}

TEST(SslTracked, TheFullestFrameFitsIntoADatagram) {
  const Snapshot snapshot = fullest_snapshot();
  EXPECT_EQ(tracked(example_output(snapshot)).tracked_frame().robots_size(), 22);
}

TEST(SslTracked, RandomUuidsAreValidAndDiffer) {
  const std::string uuid = random_uuid();
  EXPECT_TRUE(std::regex_match(uuid, std::regex("[0-9a-f]{8}-[0-9a-f]{4}-4[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}")))
      << uuid;
  EXPECT_NE(uuid, random_uuid());
}

}  // namespace
}  // namespace touchline::network
