#include "core/supervision/repeat_detector.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <random>

#include "hal/replay/replay_camera.h"
#include "tests/results.h"

namespace touchline {
namespace {

using namespace std::chrono_literals;

constexpr std::uint16_t kWidth = 128, kHeight = 96;
constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;
using Gray = std::vector<std::uint8_t>;

/// A camera of 30 Hz whose pictures a test makes; luma of YUYV.
class RepeatTest : public ::testing::Test {
 protected:
  RepeatTest() { detector->configure(PixelFormat::kYuyv, kWidth, kHeight); }

  RepeatDetector::Result show(const Gray& luma, bool is_moving = true, std::uint64_t seen = 0) {
    for (std::size_t i = 0; i < kPixels; ++i) bytes_[2 * i] = luma[i];
    Frame frame;
    frame.format = PixelFormat::kYuyv;
    frame.width_px = kWidth;
    frame.height_px = kHeight;
    frame.plane[0] = bytes_.data();
    frame.stride_bytes[0] = 2 * kWidth;
    frame.capture_time = Instant(1s) + from_seconds(number_++ / 30.0);
    return detector->check(frame, 200ms, is_moving, seen);
  }
  // A picture with noise of this many levels to both sides.
  Gray noisy(int levels = 3) {
    Gray luma(kPixels);
    for (std::size_t i = 0; i < kPixels; ++i) {
      luma[i] = static_cast<std::uint8_t>(100 + static_cast<int>(random_() % static_cast<unsigned>(2 * levels + 1)));
    }
    return luma;
  }
  void show_noise(int frames) {
    for (int i = 0; i < frames; ++i) {
      const RepeatDetector::Result result = show(noisy());
      ASSERT_EQ(result.share, 0.0f) << i;
      ASSERT_FALSE(result.is_repeated || result.is_still);
    }
  }
  // Returns the number of frames until the picture counts as repeated, at most `most`.
  int frames_until_repeated(const std::function<Gray()>& picture, int most) {
    for (int i = 1; i <= most; ++i) {
      if (show(picture()).is_repeated) return i;
    }
    return most + 1;
  }

  std::unique_ptr<RepeatDetector> detector = std::make_unique<RepeatDetector>();
  std::mt19937 random_{1};

