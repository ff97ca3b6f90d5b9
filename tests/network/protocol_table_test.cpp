// What encoders and decoders take from the configuration.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "firmware/network/decoder.h"
#include "firmware/network/encoder.h"
#include "firmware/network/publisher.h"

namespace touchline::network {
namespace {

class ProtocolTable : public ::testing::Test {
 protected:
  ProtocolTable() {
    configuration_->team.own.color = "blue";
    configuration_->team.opponent.color = "yellow";
  }

  // Large: not for the stack.
  std::unique_ptr<config::Configuration> configuration_ = std::make_unique<config::Configuration>();
};

TEST_F(ProtocolTable, JsonNamesTheTeamsByTheirPresentColors) {
  Result<std::unique_ptr<Encoder>> encoder = make_encoder(config::OutputProtocol::kJson, *configuration_);
  ASSERT_TRUE(encoder.ok());
  Snapshot snapshot;
  RobotTrack robot;
  robot.team = Team::kOwn;
  robot.id = 3;
  snapshot.tracks.robots.push_back(robot);
  const auto line = [&](TeamColor own) {
    std::vector<std::byte> memory(kMaxDatagramBytes);
    OutputFrame frame{snapshot};
    frame.own = own;
    const std::size_t size = encoder.value()->encode_frame(frame, memory);
    return std::string(reinterpret_cast<const char*>(memory.data()), size);
  };
  EXPECT_NE(line(TeamColor::kBlue).find(R"("tracks":{"ball":null,"robots":[{"team":"blue","id":3,)"),
            std::string::npos);
  EXPECT_NE(line(TeamColor::kYellow).find(R"("robots":[{"team":"yellow","id":3,)"), std::string::npos);
  EXPECT_NE(line(TeamColor::kYellow).find(R"("yellow":{"3":{"x":)"), std::string::npos);
}

TEST_F(ProtocolTable, FirasimUsesTheConfiguredWheelRadius) {
  configuration_->board.network.wheel_radius_m = 0.03f;
  const std::unique_ptr<Decoder> decoder = make_decoder(config::InputProtocol::kFirasim, *configuration_);
  // cmd { robot_commands { id: 1, wheel_left: 10.0 } }
  const std::string packet("\x0a\x0d\x0a\x0b\x08\x01\x31\x00\x00\x00\x00\x00\x00\x24\x40", 15);
  const Result<DecodedMessage> message =
      decoder->decode(std::as_bytes(std::span<const char>(packet)), TeamColor::kBlue);
  ASSERT_TRUE(message.ok()) << message.text();
  ASSERT_EQ(message.value().batch.commands.size(), 1u);
  EXPECT_FLOAT_EQ(message.value().batch.commands[0].wheels.left_mps, 0.3f);
}

// Each of several cameras has a number of its own, in detection and geometry.
TEST_F(ProtocolTable, SslVisionNamesTheConfiguredCamera) {
  configuration_->board.network.camera_id = 3;
  EXPECT_EQ(published_scene(*configuration_).camera_id, 3U);
}

}  // namespace
}  // namespace touchline::network
