#include "firmware/service_notifier.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

#include "tests/firmware/loop_fixture.h"

namespace touchline {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kLongEnough{1500};  // messages normally come after 50 ms

/// Receives messages as a service manager does.
class ServiceNotifierTest : public testing::LoopTest {
 protected:
  ServiceNotifierTest()
      : path_(std::filesystem::temp_directory_path() / ("touchline-notify-" + std::to_string(::getpid()))) {
    socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path_.c_str(), sizeof address.sun_path - 1);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    ::setenv("NOTIFY_SOCKET", path_.c_str(), 1);
    ::setenv("WATCHDOG_USEC", "40000", 1);
  }
  ~ServiceNotifierTest() override {
    ::unsetenv("NOTIFY_SOCKET");
    ::unsetenv("WATCHDOG_USEC");
    ::close(socket_);
    std::filesystem::remove(path_);
  }

  /// Returns the next message, or "" if none arrives in time.
  [[nodiscard]] std::string message(milliseconds patience) const {
    pollfd waiting{socket_, POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(patience.count())) <= 0) return "";
    std::array<char, 256> text{};
    const ssize_t size = ::recv(socket_, text.data(), text.size(), 0);
    return {text.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
  }
  [[nodiscard]] bool receives(const std::string& wanted, milliseconds patience = kLongEnough) const {
    const Clock::time_point end = Clock::now() + patience;
    while (Clock::now() < end) {
      if (message(std::chrono::duration_cast<milliseconds>(end - Clock::now())) == wanted) return true;
    }
    return false;
  }
  void drop_what_came() const {
    while (!message(milliseconds(0)).empty()) continue;
  }

  std::filesystem::path path_;
  int socket_ = -1;
  LoopHeartbeat heartbeat_;
};

TEST_F(ServiceNotifierTest, SendsReadyAfterTheFirstGoodFrame) {
  const ServiceNotifier watch(heartbeat_);
  ASSERT_TRUE(watch.is_enabled());
  EXPECT_FALSE(receives("READY=1", milliseconds(150)));
  heartbeat_.good_frames = 1;
  EXPECT_TRUE(receives("READY=1"));
  heartbeat_.good_frames = 2;
  EXPECT_FALSE(receives("READY=1", milliseconds(150))) << "once";
}

TEST_F(ServiceNotifierTest, APageThatAnswersIsReadyWithoutFrames) {
  ServiceNotifier watch(heartbeat_);
  watch.set_ready();
  EXPECT_TRUE(receives("READY=1"));
  heartbeat_.good_frames = 1;
  EXPECT_FALSE(receives("READY=1", milliseconds(150))) << "once";
}

TEST_F(ServiceNotifierTest, AFileShowsThatFramesHaveCome) {
  const std::filesystem::path folder = path_.string() + ".run";
  std::filesystem::create_directory(folder);
  std::ofstream(folder / "frames") << "of the former run";
  ::setenv("RUNTIME_DIRECTORY", folder.c_str(), 1);
  {
    ServiceNotifier watch(heartbeat_);
    watch.set_ready();
    EXPECT_TRUE(receives("READY=1"));
    EXPECT_FALSE(std::filesystem::exists(folder / "frames"));
    drop_what_came();
    heartbeat_.good_frames = 1;
    ++heartbeat_.iterations;
    EXPECT_TRUE(receives("WATCHDOG=1"));
    EXPECT_TRUE(std::filesystem::exists(folder / "frames"));
  }
  ::unsetenv("RUNTIME_DIRECTORY");
  std::filesystem::remove_all(folder);
}

TEST_F(ServiceNotifierTest, NotifiesTheWatchdogOnlyWhileTheLoopIterates) {
  const ServiceNotifier watch(heartbeat_);
  for (int turn = 0; turn < 3; ++turn) {
    ++heartbeat_.iterations;
    EXPECT_TRUE(receives("WATCHDOG=1"));
  }
  EXPECT_FALSE(receives("WATCHDOG=1", milliseconds(150))) << "the loop does not iterate";
  ++heartbeat_.iterations;
  EXPECT_TRUE(receives("WATCHDOG=1"));
}

TEST_F(ServiceNotifierTest, DoesNotNotifyAWatchdogThatIsNotEnabled) {
  ::unsetenv("WATCHDOG_USEC");
  const ServiceNotifier watch(heartbeat_);
  ++heartbeat_.iterations;
  EXPECT_FALSE(receives("WATCHDOG=1", milliseconds(150)));
}

TEST_F(ServiceNotifierTest, SendsStatusAndStopping) {
  {
    const ServiceNotifier watch(heartbeat_);
    watch.status("12 s  60.0 fps");
    EXPECT_TRUE(receives("STATUS=12 s  60.0 fps"));
    drop_what_came();
  }
  EXPECT_TRUE(receives("STOPPING=1"));
}

TEST_F(ServiceNotifierTest, SendsStoppingWhenTheLoopHasStoppedTheRobots) {
  start();
  ServiceNotifier service(loop->heartbeat());
  EXPECT_EQ(run(*loop, service, std::atomic<bool>(true)), LoopEnd::kRequested);
  EXPECT_TRUE(all_stop(0.0, 1.0));
  EXPECT_TRUE(receives("STOPPING=1", milliseconds(50))) << "the following steps may take long";
  service.status("leaving");
  service.end();
  EXPECT_EQ(message(milliseconds(50)), "STATUS=leaving") << "STOPPING=1 is sent only once";
  EXPECT_EQ(message(milliseconds(50)), "");
}

TEST_F(ServiceNotifierTest, DoesNothingWithoutAServiceManager) {
  ::unsetenv("NOTIFY_SOCKET");
  heartbeat_.good_frames = 1;
  {
    const ServiceNotifier watch(heartbeat_);
    EXPECT_FALSE(watch.is_enabled());
    watch.status("not sent");
  }
  EXPECT_EQ(message(milliseconds(100)), "");
}

class LoopHeartbeatTest : public testing::LoopTest {};

TEST_F(LoopHeartbeatTest, IterationsWithoutFramesAreNotGoodFrames) {
  start();
  const LoopHeartbeat& heartbeat = loop->heartbeat();
  EXPECT_EQ(heartbeat.iterations.load(), 0u);
  run_until(0.5);
  const std::uint64_t frames = heartbeat.good_frames.load();
  EXPECT_EQ(frames, loop->statistics().good_frames);
  EXPECT_GT(frames, 10u);
  const std::uint64_t turns = heartbeat.iterations.load();
  EXPECT_GE(turns, frames);
  camera.add({0.5, 1.0, ErrorCode::kTimeout});
  run_until(1.0);
  EXPECT_EQ(heartbeat.good_frames.load(), frames);
  EXPECT_GT(heartbeat.iterations.load(), turns);
}

}  // namespace
}  // namespace touchline
