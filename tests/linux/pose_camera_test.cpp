#include "hal/linux/network/pose_camera.h"

#include <unistd.h>
#include <array>
#include <chrono>
#include <memory>
#include <thread>

#include <gtest/gtest.h>

#include "hal/linux/monotonic_clock.h"
#include "hal/linux/network/udp_output.h"
#include "hal/poses/firasim_packets.h"
#include "tests/results.h"

namespace touchline::hal {
namespace {

using namespace std::chrono_literals;

class PoseCameraTest : public ::testing::Test {
 protected:
  void SetUp() override {
    // Outside of the range of ports for clients; another one in each test that runs at once.
    address_ = {NetworkAddress::Kind::kUdp, 0x7f000001, static_cast<std::uint16_t>(28000 + ::getpid() % 4000), {}, {}};
    PoseCameraSettings settings;
    settings.address = address_;
    settings.rate_hz = 60.0;
    settings.source.teams.own_ids.push_back(0);
    camera_ = std::make_unique<PoseCamera>(settings);
    ASSERT_OK(camera_->open());
    ASSERT_OK(camera_->start());
    output_ = std::make_unique<UdpOutput>(address_);
    ASSERT_OK(output_->open());
  }

  void send(std::uint32_t step, double x_m = 0.25) {
    FirasimEnvironment environment;
    environment.step = step;
    environment.robots[0].push_back({0, x_m, 0.0, 0.5, 0.0, 0.0, 0.0});
    std::array<std::byte, 512> memory{};
    const std::size_t size = encode_firasim(environment, memory);
    ASSERT_OK(output_->send({memory.data(), size}));
  }
  Result<FrameLease> wait(Duration duration = 1s) { return camera_->wait(MonotonicClock::read() + duration); }

  NetworkAddress address_;
  std::unique_ptr<PoseCamera> camera_;
  std::unique_ptr<UdpOutput> output_;
};

TEST_F(PoseCameraTest, AFrameHasSightingsAndNoPicture) {
  send(1);
  const Result<FrameLease> lease = wait();
  ASSERT_TRUE(lease.ok()) << lease.text();
  const Frame& frame = lease.value().frame();
  ASSERT_NE(frame.sightings, nullptr);
  EXPECT_EQ(frame.width_px, 0);
  EXPECT_EQ(frame.plane[0], nullptr);
  ASSERT_EQ(frame.sightings->robots.size(), 1u);
  EXPECT_EQ(frame.sightings->robots[0].pose.position.x_m, 0.25f);
  EXPECT_EQ(camera_->info().description, "poses of firasim at " + address_.text());
}

TEST_F(PoseCameraTest, TheTimeOfArrivalIsThatOfTheSystemNotOfTheCall) {
  const Instant before = MonotonicClock::read();
  send(1);
  const Instant after = MonotonicClock::read();
  std::this_thread::sleep_for(50ms);
  const Result<FrameLease> lease = wait();
  ASSERT_TRUE(lease.ok()) << lease.text();
  EXPECT_GE(lease.value().frame().capture_time, before - 1ms);
  EXPECT_LE(lease.value().frame().capture_time, after + 1ms) << "not when the loop came to read it";
}

TEST_F(PoseCameraTest, SeveralLeasesHaveTheirOwnSightings) {
  send(1, 0.1);
  const Result<FrameLease> first = wait();
  send(2, 0.2);
  const Result<FrameLease> second = wait();
  ASSERT_TRUE(first.ok()) << first.text();
  ASSERT_TRUE(second.ok()) << second.text();
  EXPECT_EQ(first.value().frame().sightings->robots[0].pose.position.x_m, 0.1f);
  EXPECT_EQ(second.value().frame().sightings->robots[0].pose.position.x_m, 0.2f);
  EXPECT_EQ(second.value().frame().sequence - first.value().frame().sequence, 1u);
}

TEST_F(PoseCameraTest, SilenceIsATimeOutThatSaysWhatToCheck) {
  EXPECT_EQ(wait(1ms).code(), ErrorCode::kTimeout);
  EXPECT_NE(wait(1ms).text().find("nothing has arrived yet: is the sender running"), std::string::npos);
}

TEST_F(PoseCameraTest, AMalformedPacketIsAFrameThatIsLost) {
  const std::array<std::byte, 3> bytes{std::byte{1}, std::byte{2}, std::byte{3}};
  ASSERT_OK(output_->send(bytes));
  const Result<FrameLease> lease = wait();
  EXPECT_EQ(lease.code(), ErrorCode::kCorruptFrame);
  EXPECT_NE(lease.text().find("a packet of 3 bytes from 127.0.0.1 is malformed"), std::string::npos) << lease.text();
  send(1);
  EXPECT_OK(wait());
  EXPECT_EQ(camera_->source_counters().malformed, 1u);
}

TEST_F(PoseCameraTest, ADoubledPacketGivesNoFrame) {
  send(1);
  send(1);
  EXPECT_OK(wait());
  EXPECT_EQ(wait(20ms).code(), ErrorCode::kTimeout);
  EXPECT_EQ(camera_->source_counters().doubled, 1u);
}

TEST_F(PoseCameraTest, ItCanBeOpenedAgain) {
  camera_->stop();
  camera_->close();
  ASSERT_OK(camera_->open());
  ASSERT_OK(camera_->start());
  send(1);
  EXPECT_OK(wait());
}

}  // namespace
}  // namespace touchline::hal
