#include "hal/linux/network/remote_camera.h"

#include <poll.h>
#include <sys/socket.h>
#include <algorithm>
#include <chrono>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "hal/linux/monotonic_clock.h"
#include "tests/results.h"

namespace touchline::hal {
namespace {

using namespace std::chrono_literals;

constexpr std::uint16_t kWidth = 32, kHeight = 16;
constexpr std::size_t kPictureBytes = std::size_t{3} * kWidth * kHeight;

/// The sender's end of a connection, driven by the test.
class RemoteCameraTest : public ::testing::Test {
 protected:
  void SetUp() override {
    TcpAddress any{0x7f000001, 0};
    Result<Descriptor> listener = listen_tcp(any);
    ASSERT_TRUE(listener.ok()) << listener.text();
    listener_ = std::move(listener).value();
    address_ = {0x7f000001, local_port(listener_)};
    settings_.backend = CameraBackend::kRemote;
    settings_.format = CameraFormat::kRgb24;
    settings_.width_px = kWidth;
    settings_.height_px = kHeight;
    settings_.buffers = 3;
    hello_ = {CameraFormat::kRgb24, kWidth, kHeight, 60000, false};
  }
  void accept() {
    pollfd watched{listener_.get(), POLLIN, 0};
    ASSERT_EQ(::poll(&watched, 1, 5000), 1);
    sender_.reset(::accept(listener_.get(), nullptr, nullptr));
  }
  void send(const void* bytes, std::size_t size) const {
    ASSERT_EQ(::send(sender_.get(), bytes, size, MSG_NOSIGNAL), static_cast<ssize_t>(size));
  }
  // Opens the camera while a thread plays the sender's part.
  Result<void> open(FrameClock* clock = nullptr) {
    camera_ = std::make_unique<RemoteCamera>(address_, settings_, clock);
    std::thread sender([this] {
      accept();
      const StreamHelloBytes bytes = encode(hello_);
      send(bytes.data(), bytes.size());
    });
    Result<void> opened = camera_->open();
    sender.join();
    if (opened.ok()) opened = camera_->start();
    return opened;
  }
  // Sends a picture whose bytes all are `value`. Times in ms of the sender.
  void send_picture(std::uint32_t sequence, std::uint8_t value, int captured_ms = 1000, int ready_ms = 1010) const {
    const std::vector<std::uint8_t> picture(kPictureBytes, value);
    send_header(sequence, kPictureBytes, captured_ms, ready_ms);
    send(picture.data(), picture.size());
  }
  void send_header(std::uint32_t sequence, std::size_t bytes, int captured_ms = 1000, int ready_ms = 1010) const {
    constexpr std::int64_t kMs = 1'000'000;
    const PictureHeaderBytes header = encode(PictureHeader{static_cast<std::uint32_t>(bytes), sequence,
                                                           captured_ms * kMs, ready_ms * kMs, ready_ms * kMs, truth_});
    send(header.data(), header.size());
  }
  Result<FrameLease> wait(Duration duration = 2s) { return camera_->wait(MonotonicClock::read() + duration); }
  // Waits until the sender's end has received `count` bytes.
  [[nodiscard]] std::string received(std::size_t count) const {
    std::string bytes(count, '\0');
    const ssize_t got = ::recv(sender_.get(), bytes.data(), count, MSG_WAITALL);
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }

