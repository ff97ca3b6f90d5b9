// FIRASim's packets, written and read by protobuf's own library with the simulator's definitions.
#include "firmware/network/firasim.h"

#include <gtest/gtest.h>
#include <tests/network/firasim.pb.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/network/example_frame.h"

namespace touchline::network {
namespace {

namespace pb = fira_message;

pb::Environment environment(const OutputFrame& frame) {
  const std::string bytes =
      datagram([&](auto out) { return encode_firasim_environment(frame, example_geometry().field, out); });
  pb::Environment message;
  EXPECT_TRUE(message.ParseFromString(bytes));
  return message;
}

TEST(FirasimEnvironment, HasFieldBallAndRobots) {
  const Snapshot snapshot = example_snapshot();
  const pb::Environment message = environment(example_output(snapshot));
  EXPECT_EQ(message.step(), 41u);
  EXPECT_FLOAT_EQ(static_cast<float>(message.field().length()), 2.2f);
  EXPECT_FLOAT_EQ(static_cast<float>(message.field().width()), 1.8f);
  EXPECT_FLOAT_EQ(static_cast<float>(message.field().goal_width()), 0.4f);
  EXPECT_FLOAT_EQ(static_cast<float>(message.field().goal_depth()), 0.15f);
  EXPECT_EQ(static_cast<float>(message.frame().ball().x()), -0.5125f);
  EXPECT_EQ(static_cast<float>(message.frame().ball().y()), 0.2505f);
  EXPECT_EQ(message.frame().ball().z(), 0.0);
  EXPECT_EQ(message.frame().ball().vx(), 0.5);
  EXPECT_EQ(message.frame().ball().vy(), -0.25);
  ASSERT_EQ(message.frame().robots_blue_size(), 2);
  ASSERT_EQ(message.frame().robots_yellow_size(), 1);
  // Sorted by id.
  EXPECT_EQ(message.frame().robots_blue(0).robot_id(), 1u);
  const pb::Robot& robot = message.frame().robots_blue(1);
  EXPECT_EQ(robot.robot_id(), 3u);
  EXPECT_EQ(static_cast<float>(robot.x()), 0.6615f);
  EXPECT_EQ(static_cast<float>(robot.y()), 0.5005f);
  EXPECT_EQ(static_cast<float>(robot.orientation()), -2.02f);
  EXPECT_NEAR(robot.vx(), 0.5 * std::cos(-2.02), 1e-6);
  EXPECT_NEAR(robot.vy(), 0.5 * std::sin(-2.02), 1e-6);
  EXPECT_EQ(robot.vorientation(), 1.25);
}

TEST(FirasimEnvironment, ALostBallIsAbsent) {
  Snapshot snapshot = example_snapshot();
  snapshot.tracks.ball.state = TrackState::kLost;
  EXPECT_FALSE(environment(example_output(snapshot)).frame().has_ball());
}

TEST(FirasimEnvironment, TheFullestFrameFitsIntoADatagram) {
  const Snapshot snapshot = fullest_snapshot();
  const pb::Environment message = environment(example_output(snapshot));
  EXPECT_EQ(message.frame().robots_blue_size() + message.frame().robots_yellow_size(), 22);
}

void add(pb::Packet& packet, std::uint32_t id, bool yellow, double left, double right) {
  pb::Command& command = *packet.mutable_cmd()->add_robot_commands();
  command.set_id(id);
  command.set_yellowteam(yellow);
  command.set_wheel_left(left);
  command.set_wheel_right(right);
}

Result<CommandBatch> decoded(const pb::Packet& packet, TeamColor own = TeamColor::kBlue) {
  const std::string bytes = packet.SerializeAsString();
  return decode_firasim_packet(bytes_of(bytes), own, 0.02f);
}

TEST(FirasimPacket, WheelSpeedsBecomeRimSpeeds) {
  pb::Packet packet;
  add(packet, 0, false, 10.0, -20.0);
  add(packet, 2, false, 0.0, 0.0);
  const Result<CommandBatch> batch = decoded(packet);
  ASSERT_TRUE(batch.ok()) << batch.text();
  ASSERT_EQ(batch.value().commands.size(), 2u);
  const ExternalCommand& command = batch.value().commands[0];
  EXPECT_EQ(command.id, 0);
  EXPECT_EQ(command.kind, ExternalCommand::Kind::kWheels);
  EXPECT_FLOAT_EQ(command.wheels.left_mps, 0.2f);
  EXPECT_FLOAT_EQ(command.wheels.right_mps, -0.4f);
  EXPECT_EQ(batch.value().commands[1].id, 2);
  EXPECT_EQ(batch.value().other_team, 0u);
}

TEST(FirasimPacket, CommandsForTheOtherColorAreCounted) {
  pb::Packet packet;
  add(packet, 0, false, 1.0, 1.0);
  add(packet, 0, true, 2.0, 2.0);
  add(packet, 1, true, 3.0, 3.0);
  const Result<CommandBatch> blue = decoded(packet), yellow = decoded(packet, TeamColor::kYellow);
  ASSERT_TRUE(blue.ok() && yellow.ok());
  EXPECT_EQ(blue.value().commands.size(), 1u);
  EXPECT_EQ(blue.value().other_team, 2u);
  EXPECT_EQ(yellow.value().commands.size(), 2u);
  EXPECT_EQ(yellow.value().other_team, 1u);
}

TEST(FirasimPacket, TheLastCommandOfARobotCounts) {
  pb::Packet packet;
  add(packet, 1, false, 1.0, 1.0);
  add(packet, 1, false, 5.0, 5.0);
  const Result<CommandBatch> batch = decoded(packet);
  ASSERT_TRUE(batch.ok());
  ASSERT_EQ(batch.value().commands.size(), 1u);
  EXPECT_FLOAT_EQ(batch.value().commands[0].wheels.left_mps, 0.1f);
}

TEST(FirasimPacket, LargeSpeedsAreLimited) {
  pb::Packet packet;
  add(packet, 1, false, 1e300, -1e9);
  const Result<CommandBatch> batch = decoded(packet);
  ASSERT_TRUE(batch.ok());
  EXPECT_EQ(batch.value().commands[0].wheels.left_mps, kMaxRimSpeed_mps);
  EXPECT_EQ(batch.value().commands[0].wheels.right_mps, -kMaxRimSpeed_mps);
}

TEST(FirasimPacket, RejectsWhatMakesNoSense) {
  pb::Packet infinite;
  add(infinite, 1, false, std::numeric_limits<double>::infinity(), 0.0);
  EXPECT_EQ(decoded(infinite).text(), "robot_commands[0]: a wheel speed is not finite");
  pb::Packet nan;
  add(nan, 1, true, 0.0, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(decoded(nan).code(), ErrorCode::kOutOfRange);
  pb::Packet id;
  add(id, 128, false, 0.0, 0.0);
  EXPECT_EQ(decoded(id).text(), "robot_commands[0].id = 128 is above 127");
  pb::Packet many;
  for (std::uint32_t i = 0; i < 12; ++i) add(many, i, false, 0.0, 0.0);
  EXPECT_EQ(decoded(many).text(), "commands for more than 11 robots");
  for (std::uint32_t i = 12; i < 23; ++i) add(many, i, false, 0.0, 0.0);
  EXPECT_EQ(decoded(many).code(), ErrorCode::kCorruptFrame);
}

TEST(FirasimPacket, PlacementsAndEmptyPacketsHaveNoCommands) {
  pb::Packet packet;
  packet.mutable_replace()->mutable_ball()->set_x(0.5);
  for (const pb::Packet& each : {packet, pb::Packet()}) {
    const Result<CommandBatch> batch = decoded(each);
    ASSERT_TRUE(batch.ok());
    EXPECT_TRUE(batch.value().commands.empty());
  }
}

}  // namespace
}  // namespace touchline::network
