// Which camera touchline-devices --judge takes, in which mode, and the measurement of a V4L2 camera.
#include "tools/programs/devices/judge/camera_choice.h"
#include "firmware/device_list/suggestion.h"

#include "hal/linux/monotonic_clock.h"
#include "tests/linux/v4l2_fixture.h"
#include "tools/programs/devices/judge/judge_text.h"

namespace touchline::testing {
namespace {

using devices::choose_camera;
using devices::choose_mode;

class CameraChoiceTest : public V4l2Test {};

hal::V4l2FormatInfo offer(const std::string& word, std::uint32_t width, std::uint32_t height,
                          std::vector<double> rates_hz) {
  hal::V4l2FormatInfo format;
  format.word = word;
  format.sizes = {{width, height, width, height, std::move(rates_hz), false}};
  return format;
}

std::string mode_of(const std::vector<hal::V4l2FormatInfo>& offers) {
  hal::CameraSettings settings;
  if (!choose_mode(offers, settings)) return "none";
  return std::string(hal::kCameraFormats[static_cast<std::size_t>(settings.format)].word) + " " +
         hal::size_text(settings.width_px, settings.height_px) + " " + std::to_string(std::lround(settings.rate_hz));
}

TEST_F(CameraChoiceTest, TheModeIsThatOfAGame) {
  EXPECT_EQ(mode_of({offer("yuyv", 640, 480, {30}), offer("mjpg", 1280, 720, {60, 30})}), "mjpg 1280x720 60");
  EXPECT_EQ(mode_of({offer("mjpg", 640, 480, {60}), offer("yuyv", 640, 480, {60})}), "yuyv 640x480 60");
  EXPECT_EQ(mode_of({offer("yuyv", 320, 240, {120, 60}), offer("yuyv", 640, 480, {60})}), "yuyv 640x480 60");
  EXPECT_EQ(mode_of({offer("yuyv", 1920, 1080, {60}), offer("yuyv", 640, 480, {30})}), "yuyv 640x480 30");
  EXPECT_EQ(mode_of({offer("yuyv", 1920, 1080, {60})}), "yuyv 1920x1080 60");
  EXPECT_EQ(mode_of({offer("", 640, 480, {60})}), "none") << "a format that Touchline does not read";
}

TEST_F(CameraChoiceTest, ModesAreRead) {
  hal::CameraSettings settings;
  ASSERT_OK(devices::parse_mode("mjpg,1280x720,59.94", settings));
  EXPECT_EQ(settings.format, hal::CameraFormat::kMjpg);
  EXPECT_EQ(settings.width_px, 1280);
  EXPECT_EQ(settings.height_px, 720);
  EXPECT_EQ(settings.rate_hz, 59.94);
  for (const char* wrong : {"", "mjpg", "h264,640x480,30", "mjpg,640x480", "mjpg,640x480,0", "mjpg,640x480,30x"}) {
    EXPECT_EQ(devices::parse_mode(wrong, settings).code(), ErrorCode::kInconsistent) << wrong;
  }
}

TEST_F(CameraChoiceTest, WithoutANameTheFirstOneThatDeliversPictures) {
  const Result<hal::CameraSettings> settings = choose_camera("", "");
  ASSERT_TRUE(settings.ok()) << settings.text();
  EXPECT_EQ(settings.value().backend, hal::CameraBackend::kV4l2);
  EXPECT_EQ(settings.value().device, "/dev/video0");
  EXPECT_EQ(settings.value().rate_hz, 60.0);
  device_.formats = {{V4L2_PIX_FMT_SBGGR10, {{640, 480}}, false}};
  const Result<hal::CameraSettings> raw = choose_camera("", "");
  EXPECT_EQ(raw.code(), ErrorCode::kNotFound);
  EXPECT_NE(
      raw.text().find("/dev/video0: no format that Touchline supports; unsupported: BG10. A sensor on a ribbon cable"),
      std::string::npos)
      << raw.text();
}

TEST_F(CameraChoiceTest, AMissingOrRefusedCameraIsNamed) {
  EXPECT_NE(choose_camera("/dev/video7", "").text().find("/dev/video7: no such camera; here: /dev/video0"),
            std::string::npos);
  EXPECT_NE(choose_camera("imx296", "").text().find("imx296: no such camera"), std::string::npos);
}

TEST_F(CameraChoiceTest, ACameraOfTheKernelIsJudged) {
  const Result<hal::CameraSettings> settings = choose_camera("/dev/video0", "yuyv,640x480,60");
  ASSERT_TRUE(settings.ok()) << settings.text();
  device_.frame_faults[150].dropped = true;
  hal::V4l2Camera camera(settings.value());
  hal::MonotonicClock clock;
  const Result<devices::JudgeReport> report =
      devices::judge(camera, clock, settings.value(), {.still_s = 3.0, .motion_s = 0.0}, {});
  ASSERT_TRUE(report.ok()) << report.text();
  const devices::TimingReport& timing = report.value().timing;
  EXPECT_NEAR(timing.delivered_hz, 60.0, 1.0);
  EXPECT_EQ(timing.lost, 1u);
  EXPECT_LT(timing.jitter_s, 0.0001);
  EXPECT_TRUE(timing.increasing);
  EXPECT_NE(devices::figures(report.value()).find("time stamps   of the start of exposure, monotonic"),
            std::string::npos)
      << devices::figures(report.value());
  EXPECT_EQ(report.value().exposures.size(), 5u);
}

}  // namespace
}  // namespace touchline::testing
