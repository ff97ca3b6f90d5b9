// Timing and buffers of the arena's camera.
#include "tests/mock/black_field.h"
#include "tests/mock/devices_fixture.h"
#include "tests/results.h"

namespace touchline::hal::mock {
namespace {

using FrameTimes = DevicesTest;

TEST_F(FrameTimes, RateAndSequenceAreKept) {
  for (const double rate_hz : {30.0, 60.0, 90.0}) {
    settings.rate_hz = rate_hz;
    start();
    std::optional<Frame> before;
    Instant first{};
    constexpr int kFrames = 100;
    for (int i = 0; i < kFrames; ++i) {
      const auto lease = wait();
      ASSERT_TRUE(lease.ok());
      const Frame& frame = lease.value().frame();
      if (before) {
        EXPECT_EQ(frame.sequence, before->sequence + 1);
        // The shutter works in steps of a millisecond.
        EXPECT_NEAR(seconds(frame.capture_time - before->capture_time), 1.0 / rate_hz, 0.00101);
      } else {
        first = frame.capture_time;
        EXPECT_EQ(frame.sequence, 0U);
      }
      before = frame;
    }
    EXPECT_NEAR(seconds(before->capture_time - first), (kFrames - 1) / rate_hz, 0.00101) << "no drift";
  }
}

TEST_F(FrameTimes, AFrameArrivesAfterExposureAndTransfer) {
  parameters.sensor.exposure_s = 0.006;
  parameters.sensor.transfer_s = 0.013;
  start();
  for (int i = 0; i < 10; ++i) {
    const auto lease = wait();
    ASSERT_TRUE(lease.ok());
    const double age_s = seconds(arena->now() - lease.value().frame().capture_time);
    EXPECT_GE(age_s, 0.003 + 0.013);
    EXPECT_LE(age_s, 0.003 + 0.013 + 0.003);
  }
}

TEST_F(FrameTimes, NoFrameIsReturnedBeforeItIsInMemory) {
  parameters.sensor.transfer_s = 0.015;
  start();
  const double slice_s = 0.0003;
  for (int i = 0; i < 300; ++i) {
    const auto lease = wait(slice_s);
    if (!lease.ok()) continue;
    EXPECT_GE(seconds(arena->now() - lease.value().frame().capture_time), 0.002 + 0.015 - 1e-9);
  }
}

// A rolling shutter moves the capture time from the middle of all rows' exposures to that of the first row's.
TEST_F(FrameTimes, TheTruthIsThatOfTheCaptureTime) {
  parameters.sensor.exposure_s = 0.012;
  for (const double readout_s : {0.0, 0.02}) {
    parameters.sensor.readout_s = readout_s;
    start();
    Arena twin(parameters, settings, radio_settings, 1);
    for (Arena* const each : {&*arena, &twin}) each->world().place_ball({-0.5, 0.3, 0.0}, {1.0, 0.0});
    go_to(0.1);
    skip_frames();
    const auto lease = wait();
    ASSERT_TRUE(lease.ok());
    const TruePlaces* const truth = lease.value().truth();
    ASSERT_NE(truth, nullptr);
    twin.advance_to(lease.value().frame().capture_time);
    // At 1 m/s; the world has steps of 1 ms.
    EXPECT_NEAR(static_cast<double>(truth->ball.x_m), twin.world().ball().x, 0.0011) << readout_s;
    EXPECT_GT(truth->ball.x_m, -0.49f);
    ASSERT_EQ(truth->robots.size(), parameters.robot.size());
    for (std::size_t i = 0; i < truth->robots.size(); ++i) {
      EXPECT_EQ(truth->robots[i].team == Team::kOwn, parameters.robot[i].team == Side::kOwn);
      EXPECT_EQ(truth->robots[i].id, parameters.robot[i].id);
    }
  }
}

// The position of a robot at constant speed gives the capture time.
TEST_F(FrameTimes, CaptureTimeIsTheMiddleOfTheExposure) {
  parameters = black_field();
  parameters.physics.wheel_lag_s = 0.0;
  parameters.sensor.exposure_s = 0.02;
  parameters.sensor.gamma = 1.0;
  settings.width_px = 640;
  settings.height_px = 480;
  settings.rate_hz = 25.0;
  start();
  arena->world().place(0, {-0.6, 0.1, 0.0});
  arena->world().place_ball({-1.0, 0.8, 0.0});
  arena->world().drive(0, 0.4, 0.4);
  go_to(0.3);
  skip_frames();
  constexpr int kFrames = 10;
  double mean_u = 0, mean_v = 0;
  for (int i = 0; i < kFrames; ++i) {
    const auto lease = wait();
    ASSERT_TRUE(lease.ok());
    const Frame& frame = lease.value().frame();
    std::vector<std::uint16_t> linear(std::size_t{3} * 640 * 480);
    for (std::size_t k = 0; k < linear.size(); ++k) linear[k] = static_cast<std::uint16_t>(frame.plane[0][k]);
    const IntensityMoments moments = intensity_moments(linear, 640, 0);
    const double x_now = arena->world().snapshot().robots[0].x_m;
    const double x_then = x_now - 0.4 * seconds(arena->now() - frame.capture_time);
    const auto [u, v] = arena->lens().project({x_then, 0.1, parameters.robot_height_m});
    EXPECT_NEAR(moments.u, u, 0.15);  // 0.4 m/s are 100 px/s: 1.5 ms
    EXPECT_NEAR(moments.v, v, 0.15);
    mean_u += (moments.u - u) / kFrames;
    mean_v += (moments.v - v) / kFrames;
  }
  EXPECT_NEAR(mean_u, 0, 0.06);
  EXPECT_NEAR(mean_v, 0, 0.03);
}

TEST_F(FrameTimes, InfoAndFrameMatchTheSettings) {
  for (const CameraFormat requested :
       {CameraFormat::kRgb24, CameraFormat::kYuyv, CameraFormat::kNv12, CameraFormat::kI420, CameraFormat::kXrgb8888,
        CameraFormat::kYuvj422p, CameraFormat::kMjpg}) {
    settings.format = requested;
    const PixelFormat format = pixel_format(requested);
    start();
    EXPECT_EQ(camera->info().format, format);
    EXPECT_EQ(camera->info().rate_hz, 50.0);
    const auto lease = wait();
    ASSERT_TRUE(lease.ok());
    const Frame& frame = lease.value().frame();
    const PictureLayout layout = picture_layout(format, 64, 48);
    EXPECT_EQ(frame.format, format);
    EXPECT_EQ(frame.width_px, 64);
    EXPECT_EQ(frame.height_px, 48);
    EXPECT_EQ(frame.stride_bytes, layout.stride_bytes);
    for (std::size_t i = 1; i < kMaxPlanes; ++i) {
      EXPECT_EQ(frame.plane[i], i < info_of(format).planes ? frame.plane[0] + layout.offset_bytes[i] : nullptr);
    }
  }
}

TEST_F(FrameTimes, WaitEndsAtItsDeadline) {
  settings.rate_hz = 2.0;
  start();
  ASSERT_TRUE(wait().ok());
  const double before_s = now_s();
  const auto lease = wait(0.1);
  EXPECT_EQ(lease.code(), ErrorCode::kTimeout);
  EXPECT_NEAR(now_s(), before_s + 0.1, 1e-6);
  EXPECT_EQ(wait(0.0).code(), ErrorCode::kTimeout);
  EXPECT_NEAR(now_s(), before_s + 0.1, 1e-6);
}

TEST_F(FrameTimes, ExposureLongerThanThePeriodReducesTheRate) {
  settings.rate_hz = 100.0;
  parameters.sensor.exposure_s = 0.03;
  start();
  int frames = 0;
  while (now_s() < 3.0) frames += wait().ok() ? 1 : 0;
  EXPECT_NEAR(frames, 3.0 / 0.031, 3.0);
}

TEST_F(FrameTimes, ARollingShutterKeepsTheRateWhileItsReadoutsOverlapExposures) {
  settings.rate_hz = 60.0;
  parameters.sensor.exposure_s = 0.010;
  parameters.sensor.readout_s = 0.014;
  parameters.sensor.transfer_s = 0.003;
  start();
  for (int i = 0; i < 60; ++i) {
    const auto lease = wait();
    ASSERT_TRUE(lease.ok());
    const Frame& frame = lease.value().frame();
    EXPECT_EQ(frame.sequence, static_cast<std::uint32_t>(i));
    // Stamped in the middle of the first row's exposure; the last row ends a readout later.
    const double age_s = seconds(arena->now() - frame.capture_time);
    EXPECT_GE(age_s, 0.005 + 0.014 + 0.003 - 1e-9);
    EXPECT_LE(age_s, 0.005 + 0.014 + 0.003 + 0.003);
  }
}

TEST_F(FrameTimes, AReadoutLongerThanThePeriodReducesTheRate) {
  settings.rate_hz = 100.0;
  parameters.sensor.exposure_s = 0.004;
  parameters.sensor.readout_s = 0.03;
  start();
  int frames = 0;
  while (now_s() < 3.0) frames += wait().ok() ? 1 : 0;
  EXPECT_NEAR(frames, 3.0 / 0.031, 3.0);
}

TEST_F(FrameTimes, FramesWithoutFreeBufferAreLostAndLeaveAGap) {
  settings.buffers = 4;
  start();
  go_to(1.0);  // 50 frames; the first four fill the buffers
  for (std::uint32_t i = 0; i < 4; ++i) {
    const auto lease = wait(0.0);
    ASSERT_TRUE(lease.ok());
    EXPECT_EQ(lease.value().frame().sequence, i);
  }
  EXPECT_EQ(wait(0.0).code(), ErrorCode::kTimeout) << "the others are lost";
  const auto lease = wait();
  ASSERT_TRUE(lease.ok());
  EXPECT_NEAR(lease.value().frame().sequence, 50.0, 1.0);
}

TEST_F(FrameTimes, HeldBuffersAreNotOverwritten) {
  settings.buffers = 3;
  start();
  std::vector<FrameLease> held;
  for (int i = 0; i < 3; ++i) {
    auto lease = wait();
    ASSERT_TRUE(lease.ok());
    held.push_back(std::move(lease).value());
  }
  EXPECT_NE(held[0].frame().plane[0], held[1].frame().plane[0]);
  EXPECT_NE(held[1].frame().plane[0], held[2].frame().plane[0]);
  const auto none = wait(0.5);
  expect_error(none, ErrorCode::kTimeout, "mock camera: all buffers are in use");

  const std::uint8_t* const freed = held[1].frame().plane[0];
  held.erase(held.begin() + 1);
  const auto next = wait();
  ASSERT_TRUE(next.ok());
  EXPECT_EQ(next.value().frame().plane[0], freed);
  EXPECT_GT(next.value().frame().sequence, 20U) << "frames in the meantime are lost";
}

TEST_F(FrameTimes, RestartsAfterAStop) {
  start();
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(wait().ok());
  camera->stop();
  expect_error(wait(0.1), ErrorCode::kIo, "mock camera: used before it was opened and started");
  go_to(2.0);
  ASSERT_TRUE(camera->start().ok());
  const auto lease = wait();
  ASSERT_TRUE(lease.ok());
  EXPECT_EQ(lease.value().frame().sequence, 0U);
  EXPECT_GT(seconds(lease.value().frame().capture_time - Arena::kBegin), 2.0)
      << "no frame may be from before the start";
}

TEST_F(FrameTimes, ClosedDevicesReturnErrors) {
  arena.emplace(parameters, settings, radio_settings, 1);
  ArenaClock time(*arena);
  MockCamera closed_camera(*arena, time);
  MockRadio closed_radio(*arena, time);
  MockGpio closed_gpio(*arena, time);
  EXPECT_EQ(closed_camera.start().code(), ErrorCode::kIo);
  expect_error(closed_camera.wait(arena->now()), ErrorCode::kIo, "mock camera: used before it was opened and started");
  EXPECT_EQ(closed_radio.send(packet_of({}, 1)).code(), ErrorCode::kIo);
  expect_error(closed_radio.drain(arena->now()), ErrorCode::kIo, "mock radio: used before it was opened");
  EXPECT_EQ(closed_gpio.set_status_led(true).code(), ErrorCode::kIo);
  EXPECT_EQ(closed_gpio.set_strobe(true).code(), ErrorCode::kIo);
  expect_error(closed_gpio.inputs(arena->now()), ErrorCode::kIo, "mock gpio: used before it was opened");
}

}  // namespace
}  // namespace touchline::hal::mock
