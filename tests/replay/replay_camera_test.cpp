#include "hal/replay/replay_camera.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/replay/media.h"
#include "tests/results.h"

namespace touchline {
namespace {

using hal::FrameLease;
using hal::ReplayCamera;

std::vector<std::uint8_t> pixels(const Frame& frame, std::size_t bytes_per_row) {
  std::vector<std::uint8_t> all;
  for (std::size_t y = 0; y < frame.height_px; ++y) {
    const std::uint8_t* row = frame.plane[0] + y * frame.stride_bytes[0];
    all.insert(all.end(), row, row + bytes_per_row);
  }
  return all;
}

// Opens an input that must be refused, and returns the message.
std::string camera_refusal(const std::string& path, ErrorCode expected) {
  ReplayCamera camera({.path = path});
  testing::internal::CaptureStderr();
  const Result<void> opened = camera.open();
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(opened.code(), expected) << opened.text();
  EXPECT_NE(opened.text().find(path), std::string::npos) << "the message must name the input: " << opened.text();
  return opened.text();
}

TEST(ReplayCamera, PicturesAreReadInNaturalOrderWithTheirTimeStamps) {
  const media::Folder folder;
  const std::vector<std::string> names{"shot2.png", "shot9.PNG", "shot10.png", "shot010b.png"};
  for (std::uint32_t i = 0; i < names.size(); ++i) media::write_png(folder / names[i], media::colorful(7, 5, i));
  media::write_text(folder / "truth.jsonl", "{}");
  std::filesystem::create_directory(folder / "more.png");

  ReplayCamera camera({.path = folder.path(), .format = PixelFormat::kRgb24, .rate_hz = 8.0});
  ASSERT_OK(camera.open());
  EXPECT_EQ(camera.info().width_px, 7);
  EXPECT_EQ(camera.info().height_px, 5);
  EXPECT_EQ(camera.info().rate_hz, 8.0);
  EXPECT_EQ(camera.frame_count(), 4u);
  ASSERT_TRUE(camera.start().ok());
  for (std::uint32_t i = 0; i < names.size(); ++i) {
    const Result<FrameLease> lease = camera.wait(Instant::max());
    ASSERT_TRUE(lease.ok()) << lease.text();
    const Frame& frame = lease.value().frame();
    EXPECT_EQ(camera.file(), names[i]);
    EXPECT_EQ(frame.sequence, i);
    EXPECT_EQ(frame.capture_time, Instant(from_seconds(i * 0.125)));
    EXPECT_EQ(pixels(frame, 21), media::colorful(7, 5, i).rgb8);
    EXPECT_EQ(hal::ReplayClock(camera).now(), frame.capture_time);
  }
  EXPECT_EQ(camera.wait(Instant::max()).code(), ErrorCode::kEndOfStream);
  EXPECT_EQ(camera.wait(Instant::max()).code(), ErrorCode::kEndOfStream);
}

TEST(ReplayCamera, StartsOverAfterReopening) {
  const media::Folder folder;
  for (std::uint32_t i = 0; i < 2; ++i) {
    media::write_png(folder / (std::to_string(i) + ".png"), media::colorful(8, 8, i));
  }
  ReplayCamera camera({.path = folder.path()});
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE(camera.open().ok());
    ASSERT_TRUE(camera.start().ok());
    for (std::uint32_t i = 0; i < 2; ++i) {
      const Result<FrameLease> lease = camera.wait(Instant::max());
      ASSERT_TRUE(lease.ok());
      EXPECT_EQ(lease.value().frame().sequence, i);
    }
    EXPECT_EQ(camera.wait(Instant::max()).code(), ErrorCode::kEndOfStream);
    camera.stop();
    camera.close();
  }
}

TEST(ReplayCamera, APictureIsConvertedToEveryFormat) {
  const media::Folder folder;
  hal::Picture picture{3, 2, {}, {}};  // odd width: the last pair has one pixel
  for (int i = 0; i < 6; ++i) picture.rgb8.insert(picture.rgb8.end(), {255, 0, 0});
  media::write_png(folder / "red.png", picture);
  const auto first_frame = [&folder](PixelFormat format, auto check) {
    ReplayCamera camera({.path = folder / "red.png", .format = format});
    ASSERT_TRUE(camera.open().ok() && camera.start().ok());
    const Result<FrameLease> lease = camera.wait(Instant::max());
    ASSERT_TRUE(lease.ok()) << lease.text();
    EXPECT_EQ(lease.value().frame().format, format);
    check(lease.value().frame());
  };
  first_frame(PixelFormat::kBgr24, [](const Frame& frame) {
    EXPECT_EQ(pixels(frame, 6), (std::vector<std::uint8_t>{0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255}));
  });
  first_frame(PixelFormat::kXrgb8888, [](const Frame& frame) {
    const std::vector<std::uint8_t> bytes = pixels(frame, 12);
    ASSERT_EQ(bytes.size(), 24u);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      if (i % 4 == 3) continue;  // the unused byte
      EXPECT_EQ(bytes[i], i % 4 == 2 ? 255 : 0) << "byte " << i;
    }
  });
  // ITU-R BT.601, limited range: pure red is Y 81, U 90, V 240.
  const auto near = [](const std::vector<std::uint8_t>& bytes, const std::vector<int>& expected) {
    ASSERT_EQ(bytes.size(), expected.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) EXPECT_NEAR(bytes[i], expected[i], 1) << "byte " << i;
  };
  first_frame(PixelFormat::kYuyv, [&near](const Frame& frame) {
    EXPECT_GE(frame.stride_bytes[0], 8u);
    near(pixels(frame, 8), {81, 90, 81, 240, 81, 90, 81, 240, 81, 90, 81, 240, 81, 90, 81, 240});
  });
  first_frame(PixelFormat::kUyvy, [&near](const Frame& frame) {
    near(pixels(frame, 8), {90, 81, 240, 81, 90, 81, 240, 81, 90, 81, 240, 81, 90, 81, 240, 81});
  });
  first_frame(PixelFormat::kNv12, [&near](const Frame& frame) {
    near(pixels(frame, 3), {81, 81, 81, 81, 81, 81});
    near({frame.plane[1], frame.plane[1] + 4}, {90, 240, 90, 240});
  });
  first_frame(PixelFormat::kI420, [&near](const Frame& frame) {
    near(pixels(frame, 3), {81, 81, 81, 81, 81, 81});
    near({frame.plane[1], frame.plane[1] + 2}, {90, 90});
    near({frame.plane[2], frame.plane[2] + 2}, {240, 240});
  });
  // Full range: Y 76, U 85, V 255.
  first_frame(PixelFormat::kYuvj422p, [&near](const Frame& frame) {
    near(pixels(frame, 3), {76, 76, 76, 76, 76, 76});
    for (std::size_t row = 0; row < 2; ++row) {
      const std::uint8_t* const u = frame.plane[1] + row * frame.stride_bytes[1];
      const std::uint8_t* const v = frame.plane[2] + row * frame.stride_bytes[2];
      near({u, u + 2}, {85, 85});
      near({v, v + 2}, {255, 255});
    }
  });
}

