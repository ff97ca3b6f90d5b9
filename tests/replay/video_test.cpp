#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <filesystem>
#include <thread>
#include <vector>

#include "hal/replay/replay_camera.h"
#include "hal/replay/video_module.h"
#include "hal/replay/video_writer.h"
#include "tests/replay/media.h"
#include "tests/results.h"

namespace touchline {
namespace {

using hal::FrameLease;
using hal::ReplayCamera;
using hal::VideoWriter;

// Writes gray pictures with the values 20, 40, 60, ...
void write_video(const std::string& path, int frames, double rate_hz, std::uint32_t width = 64,
                 std::uint32_t height = 48) {
  VideoWriter writer;
  ASSERT_OK(writer.open(path, width, height, rate_hz));
  for (int i = 0; i < frames; ++i) {
    const std::vector<std::uint8_t> gray(std::size_t{4} * width * height, static_cast<std::uint8_t>(20 * (i + 1)));
    ASSERT_OK(writer.write(gray, std::size_t{4} * width, from_seconds(i / rate_hz)));
  }
  ASSERT_OK(writer.finish());
}

TEST(Video, AWrittenVideoIsReadBack) {
  const media::Folder folder;
  write_video(folder / "a.mp4", 10, 25.0);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << "no temporary file is left";
  ReplayCamera camera({.path = folder / "a.mp4"});
  ASSERT_OK(camera.open());
  EXPECT_EQ(camera.info().width_px, 64);
  EXPECT_EQ(camera.frame_count(), 10u);
  EXPECT_NEAR(camera.info().rate_hz, 25.0, 0.01);
  ASSERT_TRUE(camera.start().ok());
  for (int i = 0; i < 10; ++i) {
    const Result<FrameLease> lease = camera.wait(Instant::max());
    ASSERT_TRUE(lease.ok()) << lease.text();
    const Frame& frame = lease.value().frame();
    EXPECT_EQ(camera.file(), "a.mp4");
    EXPECT_NEAR(seconds(frame.capture_time.time_since_epoch()), i * 0.04, 1e-6);
    EXPECT_NEAR(frame.plane[0][frame.stride_bytes[0] * 24 + 96], 20 * (i + 1), 3) << "frame " << i;
  }
  EXPECT_EQ(camera.wait(Instant::max()).code(), ErrorCode::kEndOfStream);
}

TEST(Video, UnevenTimeStampsAreKept) {
  const media::Folder folder;
  VideoWriter writer;
  ASSERT_TRUE(writer.open(folder / "a.mp4", 32, 32, 30.0).ok());
  const std::vector<std::uint8_t> gray(32 * 32 * 4, 90);
  const std::vector<double> stamps{0.0, 0.03, 0.07, 0.19};
  for (const double stamp : stamps) ASSERT_TRUE(writer.write(gray, 128, from_seconds(stamp)).ok());
  ASSERT_TRUE(writer.finish().ok());
  ReplayCamera camera({.path = folder / "a.mp4"});
  ASSERT_TRUE(camera.open().ok() && camera.start().ok());
  for (const double stamp : stamps) {
    const Result<FrameLease> lease = camera.wait(Instant::max());
    ASSERT_TRUE(lease.ok()) << lease.text();
    EXPECT_NEAR(seconds(lease.value().frame().capture_time.time_since_epoch()), stamp, 2e-5);
  }
  // A requested rate replaces the time stamps.
  ReplayCamera forced({.path = folder / "a.mp4", .format = PixelFormat::kRgb24, .rate_hz = 50.0});
  ASSERT_TRUE(forced.open().ok() && forced.start().ok());
  for (int i = 0; i < 4; ++i) {
    const Result<FrameLease> lease = forced.wait(Instant::max());
    ASSERT_TRUE(lease.ok());
    EXPECT_EQ(lease.value().frame().capture_time, Instant(from_seconds(i * 0.02)));
  }
}

// Planes Y of 6 x 4, U and V of 3 x 2 pixels, with values that depend on the position.
std::vector<std::uint8_t> planes_420() {
  std::vector<std::uint8_t> planes;
  for (std::uint8_t i = 0; i < 24; ++i) planes.push_back(static_cast<std::uint8_t>(16 + 9 * i));
  for (std::uint8_t i = 0; i < 6; ++i) planes.push_back(static_cast<std::uint8_t>(60 + i));
  for (std::uint8_t i = 0; i < 6; ++i) planes.push_back(static_cast<std::uint8_t>(180 + i));
  return planes;
}

TEST(Video, YuvIsReadAsItIsStored) {
  const media::Folder folder;
  const std::vector<std::uint8_t> planes = planes_420();
  for (const char* header : {"F25:1 C420mpeg2 XCOLORRANGE=LIMITED", "F25:1 C420jpeg XCOLORRANGE=FULL"}) {
    media::write_y4m(folder / "a.y4m", 6, 4, header, {planes});
    for (const PixelFormat format : {PixelFormat::kNv12, PixelFormat::kI420, PixelFormat::kYuyv, PixelFormat::kUyvy}) {
      ReplayCamera camera({.path = folder / "a.y4m", .format = format});
      ASSERT_TRUE(camera.open().ok() && camera.start().ok());
      const Result<FrameLease> lease = camera.wait(Instant::max());
      ASSERT_TRUE(lease.ok()) << lease.text();
      const Frame& frame = lease.value().frame();
      for (std::size_t y = 0; y < 4; ++y) {
        for (std::size_t x = 0; x < 6; ++x) {
          const std::uint8_t* row = frame.plane[0] + y * frame.stride_bytes[0];
          std::uint8_t luma = 0, u = 0, v = 0;
          if (format == PixelFormat::kNv12) {
            const std::uint8_t* chroma = frame.plane[1] + (y / 2) * frame.stride_bytes[1];
            luma = row[x], u = chroma[x / 2 * 2], v = chroma[x / 2 * 2 + 1];
          } else if (format == PixelFormat::kI420) {
            luma = row[x], u = frame.plane[1][y / 2 * frame.stride_bytes[1] + x / 2];
            v = frame.plane[2][y / 2 * frame.stride_bytes[2] + x / 2];
          } else {
            const std::size_t first_luma = format == PixelFormat::kYuyv ? 0 : 1;
            luma = row[2 * x + first_luma], u = row[x / 2 * 4 + 1 - first_luma], v = row[x / 2 * 4 + 3 - first_luma];
          }
          EXPECT_EQ(luma, planes[y * 6 + x]);
          EXPECT_EQ(u, planes[24 + y / 2 * 3 + x / 2]);
          EXPECT_EQ(v, planes[30 + y / 2 * 3 + x / 2]);
        }
      }
    }
  }
}

// ITU-R BT.601: gray of luma 126 is (126 - 16) * 255 / 219 = 128 in limited and 126 in full range.
TEST(Video, TheColorRangeOfTheFileIsUsed) {
  const media::Folder folder;
  std::vector<std::uint8_t> gray(16 * 16, 126);
  gray.resize(16 * 16 * 3 / 2, 128);
  const auto value = [&](const std::string& header) {
    media::write_y4m(folder / "a.y4m", 16, 16, header, {gray});
    ReplayCamera camera({.path = folder / "a.y4m"});
    EXPECT_TRUE(camera.open().ok() && camera.start().ok());
    const Result<FrameLease> lease = camera.wait(Instant::max());
    return lease.ok() ? static_cast<int>(lease.value().frame().plane[0][0]) : -1;
  };
  EXPECT_EQ(value("F30:1 C420mpeg2"), 128);
  EXPECT_EQ(value("F30:1 C420mpeg2 XCOLORRANGE=FULL"), 126);
}

// Limited luma 126 is 128 in full range, and chroma 152 is 128 + 24 * 255 / 224.
TEST(Video, AFormatOfFullRangeGetsFullRangeFromEveryFile) {
  const media::Folder folder;
  std::vector<std::uint8_t> gray(16 * 16, 126);
  gray.resize(16 * 16 * 3 / 2, 152);
  for (const auto& [header, luma, chroma] :
       {std::tuple{"F30:1 C420mpeg2", 128, 155}, {"F30:1 C420mpeg2 XCOLORRANGE=FULL", 126, 152}}) {
    media::write_y4m(folder / "a.y4m", 16, 16, header, {gray});
    ReplayCamera camera({.path = folder / "a.y4m", .format = PixelFormat::kYuvj422p});
    ASSERT_TRUE(camera.open().ok() && camera.start().ok());
    const Result<FrameLease> lease = camera.wait(Instant::max());
    ASSERT_TRUE(lease.ok()) << lease.text();
    const Frame& frame = lease.value().frame();
    EXPECT_NEAR(frame.plane[0][0], luma, 1) << header;
    EXPECT_NEAR(frame.plane[1][15 * frame.stride_bytes[1]], chroma, 1) << header;
    EXPECT_NEAR(frame.plane[2][15 * frame.stride_bytes[2] + 7], chroma, 1) << header;
  }
}

// A step in chroma must not move: the centroids of patches depend on it.
TEST(Video, ChromaIsInterpolatedInPlace) {
  const media::Folder folder;
  std::vector<std::uint8_t> planes(32 * 32, 126);
  for (int plane = 0; plane < 2; ++plane) {
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) planes.push_back(plane == 1 && x >= 8 ? 200 : 128);
    }
  }
  // Position in pixels where red is halfway between both sides: chroma sample 8 is at pixel 16 (mpeg2) or 16.5 (jpeg).
  const auto step = [&](const std::string& header) {
    media::write_y4m(folder / "a.y4m", 32, 32, header, {planes});
    ReplayCamera camera({.path = folder / "a.y4m"});
    EXPECT_TRUE(camera.open().ok() && camera.start().ok());
    const Result<FrameLease> lease = camera.wait(Instant::max());
    if (!lease.ok()) return -1.0;
    const std::uint8_t* row = lease.value().frame().plane[0] + 16 * lease.value().frame().stride_bytes[0];
    const double half = (row[0] + row[31 * 3]) / 2.0;
    std::size_t x = 0;
    while (x < 31 && row[3 * x] < half) ++x;
    return static_cast<double>(x) - (row[3 * x] - half) / (row[3 * x] - row[3 * (x - 1)]);
  };
  EXPECT_NEAR(step("F30:1 C420mpeg2"), 15.0, 0.15);
  EXPECT_NEAR(step("F30:1 C420jpeg"), 15.5, 0.15);
}

