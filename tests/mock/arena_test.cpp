// The whole arena: it is repeatable, does not allocate, and runs in virtual or real time.
#include <atomic>
#include <thread>

#include "hal/linux/monotonic_clock.h"
#include "tests/mock/devices_fixture.h"
#include "tools/programs/latency/allocation_counter.h"

namespace touchline::hal::mock {
namespace {

using namespace std::chrono_literals;

class ArenaTest : public DevicesTest {
 protected:
  // Processes frames, packets and the emergency stop as the firmware's loop does; `driver` makes the packets.
  template <class Driver>
  void play(double until_s, Driver driver) {
    std::uint8_t sequence = 0;
    while (now_s() < until_s) {
      const auto lease = wait(0.1);
      if (!lease.ok() && lease.code() != ErrorCode::kTimeout) go_to(now_s() + 0.02);
      static_cast<void>(gpio->inputs(arena->now()));
      static_cast<void>(radio->send(driver(sequence++)));
    }
  }
};

Packet wild_drive(std::uint8_t sequence) {
  std::array<Drive, 5> drives{};
  for (int id = 0; id < 5; ++id) {
    drives[static_cast<std::size_t>(id)] = {id, 0.01 * ((sequence * 7 + id * 31) % 160 - 60),
                                            0.01 * ((sequence * 11 + id * 17) % 160 - 60)};
  }
  return packet_of(drives, sequence);
}

TEST_F(ArenaTest, TheSameSeedAndPacketsGiveTheSameGame) {
  parameters = ArenaParameters{};
  const auto hash_after_game = [&](std::uint64_t seed) {
    arena.emplace(parameters, settings, radio_settings, seed);
    clock = std::make_unique<ArenaClock>(*arena);
    camera.emplace(*arena, *clock);
    radio.emplace(*arena, *clock);
    gpio.emplace(*arena, *clock);
    EXPECT_TRUE(camera->open().ok() && camera->start().ok() && radio->open().ok() && gpio->open().ok());
    play(3.0, wild_drive);
    EXPECT_GT(arena->channel().statistics().obeyed, 500U);
    return arena->world().hash();
  };
  const std::uint64_t first = hash_after_game(1);
  EXPECT_EQ(hash_after_game(1), first);
  EXPECT_NE(hash_after_game(2), first);
}

TEST_F(ArenaTest, ResultDoesNotDependOnTheTimeSteps) {
  parameters = ArenaParameters{};
  Arena coarse(parameters, settings, radio_settings, 1), fine(parameters, settings, radio_settings, 1);
  for (int i = 1; i <= 50; ++i) {
    coarse.advance_to(Arena::kBegin + i * 20ms);
    for (int k = 0; k < 13; ++k) fine.advance_to(Arena::kBegin + i * 20ms - 19ms + k * 1583us);
    fine.advance_to(Arena::kBegin + i * 20ms);
    ASSERT_EQ(coarse.world().hash(), fine.world().hash()) << i;
  }
  fine.advance_to(Arena::kBegin);
  EXPECT_EQ(fine.now(), Arena::kBegin + 1000ms) << "time must not run backwards";
}

TEST_F(ArenaTest, AllocatesNothingWhileItRuns) {
  if (!latency::allocations_are_counted()) GTEST_SKIP() << "with a sanitizer, allocations are not counted";
  parameters.robot = ArenaParameters{}.robot;
  parameters.physics = {};
  parameters.radio = {};
  int kind = 0;
  for (const auto& choice : kFaultKinds) {
    if (choice.value == FaultKind::kCameraLost || choice.value == FaultKind::kRadioLost) continue;
    add_fault(choice.value, 1.0 + 0.5 * kind++, 0.3);
    if (choice.value == FaultKind::kHideRobot) parameters.fault.back().id = 0;
  }
  add_fault(FaultKind::kCameraLost, 8.0, 0.3);
  add_fault(FaultKind::kRadioLost, 8.5, 0.3);
  for (const CameraFormat format :
       {CameraFormat::kRgb24, CameraFormat::kYuyv, CameraFormat::kNv12, CameraFormat::kI420, CameraFormat::kXrgb8888}) {
    settings.format = format;
    start();
    const std::uint64_t before = latency::allocations_of_this_thread();
    play(9.0, wild_drive);
    static_cast<void>(radio->drain(arena->now() + 100ms));
    static_cast<void>(arena->world().hash());
    camera->stop();
    EXPECT_EQ(latency::allocations_of_this_thread() - before, 0U);
    EXPECT_GT(arena->channel().statistics().sent, 300U);
  }
  const std::uint64_t before = latency::allocations_of_this_thread();
  ASSERT_TRUE(camera->open().ok());
  EXPECT_GT(latency::allocations_of_this_thread() - before, 0U) << "the counter must work";
}

TEST_F(ArenaTest, NoPacketActsBeforeItsArrival) {
  parameters.radio.delay_s = 0.0154;  // plus 13 bytes at 115200 baud: arrives after 16.53 ms
  start();
  ASSERT_TRUE(radio->send(packet_of(std::array<Drive, 1>{{{0, 0.1, 0.1}}}, 1)).ok());
  arena->advance_to(Arena::kBegin + 17ms);
  EXPECT_EQ(arena->world().energy(), 0.0);
  arena->advance_to(Arena::kBegin + 18ms);
  EXPECT_GT(arena->world().energy(), 0.0);
}

TEST_F(ArenaTest, StopPacketsAtTheEndStopTheRobots) {
  parameters.physics.wheel_lag_s = 0.03;
  start();
  play(1.0, [](std::uint8_t sequence) { return packet_of(std::array<Drive, 1>{{{0, -0.2, 0.2}}}, sequence); });
  EXPECT_GT(arena->world().energy(), 1e-4);
  ASSERT_TRUE(radio->send(packet_of(std::array<Drive, 1>{{{0, 0.0, 0.0}}}, 3, true)).ok());
  ASSERT_TRUE(radio->drain(arena->now() + 20ms).ok());
  go_to(1.19);  // before the time-out
  EXPECT_LT(arena->world().energy(), 1e-5);
  EXPECT_EQ(arena->channel().statistics().timeouts, 0U);
}

// With a real device, the arena follows the system clock.
TEST_F(ArenaTest, FollowsTheSystemClock) {
  const MonotonicClock machine;
  arena.emplace(parameters, settings, radio_settings, 1, machine.now());
  MonotonicClock time;
  camera.emplace(*arena, time);
  radio.emplace(*arena, time);
  ASSERT_TRUE(camera->open().ok());
  const Instant begin = machine.now();
  ASSERT_TRUE(camera->start().ok());
  ASSERT_TRUE(radio->open().ok());
  std::uint32_t last = 0;
  int frames = 0;
  while (frames < 20) {
    const auto lease = camera->wait(machine.now() + 20s);
    ASSERT_TRUE(lease.ok());
    const Frame& frame = lease.value().frame();
    EXPECT_LT(frame.capture_time, machine.now());
    EXPECT_GE(seconds(machine.now() - frame.capture_time), 0.002 + 0.007 - 1e-9) << "frame delivered too early";
    EXPECT_TRUE(frames == 0 || frame.sequence > last);
    // The number of late frames depends on the machine; the number of exposures does not.
    EXPECT_NEAR(frame.sequence, seconds(frame.capture_time - begin) * settings.rate_hz, 1.0);
    last = frame.sequence;
    ++frames;
    const auto sent = radio->send(packet_of(std::array<Drive, 1>{{{0, 0.1, 0.1}}}, static_cast<std::uint8_t>(frames)));
    // After the machine was busy, late frames follow each other faster than the line sends packets.
    ASSERT_TRUE(sent.ok() || sent.code() == ErrorCode::kBusy) << sent.text();
  }
  EXPECT_GT(arena->world().energy(), 0.0) << "the packets had no effect";
}

TEST_F(ArenaTest, ARealClockDoesNotJumpToTheDeadline) {
  settings.rate_hz = 1.0;
  MonotonicClock machine;
  arena.emplace(parameters, settings, radio_settings, 1, machine.now());
  camera.emplace(*arena, machine);
  ASSERT_TRUE(camera->open().ok());
  ASSERT_TRUE(camera->start().ok());
  const Instant before = machine.now();
  EXPECT_EQ(camera->wait(before + 5ms).code(), ErrorCode::kTimeout);
  EXPECT_GE(machine.now(), before + 5ms);
}

// A lost device is reopened on its own thread (firmware/device_reconnector.h) while the loop uses the others.
TEST_F(ArenaTest, OneDeviceMayBeOpenedWhileOthersAreUsed) {
  MonotonicClock time;
  arena.emplace(parameters, settings, radio_settings, 1, time.now());
  camera.emplace(*arena, time);
  radio.emplace(*arena, time);
  gpio.emplace(*arena, time);
  ASSERT_TRUE(radio->open().ok());
  ASSERT_TRUE(gpio->open().ok());
  std::atomic<bool> done = false;
  std::atomic<int> opened = 0;
  std::thread keeper([&] {
    while (!done.load()) {
      camera->close();
      if (camera->open().ok() && camera->start().ok()) ++opened;
      if (camera->wait(time.now() + 30ms).ok()) ++opened;
      camera->stop();
    }
  });
  std::uint8_t sequence = 0;
  while (sequence < 100 || opened.load() < 3) {
    EXPECT_TRUE(gpio->inputs(time.now()).ok());
    static_cast<void>(radio->send(packet_of(std::array<Drive, 1>{{{0, 0.1, 0.1}}}, ++sequence)));
    time.sleep_until(time.now() + 2ms);
  }
  done = true;
  keeper.join();
  EXPECT_GT(arena->channel().statistics().obeyed, 10U);
}

TEST_F(ArenaTest, AnObjectIsMovedToWhereThePictureWasPointedAt) {
  parameters.robot = ArenaParameters{}.robot;
  start();
  const auto pixel_of = [&](double x_m, double y_m, double height_m) -> PixelPoint {
    const auto [u, v] = arena->lens().project({x_m, y_m, height_m});
    return {static_cast<float>(u), static_cast<float>(v)};
  };
  const double top_m = parameters.robot_height_m;
  const Placement robot = arena->world().snapshot().robots[2];
  // The robot is held beside its center, so it is put down beside the given position, too.
  ASSERT_TRUE(arena->move_object(pixel_of(robot.x_m + 0.02, robot.y_m, top_m), pixel_of(0.42, 0.7, top_m)).ok());
  Snapshot moved = arena->world().snapshot();
  EXPECT_NEAR(moved.robots[2].x_m, 0.4, 1e-3);
  EXPECT_NEAR(moved.robots[2].y_m, 0.7, 1e-3);
  EXPECT_EQ(moved.robots[2].theta_rad, robot.theta_rad);
  const double ball_m = parameters.ball_radius_m;
  ASSERT_TRUE(arena->move_object(pixel_of(moved.ball.x_m, moved.ball.y_m, ball_m), pixel_of(-0.3, -0.7, ball_m)).ok());
  moved = arena->world().snapshot();
  EXPECT_NEAR(moved.ball.x_m, -0.3, 1e-3);
  EXPECT_NEAR(moved.ball.y_m, -0.7, 1e-3);

  EXPECT_EQ(arena->move_object(pixel_of(-0.9, 0.8, top_m), pixel_of(0, 0, top_m)).code(), ErrorCode::kNotFound);
  EXPECT_EQ(arena->move_object(pixel_of(0.4, 0.7, top_m), pixel_of(-0.3, -0.7, top_m)).code(), ErrorCode::kBusy);
  // Beyond a wall, it stays beside the wall.
  ASSERT_TRUE(arena->move_object(pixel_of(0.4, 0.7, top_m), pixel_of(0.2, 1.5, top_m)).ok());
  EXPECT_LT(arena->world().snapshot().robots[2].y_m, 0.9);
  EXPECT_GT(arena->world().snapshot().robots[2].y_m, 0.8);
}

}  // namespace
}  // namespace touchline::hal::mock