// Blocks of 2 x 2 pixels share a color, so chroma of 4:2:0 and 4:2:2 is exact but for the quantization.
TEST(ReplayCamera, AJpegKeepsItsYuvSamples) {
  const media::Folder folder;
  hal::Picture blocks{32, 32, std::vector<std::uint8_t>(std::size_t{3} * 32 * 32), {}};
  for (std::size_t i = 0; i < blocks.rgb8.size(); ++i) {
    const std::size_t pixel = i / 3, v = pixel / 32 / 8, u = pixel % 32 / 8;
    blocks.rgb8[i] = static_cast<std::uint8_t>(60 + 20 * ((3 * v + u + 2 * (i % 3)) % 7));
  }
  for (const media::JpegKind kind : {media::JpegKind::k420, media::JpegKind::k422, media::JpegKind::kProgressive}) {
    media::write_jpeg(folder / "a.jpg", blocks, kind);
    const auto sample = [&](PixelFormat format) {
      ReplayCamera camera({.path = folder / "a.jpg", .format = format});
      EXPECT_TRUE(camera.open().ok() && camera.start().ok());
      const Result<FrameLease> lease = camera.wait(Instant::max());
      EXPECT_TRUE(lease.ok()) << lease.text();
      std::vector<std::array<std::uint8_t, 3>> all;
      for (std::size_t v = 0; lease.ok() && v < 32; ++v) {
        for (std::size_t u = 0; u < 32; ++u) {
          std::array<std::uint8_t, 3> value{};
          for (std::size_t c = 0; c < 3; ++c) {
            const Frame& frame = lease.value().frame();
            const ChannelLayout& channel = info_of(format).channel[c];
            value[c] =
                frame
                    .plane[channel.plane][(v >> channel.shift_v) * frame.stride_bytes[channel.plane] + channel.byte(u)];
          }
          all.push_back(value);
        }
      }
      return all;
    };
    const auto planar = sample(PixelFormat::kYuvj422p);
    // The range of a file is kept, so all YUV formats have the same samples.
    for (const PixelFormat format : {PixelFormat::kYuyv, PixelFormat::kUyvy}) EXPECT_EQ(sample(format), planar);
    if (kind != media::JpegKind::k422) {
      EXPECT_EQ(sample(PixelFormat::kNv12), planar);
      EXPECT_EQ(sample(PixelFormat::kI420), planar);
    }
    ASSERT_EQ(planar.size(), 32u * 32u);
    for (std::size_t i = 0; i < planar.size(); ++i) {
      const std::array<std::uint8_t, 3> rgb = to_rgb8(planar[i], ColorSpace::kYuvFullRange);
      for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(rgb[c], blocks.rgb8[3 * i + c], 12) << i;
    }
  }
}