 private:
  Gray bytes_ = Gray(2 * kPixels, 128);
  int number_ = 0;
};

TEST_F(RepeatTest, AFrozenPictureIsNoticedAfterTheLimit) {
  show_noise(200);
  const Gray frozen = noisy();
  EXPECT_EQ(frames_until_repeated([&] { return frozen; }, 20), 8) << "first one, and more than 0.2 s";
  const RepeatDetector::Result result = show(frozen);
  EXPECT_EQ(result.share, 1.0f);
  EXPECT_NEAR(seconds(result.age), 8 / 30.0, 0.002);
  EXPECT_FALSE(result.is_replayed);
  EXPECT_FALSE(show(noisy()).is_repeated) << "it recovers with the first new picture";
  for (int i = 0; i < 7; ++i) show(frozen);
  EXPECT_TRUE(show(frozen).is_repeated) << "what a fault did is not usual";
}

TEST_F(RepeatTest, AFrozenPictureStaysRepeatedForHours) {
  show_noise(200);
  const Gray frozen = noisy();
  for (int i = 0; i < 20; ++i) show(frozen);
  for (int i = 0; i < 5000; ++i) ASSERT_TRUE(show(frozen).is_repeated) << i;
}

TEST_F(RepeatTest, AnEighthIsEnough) {
  show_noise(200);
  const Gray old = noisy();
  // Six of 48 tiles are frozen: the first row of tiles without two.
  const auto frozen_part = [&](std::size_t columns) {
    Gray picture = noisy();
    for (std::size_t v = 0; v < kHeight / 6; ++v)
      std::memcpy(&picture[v * kWidth], &old[v * kWidth], columns * kWidth / 8);
    return picture;
  };
  EXPECT_EQ(frames_until_repeated([&] { return frozen_part(6); }, 20), 8);
  show_noise(3);
  EXPECT_EQ(frames_until_repeated([&] { return frozen_part(5); }, 20), 21);
}

TEST_F(RepeatTest, AnOldPartThatGoesOnIsAReplay) {
  std::vector<Gray> former;
  for (int i = 0; i < 200; ++i) {
    former.push_back(noisy());
    ASSERT_FALSE(show(former.back()).is_repeated);
  }
  for (std::size_t i = 0; i < 15; ++i) {
    Gray torn = noisy();
    former.push_back(torn);
    std::memcpy(&torn[kPixels / 2], &former[185 + i][kPixels / 2], kPixels / 2);
    const RepeatDetector::Result result = show(torn);
    EXPECT_TRUE(result.is_repeated) << i;
    EXPECT_TRUE(result.is_replayed) << i;
    EXPECT_GE(result.share, 0.3f) << i;
    EXPECT_NEAR(seconds(result.age), 0.5, 0.002) << i;
  }
}

TEST_F(RepeatTest, NoiseBelowALevelIsEnough) {
  // Nineteen of 20 pixels have their usual value. In so small a picture, whole tiles have it by chance.
  const Gray base = noisy();
  const auto quiet = [&] {
    Gray picture = base;
    for (std::size_t i = 0; i < kPixels; ++i)
      picture[i] = static_cast<std::uint8_t>(picture[i] + (random_() % 20 == 0 ? 1 : 0));
    return picture;
  };
  for (int i = 0; i < 300; ++i) ASSERT_FALSE(show(quiet()).is_repeated) << i;
  const Gray frozen = quiet();
  EXPECT_LE(frames_until_repeated([&] { return frozen; }, 60), 12);
}

TEST_F(RepeatTest, WhatCompressionUsuallyRepeatsIsNoFault) {
  // The tiles of the upper half are renewed in every tenth picture only, together, as by a key frame.
  Gray former = noisy();
  int number = 0;
  const auto compressed = [&] {
    Gray picture = noisy();
    if (number++ % 10 != 0) std::memcpy(picture.data(), former.data(), kPixels / 2);
    former = picture;
    return picture;
  };
  for (int i = 0; i < 2000; ++i) ASSERT_FALSE(show(compressed()).is_repeated) << i;
  const Gray frozen = compressed();
  EXPECT_LE(frames_until_repeated([&] { return frozen; }, 60), 9) << "the lower half is always renewed";
}

TEST_F(RepeatTest, DuplicatesOfASlowerSensorAreNoFault) {
  Gray picture;
  for (int i = 0; i < 1000; ++i) {
    if (i % 3 == 0) picture = noisy();
    ASSERT_FALSE(show(picture).is_repeated) << i;
  }
}

TEST_F(RepeatTest, BlackOrSaturatedPartsSayNothing) {
  show_noise(200);
  for (int i = 0; i < 100; ++i) {
    Gray glare = noisy();
    std::memset(glare.data(), 255, kPixels / 2);
    ASSERT_FALSE(show(glare).is_repeated) << i;
  }
}

// A spot of 12 pixels moves along the picture, and stands in between.
TEST_F(RepeatTest, PicturesWithoutNoiseAreNoFault) {
  const auto scene = [](int place) {
    Gray luma(kPixels);
    for (std::size_t i = 0; i < kPixels; ++i) luma[i] = static_cast<std::uint8_t>(i * 7 % 200);
    for (std::size_t v = 40; v < 52; ++v) std::memset(&luma[v * kWidth + static_cast<std::size_t>(place)], 255, 12);
    return luma;
  };
  int place = 0;
  for (int i = 0; i < 1500; ++i) {
    const bool is_moving = i % 300 >= 60;
    if (is_moving) place = (place + 2) % 110;
    const RepeatDetector::Result result = show(scene(place), is_moving, static_cast<std::uint64_t>(place));
    ASSERT_FALSE(result.is_repeated || result.is_still) << i;
  }
  // Everything stands although robots have been commanded to move for long.
  int frames = 0;
  while (frames < 60 && !show(scene(place), true, 7).is_still) ++frames;
  EXPECT_NEAR(frames, 13, 2) << "0.2 s and the time in which robots react";
  EXPECT_TRUE(show(scene(place), false, 7).is_still) << "robots that are stopped do not change it";
  EXPECT_FALSE(show(scene(place + 5), false, 8).is_still);
}

TEST_F(RepeatTest, AStartMakesAStillPictureCredible) {
  for (int i = 0; i < 200; ++i) show(noisy());
  const Gray still = noisy();
  for (int i = 0; i < 30; ++i) show(still);
  ASSERT_TRUE(show(still).is_still);
  detector->restart();
  EXPECT_FALSE(show(still, false).is_still);
}

TEST_F(RepeatTest, ATinyPictureIsNotJudged) {
  detector->configure(PixelFormat::kYuyv, 24, 24);
  const Gray frozen = noisy();
  for (int i = 0; i < 200; ++i) ASSERT_FALSE(show(frozen).is_repeated);
}

// Recorded games, compressed: up to 80 % of the sampled pixels, in single frames 99 %, equal those of the frame before.
TEST(RepeatFootage, VideosRaiseNoAlarm) {
  const char* shared = std::getenv("TOUCHLINE_SHARED");  // NOLINT(concurrency-mt-unsafe): one thread
  if (shared == nullptr) GTEST_SKIP() << "TOUCHLINE_SHARED does not name the folder with footage/";
  int videos = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(shared) + "/footage")) {
    if (entry.path().extension() != ".mp4") continue;
    ++videos;
    hal::ReplayCamera camera({.path = entry.path()});
    ASSERT_OK(camera.open());
    const hal::CameraInfo info = camera.info();
    ASSERT_OK(camera.start());
    const auto detector = std::make_unique<RepeatDetector>();
    detector->configure(info.format, info.width_px, info.height_px);
    float share = 0.0f;
    int frames = 0;
    for (;; ++frames) {
      const Result<hal::FrameLease> lease = camera.wait(Instant::max());
      if (!lease.ok()) break;
      // As if robots were driven all the time.
      const RepeatDetector::Result result = detector->check(lease.value().frame(), 200ms, true, 0);
      share = std::max(share, result.share);
      EXPECT_FALSE(result.is_repeated) << entry.path() << " frame " << frames << " share " << result.share;
      EXPECT_FALSE(result.is_still) << entry.path() << " frame " << frames;
    }
    RecordProperty(entry.path().stem().string() + "_share", std::to_string(share));
    EXPECT_GT(frames, 100);
  }
  EXPECT_GT(videos, 0);
}

}  // namespace
}  // namespace touchline