  TcpAddress address_;
  CameraSettings settings_;
  StreamHello hello_;
  TruePlaces truth_;
  Descriptor listener_, sender_;
  std::unique_ptr<RemoteCamera> camera_;
};

TEST_F(RemoteCameraTest, HandsOutWholePictures) {
  ASSERT_OK(open());
  EXPECT_EQ(camera_->info().rate_hz, 60.0);
  send_header(7, kPictureBytes);
  const std::vector<std::uint8_t> half(kPictureBytes / 2, 9);
  send(half.data(), half.size());
  EXPECT_EQ(wait(50ms).code(), ErrorCode::kTimeout) << "half of a picture is none";
  send(half.data(), half.size());
  const Result<FrameLease> lease = wait();
  ASSERT_TRUE(lease.ok()) << lease.text();
  const Frame& frame = lease.value().frame();
  EXPECT_EQ(frame.sequence, 7U);
  EXPECT_TRUE(std::all_of(frame.plane[0], frame.plane[0] + kPictureBytes, [](std::uint8_t v) { return v == 9; }));
}

TEST_F(RemoteCameraTest, StampsFramesOnItsOwnClock) {
  ASSERT_OK(open());
  const Instant before = MonotonicClock::read();
  send_picture(1, 0, 1000, 1010);
  const Result<FrameLease> lease = wait();
  ASSERT_TRUE(lease.ok()) << lease.text();
  // Captured 10 ms before it was sent, whatever the sender's clock shows.
  const Duration age = MonotonicClock::read() - lease.value().frame().capture_time;
  EXPECT_GE(age, 10ms);
  EXPECT_LT(lease.value().frame().capture_time - before, MonotonicClock::read() - before - 9ms);
}

TEST_F(RemoteCameraTest, DropsTheOldestPicturesOfASlowReceiver) {
  ASSERT_OK(open());
  for (std::uint32_t i = 0; i < 20; ++i) send_picture(i, static_cast<std::uint8_t>(i));
  std::this_thread::sleep_for(50ms);
  std::uint32_t last = 0;
  std::size_t count = 0;
  // A call reads as many pictures as there are buffers, and keeps the newest.
  while (true) {
    const Result<FrameLease> lease = wait(50ms);
    if (!lease.ok()) break;
    const Frame& frame = lease.value().frame();
    EXPECT_TRUE(count == 0 || frame.sequence > last);
    EXPECT_EQ(frame.plane[0][0], frame.sequence);
    last = frame.sequence;
    ++count;
  }
  EXPECT_EQ(last, 19U);
  EXPECT_LT(count, 20U);
}

TEST_F(RemoteCameraTest, ReportsASenderThatHasGoneAndConnectsAgain) {
  ASSERT_OK(open());
  send_picture(1, 1);
  sender_.reset();
  EXPECT_TRUE(wait().ok()) << "what has arrived is handed out";
  const Result<FrameLease> lost = wait();
  EXPECT_EQ(lost.code(), ErrorCode::kDisconnected);
  EXPECT_NE(std::string(lost.text()).find("has closed the connection"), std::string::npos) << lost.text();
  camera_->stop();
  camera_->close();
  listener_.reset();
  EXPECT_EQ(camera_->open().code(), ErrorCode::kNotFound);
  Result<Descriptor> again = listen_tcp(address_);
  ASSERT_TRUE(again.ok()) << again.text();
  listener_ = std::move(again).value();
  ASSERT_OK(open());
  send_picture(1, 2);
  EXPECT_TRUE(wait().ok());
}

TEST_F(RemoteCameraTest, RefusesAnotherFormatWithBothNames) {
  hello_.format = CameraFormat::kYuyv;
  const Result<void> refused = open();
  EXPECT_EQ(refused.code(), ErrorCode::kUnsupported);
  EXPECT_NE(std::string(refused.text()).find("sends yuyv 32x16; camera.format, width_px and height_px ask for rgb24"),
            std::string::npos)
      << refused.text();
  hello_.format = CameraFormat::kRgb24;
  hello_.lockstep = true;
  const Result<void> lockstep = open();
  EXPECT_NE(std::string(lockstep.text()).find("camera.lockstep = true"), std::string::npos) << lockstep.text();
}

TEST_F(RemoteCameraTest, SurvivesAnySenderBytes) {
  std::mt19937 random(1);
  std::size_t refused = 0;
  for (int round = 0; round < 60; ++round) {
    ASSERT_OK(open());
    if (round % 3 == 0) {
      // A header that announces too much, or nothing.
      send_header(1, round % 2 == 0 ? 0xffffffff : 0);
    } else if (round % 3 == 1) {
      std::vector<std::uint8_t> garbage(1 + random() % 5000);
      std::generate(garbage.begin(), garbage.end(), [&] { return static_cast<std::uint8_t>(random()); });
      send(garbage.data(), garbage.size());
    } else {
      // A good header with bits changed.
      PictureHeaderBytes header = encode(PictureHeader{kPictureBytes, 1, 1000, 2000, 3000, truth_});
      header[random() % header.size()] ^= static_cast<std::byte>(1U << random() % 8);
      send(header.data(), header.size());
    }
    sender_.reset();
    Result<FrameLease> last = wait();
    while (last.ok()) last = wait();
    EXPECT_EQ(last.code(), ErrorCode::kDisconnected) << last.text();
    if (std::string(last.text()).find("closed the connection") == std::string::npos) ++refused;
    camera_->stop();
    camera_->close();
  }
  EXPECT_GT(refused, 20U);
}

TEST_F(RemoteCameraTest, HandsOutTheTruthThatTheSenderStates) {
  ASSERT_OK(open());
  send_picture(1, 10);
  {
    const Result<FrameLease> without = wait();
    ASSERT_TRUE(without.ok()) << without.text();
    EXPECT_EQ(without.value().truth(), nullptr);
  }
  truth_.is_known = true;
  truth_.ball = {0.125f, -0.5f};
  truth_.robots.push_back({Team::kOwn, 3, {{0.25f, 0.75f}, -1.5f}});
  truth_.robots.push_back({Team::kOpponent, 0, {{-0.625f, 0.0f}, 3.0f}});
  send_picture(2, 20);
  const Result<FrameLease> with = wait();
  ASSERT_TRUE(with.ok()) << with.text();
  const TruePlaces* const truth = with.value().truth();
  ASSERT_NE(truth, nullptr);
  EXPECT_EQ(truth->ball.x_m, 0.125f);
  EXPECT_EQ(truth->ball.y_m, -0.5f);
  ASSERT_EQ(truth->robots.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(truth->robots[i].team, truth_.robots[i].team);
    EXPECT_EQ(truth->robots[i].id, truth_.robots[i].id);
    EXPECT_EQ(truth->robots[i].pose.position.x_m, truth_.robots[i].pose.position.x_m);
    EXPECT_EQ(truth->robots[i].pose.position.y_m, truth_.robots[i].pose.position.y_m);
    EXPECT_EQ(truth->robots[i].pose.theta_rad, truth_.robots[i].pose.theta_rad);
  }
}

TEST_F(RemoteCameraTest, RefusesAnImpossibleTruth) {
  truth_.is_known = true;
  truth_.robots.push_back({Team::kOwn, 3, {{0.25f, std::numeric_limits<float>::quiet_NaN()}, 0.0f}});
  ASSERT_OK(open());
  send_picture(1, 10);
  const Result<FrameLease> frame = wait();
  EXPECT_EQ(frame.code(), ErrorCode::kDisconnected);
  EXPECT_NE(std::string(frame.text()).find("places that come with a picture"), std::string::npos) << frame.text();
}

TEST_F(RemoteCameraTest, ReportsAProgramThatIsNoSender) {
  camera_ = std::make_unique<RemoteCamera>(address_, settings_, nullptr);
  std::thread sender([this] {
    accept();
    const std::string http = "HTTP/1.1 400 Bad Request\r\nConnection: close\r\n\r\n";
    send(http.data(), http.size());
  });
  const Result<void> opened = camera_->open();
  sender.join();
  EXPECT_EQ(opened.code(), ErrorCode::kInconsistent);
  EXPECT_NE(std::string(opened.text()).find("does not send pictures"), std::string::npos) << opened.text();
}

TEST_F(RemoteCameraTest, ADamagedJpegIsLostAlone) {
  settings_.format = hello_.format = CameraFormat::kMjpg;
  ASSERT_OK(open());
  send_header(1, 100);
  const std::vector<std::uint8_t> garbage(100, 0x55);
  send(garbage.data(), garbage.size());
  EXPECT_EQ(wait().code(), ErrorCode::kCorruptFrame);
  EXPECT_EQ(wait(20ms).code(), ErrorCode::kTimeout);
}

TEST_F(RemoteCameraTest, InLockStepTheTimePassesWithTheFrames) {
  hello_.lockstep = true;
  FrameClock clock;
  ASSERT_OK(open(&clock));
  const Instant begin = clock.now();
  // The first frame arrives now, the next one 16 ms later.
  send_picture(1, 1, 1000, 1010);
  {
    const Result<FrameLease> first = camera_->wait(begin + 50ms);
    ASSERT_TRUE(first.ok()) << first.text();
    EXPECT_EQ(clock.now(), begin);
    EXPECT_EQ(first.value().frame().capture_time, begin - 10ms);
  }
  EXPECT_EQ(received(1), "N");
  send_picture(2, 2, 1016, 1026);
  EXPECT_EQ(camera_->wait(begin + 10ms).code(), ErrorCode::kTimeout) << "the frame is not there yet";
  EXPECT_EQ(clock.now(), begin + 10ms);
  const Result<FrameLease> second = camera_->wait(begin + 50ms);
  ASSERT_TRUE(second.ok()) << second.text();
  EXPECT_EQ(clock.now(), begin + 16ms);
  EXPECT_EQ(received(1), "N") << "one request for each frame";
}

TEST_F(RemoteCameraTest, InLockStepASilentSenderDoesNotAdvanceTheTime) {
  hello_.lockstep = true;
  FrameClock clock;
  ASSERT_OK(open(&clock));
  const Instant begin = clock.now();
  const Result<FrameLease> none = camera_->wait(begin + 10ms);
  EXPECT_EQ(none.code(), ErrorCode::kTimeout);
  EXPECT_EQ(clock.now(), begin);
  sender_.reset();
  EXPECT_EQ(camera_->wait(begin + 10ms).code(), ErrorCode::kDisconnected);
  // Without a sender, pauses take their time.
  const Instant before = MonotonicClock::read();
  clock.sleep_until(begin + 30ms);
  EXPECT_GE(MonotonicClock::read() - before, 30ms);
}

}  // namespace
}  // namespace touchline::hal