TEST(Video, ATruncatedVideoIsReported) {
  const media::Folder folder;
  write_video(folder / "whole.mp4", 10, 25.0);
  const std::vector<std::uint8_t> whole = media::read_bytes(folder / "whole.mp4");
  // The index is at the end; without it nothing can be played.
  media::write_bytes(folder / "cut.mp4", std::span(whole).first(whole.size() / 2));
  ReplayCamera camera({.path = folder / "cut.mp4"});
  testing::internal::CaptureStderr();
  const std::string camera_error = camera.open().text();
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_NE(camera_error.find("cut.mp4"), std::string::npos) << camera_error;

  // The third frame's header is damaged: the rest cannot be read, which must not look like the end of the video.
  const std::vector<std::uint8_t> gray(64 * 64 * 3 / 2, 128);
  media::write_y4m(folder / "b.y4m", 64, 64, "F30:1 C420mpeg2", {gray, gray, gray});
  std::vector<std::uint8_t> raw = media::read_bytes(folder / "b.y4m");
  raw[raw.size() - gray.size() - 6] = 'X';
  media::write_bytes(folder / "b.y4m", raw);
  ReplayCamera damaged({.path = folder / "b.y4m"});
  ASSERT_TRUE(damaged.open().ok() && damaged.start().ok());
  EXPECT_TRUE(damaged.wait(Instant::max()).ok());
  EXPECT_TRUE(damaged.wait(Instant::max()).ok());
  const Result<FrameLease> lost = damaged.wait(Instant::max());
  EXPECT_EQ(lost.code(), ErrorCode::kIo);
  EXPECT_NE(lost.text().find("b.y4m: ends early, after frame 2"), std::string::npos) << lost.text();
}