TEST(ReplayCamera, PixelsThatShareChromaGetItsMean) {
  const media::Folder folder;
  media::write_png(folder / "a.png",
                   {4, 2, {0, 0, 0, 0, 0, 240, 0, 0, 80, 0, 0, 80, 0, 0, 120, 0, 0, 0, 0, 0, 80, 0, 0, 160}, {}});
  const auto u_of = [&](PixelFormat format, std::size_t row) {
    ReplayCamera camera({.path = folder / "a.png", .format = format});
    EXPECT_TRUE(camera.open().ok() && camera.start().ok());
    const Result<FrameLease> lease = camera.wait(Instant::max());
    if (!lease.ok()) return std::vector<int>();
    const std::uint8_t* const u = lease.value().frame().plane[1] + row * lease.value().frame().stride_bytes[1];
    return std::vector<int>{u[0], u[1]};
  };
  // U of full range is 128 + B / 2; of limited range 128 + B * 112 / 255.
  EXPECT_EQ(u_of(PixelFormat::kYuvj422p, 0), (std::vector<int>{188, 168}));
  EXPECT_EQ(u_of(PixelFormat::kYuvj422p, 1), (std::vector<int>{158, 188}));
  EXPECT_EQ(u_of(PixelFormat::kI420, 0), (std::vector<int>{168, 172}));
}

TEST(ReplayCamera, SixteenBitPicturesAreRoundedToEight) {
  const media::Folder folder;
  media::write_png(folder / "deep.png", {2, 1, {}, {0, 128, 129, 32896, 65535, 257}});
  ReplayCamera camera({.path = folder.path()});
  ASSERT_TRUE(camera.open().ok() && camera.start().ok());
  const Result<FrameLease> lease = camera.wait(Instant::max());
  ASSERT_TRUE(lease.ok());
  EXPECT_EQ(pixels(lease.value().frame(), 6), (std::vector<std::uint8_t>{0, 0, 1, 128, 255, 1}));
}

TEST(ReplayCamera, InputsThatCannotBeOpenedAreReported) {
  const media::Folder folder;
  camera_refusal(folder / "missing", ErrorCode::kNotFound);
  EXPECT_NE(camera_refusal(folder.path(), ErrorCode::kNotFound).find("no picture"), std::string::npos);
  media::write_text(folder / "empty.mp4", "");
  camera_refusal(folder / "empty.mp4", ErrorCode::kUnsupported);
  media::write_text(folder / "notes.txt", "not a video\n");
  camera_refusal(folder / "notes.txt", ErrorCode::kUnsupported);
  media::write_text(folder / "http:x.mp4", "");
  camera_refusal(folder / "http:x.mp4", ErrorCode::kUnsupported);
  media::write_png(folder / "huge.png", media::colorful(2600, 2));
  EXPECT_NE(camera_refusal(folder / "huge.png", ErrorCode::kUnsupported).find("2600 x 2"), std::string::npos);
}

