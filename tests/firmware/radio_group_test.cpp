// Two radios at once: one is lost and comes back while the other goes on.
#include "firmware/radio_group.h"

#include <gtest/gtest.h>

#include "tests/firmware/loop_fixture.h"
#include "tests/results.h"

namespace touchline::testing {
namespace {

using namespace std::chrono_literals;

/// A loop whose radio consists of two, each for a robot.
class TwoRadios : public LoopTest {
 protected:
  TwoRadios() {
    std::vector<GroupMember> members;
    for (std::size_t i = 0; i < 2; ++i) {
      auto half = std::make_unique<FakeRadio>(clock);
      halves[i] = half.get();
      std::bitset<kMaxReceivers> reaches;
      reaches.set(i).set(kAllRobots);
      members.push_back({std::move(half), reaches});
    }
    group = std::make_unique<RadioGroup>(std::move(members), clock, 500ms, true);
    camera.show_robot();
  }
  ~TwoRadios() override {
    if (loop) loop->close();
    loop.reset();
  }
  void start_with_group() {
    EXPECT_TRUE(pipeline->configure(fake_camera_parameters()).ok());
    loop = std::make_unique<Loop>(HalDevices{camera, *group, gpio, clock, true}, *pipeline, settings, *ring);
    EXPECT_OK(loop->open());
  }
  static bool all_stop(const FakeRadio& radio, double from_s, double to_s) {
    std::size_t packets = 0, stops = 0;
    for (const SentPacket& packet : radio.sent) {
      if (packet.at_s < from_s || packet.at_s >= to_s) continue;
      ++packets;
      stops += packet.stop ? 1 : 0;
    }
    EXPECT_GT(packets, 0U) << from_s;
    EXPECT_TRUE(stops == 0 || stops == packets) << stops << " of " << packets;
    return stops > 0;
  }
  static std::size_t count(const FakeRadio& radio, double from_s, double to_s) {
    std::size_t packets = 0;
    for (const SentPacket& packet : radio.sent) packets += packet.at_s >= from_s && packet.at_s < to_s ? 1 : 0;
    return packets;
  }

  std::array<FakeRadio*, 2> halves{};
  std::unique_ptr<RadioGroup> group;
};

TEST_F(TwoRadios, APortThatReachesOneRobotTellsWhoHasSent) {
  ASSERT_OK(group->open());
  const std::array<std::byte, 2> bytes{std::byte{1}, std::byte{2}};
  halves[0]->add_received(bytes);
  halves[1]->add_received(std::span(bytes).first(1));
  std::array<std::byte, 16> into{};
  std::size_t sender = 0;
  std::array<std::size_t, 2> received{};
  for (int i = 0; i < 2; ++i) {
    const Result<std::size_t> count = group->receive(into, sender);
    ASSERT_OK(count);
    ASSERT_LT(sender, 2U);
    received[sender] += count.value();
  }
  EXPECT_EQ(received[0], 2U);
  EXPECT_EQ(received[1], 1U);
  EXPECT_EQ(group->receive(into, sender).value(), 0U);
}

TEST_F(TwoRadios, RobotsOfTheOtherOneAreStoppedWhileOneIsLost) {
  settings.faults.radio_outage_s = 2.0;  // the second attempt, 1.5 s after the loss, succeeds
  halves[0]->add({1.0, 1.8, ErrorCode::kDisconnected});
  start_with_group();
  run_until(3.0);
  EXPECT_FALSE(all_stop(*halves[1], 0.1, 1.0));
  EXPECT_EQ(count(*halves[0], 1.02, 2.4), 0U);
  EXPECT_TRUE(all_stop(*halves[1], 1.03, 2.4)) << "robots that can be reached get stops";
  EXPECT_EQ(halves[1]->opened_s.size(), 1U) << "the other one is not interrupted";
  EXPECT_GE(halves[0]->opened_s.size(), 2U);
  EXPECT_FALSE(all_stop(*halves[1], 2.7, 3.0)) << "both go on by themselves after a short outage";
  EXPECT_FALSE(all_stop(*halves[0], 2.7, 3.0));
  std::size_t lost = 0, back = 0;
  for (const Report& report : reports()) {
    if (report.kind != Report::Kind::kFault || report.fault.device != Device::kRadio) continue;
    lost += report.fault.code == ErrorCode::kDisconnected ? 1 : 0;
    back += report.fault.code == ErrorCode::kOk ? 1 : 0;
  }
  EXPECT_EQ(lost, 1U);
  EXPECT_EQ(back, 1U);
  EXPECT_EQ(loop->statistics().reopened[static_cast<std::size_t>(Device::kRadio)], 1U);
}

TEST_F(TwoRadios, AnOutageThatIsTooLongNeedsAStart) {
  settings.faults.radio_outage_s = 0.3;
  halves[0]->add({1.0, 1.8, ErrorCode::kDisconnected});
  start_with_group();
  run_until(3.0);
  EXPECT_TRUE(all_stop(*halves[1], 2.5, 3.0));
  EXPECT_TRUE(all_stop(*halves[0], 2.5, 3.0));
}

TEST_F(TwoRadios, WithoutAnyRadioTheLoopGoesOnUntilOneIsBack) {
  halves[0]->add({1.0, 1.6, ErrorCode::kDisconnected});
  halves[1]->add({1.0, 1.6, ErrorCode::kIo});
  settings.faults.radio_outage_s = 5.0;
  start_with_group();
  run_until(4.0);
  EXPECT_FALSE(all_stop(*halves[0], 3.5, 4.0));
  EXPECT_FALSE(all_stop(*halves[1], 3.5, 4.0));
  EXPECT_GT(loop->statistics().packets_refused, 10U);
}

TEST_F(TwoRadios, ARobotsPacketGoesToTheRadioThatReachesIt) {
  ASSERT_OK(group->open());
  Packet stop;
  ASSERT_TRUE(pipeline->configure(fake_camera_parameters()).ok());
  StepInputs inputs;
  inputs.now = clock.now();
  const OutgoingPackets& packets = pipeline->stop(inputs);
  ASSERT_EQ(packets.size(), 1U);
  stop = packets[0].packet;
  EXPECT_OK(group->send(stop, 0));
  EXPECT_EQ(halves[0]->sent.size(), 1U);
  EXPECT_EQ(halves[1]->sent.size(), 0U);
  EXPECT_OK(group->send(stop, kAllRobots));
  EXPECT_EQ(halves[0]->sent.size(), 2U);
  EXPECT_EQ(halves[1]->sent.size(), 1U);
  EXPECT_EQ(group->send(stop, 7).code(), ErrorCode::kTimeout) << "no radio reaches it";
  group->close();
}

TEST_F(TwoRadios, APortThatIsMissingAtTheStartIsAnError) {
  halves[1]->add({0.0, 1.0, ErrorCode::kNotFound});
  EXPECT_EQ(group->open().code(), ErrorCode::kNotFound);
  EXPECT_FALSE(halves[0]->is_open) << "nothing stays open";
}

}  // namespace
}  // namespace touchline::testing