TEST(Video, AVideoWithoutFramesIsAnError) {
  const media::Folder folder;
  write_video(folder / "none.mp4", 0, 25.0);
  ReplayCamera camera({.path = folder / "none.mp4"});
  const std::string camera_error = camera.open().text();
  EXPECT_NE(camera_error.find("none.mp4"), std::string::npos) << camera_error;
  media::write_y4m(folder / "none.y4m", 16, 16, "F30:1 C420mpeg2", {});
  ReplayCamera other({.path = folder / "none.y4m"});
  const std::string other_error = other.open().text();
  EXPECT_NE(other_error.find("none.y4m"), std::string::npos) << other_error;
}

TEST(Video, WithoutTheModuleTheMissingPackageIsNamed) {
  const Result<std::unique_ptr<hal::ReplaySource>> none =
      hal::make_video_source("match.mp4", 0.0, PixelFormat::kRgb24, "touchline-no-such-module.so");
  EXPECT_EQ(none.code(), ErrorCode::kUnsupported);
  EXPECT_NE(none.text().find("sudo apt install touchline-tools (touchline-no-such-module.so: "), std::string::npos)
      << none.text();
}

TEST(VideoWriter, AFifoGetsAVideoThatNeedsNoSeeking) {
  const media::Folder folder;
  ASSERT_EQ(::mkfifo((folder / "fifo.mp4").c_str(), 0600), 0);
  std::vector<std::uint8_t> received;
  std::thread reader([&] { received = media::read_bytes(folder / "fifo.mp4"); });
  write_video(folder / "fifo.mp4", 10, 25.0);
  if (!std::filesystem::is_fifo(folder / "fifo.mp4")) {
    reader.detach();
    FAIL() << "the FIFO was replaced by a regular file";
  }
  reader.join();
  media::write_bytes(folder / "received.mp4", received);
  ReplayCamera camera({.path = folder / "received.mp4"});
  ASSERT_TRUE(camera.open().ok() && camera.start().ok());
  for (int i = 0; i < 10; ++i) EXPECT_OK(camera.wait(Instant::max()));
  EXPECT_EQ(camera.wait(Instant::max()).code(), ErrorCode::kEndOfStream);
}

TEST(VideoWriter, LeavesNoIncompleteFile) {
  const media::Folder folder;
  {
    VideoWriter writer;
    ASSERT_TRUE(writer.open(folder / "a.mp4", 32, 32, 30.0).ok());
    const std::vector<std::uint8_t> gray(32 * 32 * 4, 90);
    ASSERT_TRUE(writer.write(gray, 128, Duration{}).ok());
    EXPECT_EQ(writer.write(std::span(gray).first(100), 128, Duration{1}).code(), ErrorCode::kOutOfRange);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  VideoWriter writer;
  EXPECT_EQ(writer.open(folder / "odd.mp4", 33, 32, 30.0).code(), ErrorCode::kOutOfRange);
  const Result<void> opened = writer.open(folder / "none/a.mp4", 32, 32, 30.0);
  EXPECT_EQ(opened.code(), ErrorCode::kNotFound);
  EXPECT_NE(opened.text().find("none/a.mp4"), std::string::npos) << opened.text();
  EXPECT_EQ(writer.finish().code(), ErrorCode::kIo);
}

}  // namespace
}  // namespace touchline