TEST(ReplayCamera, APictureOfAnotherSizeIsAnError) {
  const media::Folder folder;
  media::write_png(folder / "1.png", media::colorful(8, 8));
  media::write_png(folder / "2.png", media::colorful(8, 6));
  ReplayCamera camera({.path = folder.path()});
  ASSERT_TRUE(camera.open().ok() && camera.start().ok());
  ASSERT_TRUE(camera.wait(Instant::max()).ok());
  const Result<FrameLease> lost = camera.wait(Instant::max());
  EXPECT_EQ(lost.code(), ErrorCode::kInconsistent);
  EXPECT_NE(lost.text().find("2.png is 8 x 6, but 1.png is 8 x 8"), std::string::npos) << lost.text();
}

TEST(ReplayCamera, ADamagedPictureIsALostFrame) {
  const media::Folder folder;
  media::write_png(folder / "1.png", media::colorful(8, 8));
  media::write_png(folder / "3.png", media::colorful(8, 8));
  const std::vector<std::uint8_t> whole = media::read_bytes(folder / "1.png");
  media::write_bytes(folder / "2.png", std::span(whole).first(whole.size() / 2));
  ReplayCamera camera({.path = folder.path(), .format = PixelFormat::kRgb24, .rate_hz = 10.0});
  ASSERT_TRUE(camera.open().ok() && camera.start().ok());
  ASSERT_TRUE(camera.wait(Instant::max()).ok());
  const Result<FrameLease> lost = camera.wait(Instant::max());
  EXPECT_EQ(lost.code(), ErrorCode::kCorruptFrame);
  EXPECT_NE(lost.text().find("2.png"), std::string::npos) << lost.text();
  const Result<FrameLease> next = camera.wait(Instant::max());
  ASSERT_TRUE(next.ok());
  EXPECT_EQ(camera.file(), "3.png");
  EXPECT_EQ(next.value().frame().sequence, 2u);
  EXPECT_EQ(next.value().frame().capture_time, Instant(from_seconds(0.2)));
}

TEST(ReplayCamera, ALeaseKeepsItsBuffer) {
  const media::Folder folder;
  for (std::uint32_t i = 0; i < 5; ++i) {
    media::write_png(folder / (std::to_string(i) + ".png"), media::colorful(8, 8, i));
  }
  ReplayCamera camera({.path = folder.path()});
  ASSERT_TRUE(camera.open().ok() && camera.start().ok());
  Result<FrameLease> a = camera.wait(Instant::max()), b = camera.wait(Instant::max()), c = camera.wait(Instant::max());
  ASSERT_TRUE(a.ok() && b.ok() && c.ok());
  EXPECT_EQ(camera.wait(Instant::max()).code(), ErrorCode::kBusy);
  b.value() = FrameLease();
  EXPECT_TRUE(camera.wait(Instant::max()).ok());
  EXPECT_EQ(pixels(a.value().frame(), 24), media::colorful(8, 8, 0).rgb8);
  EXPECT_EQ(pixels(c.value().frame(), 24), media::colorful(8, 8, 2).rgb8);
}

class ManualClock final : public hal::Clock {
 public:
  [[nodiscard]] Instant now() const override { return now_; }
  void sleep_until(Instant instant) override { now_ = std::max(now_, instant); }
  Instant now_{from_seconds(100.0)};
};

TEST(ReplayCamera, WithAClockFramesArriveInRealTime) {
  const media::Folder folder;
  for (std::uint32_t i = 0; i < 2; ++i) {
    media::write_png(folder / (std::to_string(i) + ".png"), media::colorful(8, 8, i));
  }
  ManualClock clock;
  ReplayCamera camera({.path = folder.path(), .format = PixelFormat::kRgb24, .rate_hz = 10.0}, &clock);
  ASSERT_TRUE(camera.open().ok() && camera.start().ok());
  ASSERT_TRUE(camera.wait(clock.now_).ok());
  EXPECT_EQ(camera.wait(clock.now_ + from_seconds(0.04)).code(), ErrorCode::kTimeout);
  EXPECT_EQ(clock.now_, Instant(from_seconds(100.04)));
  const Result<FrameLease> lease = camera.wait(clock.now_ + from_seconds(1.0));
  ASSERT_TRUE(lease.ok());
  EXPECT_EQ(clock.now_, Instant(from_seconds(100.1)));
  EXPECT_EQ(lease.value().frame().capture_time, Instant(from_seconds(100.1)));
  EXPECT_EQ(lease.value().frame().sequence, 1u);
}

}  // namespace
}  // namespace touchline
