// The arena on the machine's clock: rendering takes no time, everything else does.
#include <gtest/gtest.h>

#include <memory>

#include "hal/mock/mock_devices.h"

namespace touchline::hal::mock {
namespace {

using namespace std::chrono_literals;

// Advances by a millisecond with each reading, as if rendering took a long time.
class SlowMachine final : public Clock {
 public:
  [[nodiscard]] Instant now() const override { return now_ += 1ms; }
  void sleep_until(Instant instant) override { now_ = std::max(now_, instant); }
  void stall(Duration time) { now_ += time; }

 private:
  mutable Instant now_ = Instant(100s);
};

struct FollowingArena {
  FollowingArena() { EXPECT_TRUE(camera.open().ok() && camera.start().ok()); }
  Frame next() {
    const Result<FrameLease> lease = camera.wait(clock.now() + 1s);
    EXPECT_TRUE(lease.ok());
    return lease.value().frame();
  }
  static CameraSettings settings() {
    CameraSettings camera;
    camera.width_px = 64;
    camera.height_px = 48;
    camera.rate_hz = 50.0;
    return camera;
  }
  SlowMachine machine;
  RenderingClock clock{machine};
  std::unique_ptr<Arena> arena =
      std::make_unique<Arena>(ArenaParameters{}, settings(), RadioSettings{}, 1, clock.now());
  MockCamera camera{*arena, clock, &clock};
};

TEST(RenderingClock, StandsStillInAPause) {
  SlowMachine machine;
  RenderingClock clock(machine);
  const Instant begin = clock.now();
  clock.pause();
  const Instant paused = clock.now();
  machine.stall(500ms);
  EXPECT_EQ(clock.now(), paused);
  clock.resume();
  EXPECT_LE(clock.now() - begin, 8ms);
  clock.sleep_until(begin + 1s);
  EXPECT_GE(clock.now(), begin + 1s);
  EXPECT_LE(clock.now(), begin + 1008ms);
}

TEST(RenderingClock, AStallDelaysFramesAndLosesThoseWithoutABuffer) {
  FollowingArena following;
  const Frame first = following.next(), second = following.next();
  EXPECT_EQ(second.sequence, first.sequence + 1);
  EXPECT_LE(following.clock.now() - second.capture_time, 20ms);
  following.machine.stall(30ms);
  const Frame third = following.next();
  EXPECT_EQ(third.sequence, second.sequence + 1);
  EXPECT_GE(following.clock.now() - third.capture_time, 15ms);
  EXPECT_EQ(third.capture_time - second.capture_time, 20ms) << "it was exposed in time";
  // Ten frames for four buffers.
  following.machine.stall(200ms);
  std::uint32_t sequence = third.sequence;
  for (int i = 0; i < 5; ++i) sequence = following.next().sequence;
  EXPECT_GE(sequence, third.sequence + 8);
}

}  // namespace
}  // namespace touchline::hal::mock
