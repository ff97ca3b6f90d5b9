#include "hal/linux/v4l2/capture_stamp.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <utility>

namespace touchline::hal {
namespace {

using std::chrono::milliseconds;

constexpr std::uint32_t kStart = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
constexpr std::uint32_t kEnd = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;
constexpr Instant at(int ms) { return Instant(milliseconds(ms)); }

TEST(CaptureStamp, StampsOfEitherEndAreMovedToTheMiddleOfTheExposure) {
  CaptureStamp stamp;
  stamp.restart(milliseconds(10));
  EXPECT_EQ(stamp.middle_of_exposure(kStart, at(100), at(120)), at(105));
  EXPECT_EQ(stamp.middle_of_exposure(kEnd, at(200), at(220)), at(195));
  EXPECT_EQ(stamp.replaced(), 0u);
}

TEST(CaptureStamp, StampsOfOtherClocksAreIgnored) {
  CaptureStamp stamp;
  stamp.restart(milliseconds(10));
  EXPECT_EQ(stamp.middle_of_exposure(V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN, at(100), at(120)), at(115));
  EXPECT_EQ(stamp.middle_of_exposure(V4L2_BUF_FLAG_TIMESTAMP_COPY, at(130), at(140)), at(135));
  EXPECT_EQ(stamp.replaced(), 0u);
}

TEST(CaptureStamp, RepeatedBackwardZeroAndFutureStampsAreReplaced) {
  CaptureStamp stamp;
  stamp.restart(Duration::zero());
  EXPECT_EQ(stamp.middle_of_exposure(kStart, at(0), at(50)), at(50));
  EXPECT_EQ(stamp.middle_of_exposure(kStart, at(100), at(120)), at(100));
  EXPECT_EQ(stamp.middle_of_exposure(kStart, at(100), at(140)), at(140));
  EXPECT_EQ(stamp.middle_of_exposure(kStart, at(90), at(160)), at(160));
  EXPECT_EQ(stamp.middle_of_exposure(kStart, at(999), at(180)), at(180));
  EXPECT_EQ(stamp.middle_of_exposure(kStart, at(190), at(200)), at(190)) << "the next good stamp is used again";
  EXPECT_EQ(stamp.replaced(), 4u);
}

TEST(CaptureStamp, TimeIncreasesEvenIfAReplacementIsLaterThanTheNextStamp) {
  CaptureStamp stamp;
  stamp.restart(Duration::zero());
  EXPECT_EQ(stamp.middle_of_exposure(kStart, at(999), at(100)), at(100));
  EXPECT_EQ(stamp.middle_of_exposure(kStart, at(95), at(117)), at(100) + Duration(1));
  EXPECT_EQ(stamp.middle_of_exposure(kStart, at(112), at(134)), at(112));
}

TEST(CaptureStamp, RestartClearsTheState) {
  CaptureStamp stamp;
  stamp.restart(milliseconds(10));
  EXPECT_EQ(stamp.middle_of_exposure(kStart, at(500), at(520)), at(505));
  EXPECT_EQ(stamp.middle_of_exposure(kStart, at(400), at(540)), at(535));
  stamp.restart(milliseconds(20));
  EXPECT_EQ(stamp.replaced(), 0u);
  EXPECT_EQ(stamp.middle_of_exposure(kStart, at(100), at(120)), at(110));
}

TEST(CaptureStamp, TheExposureMayChangeFromFrameToFrame) {
  CaptureStamp stamp;
  stamp.restart(milliseconds(10));
  EXPECT_EQ(stamp.middle_of_exposure(kStart, at(100), at(120)), at(105));
  stamp.set_exposure(milliseconds(4));
  EXPECT_EQ(stamp.middle_of_exposure(kStart, at(120), at(140)), at(122));
  EXPECT_EQ(stamp.replaced(), 0u);
}

TEST(CaptureStamp, NoStampIsInTheFutureForAnyExposure) {
  CaptureStamp stamp;
  for (const Duration exposure : {Duration(std::chrono::hours(2)), Duration(-std::chrono::hours(2))}) {
    for (const std::uint32_t flags : {kStart, kEnd, std::uint32_t{V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN}}) {
      stamp.restart(exposure);
      EXPECT_LE(stamp.middle_of_exposure(flags, at(5100), at(5120)), at(5120));
      EXPECT_GE(stamp.middle_of_exposure(flags, at(5120), at(5140)), at(4000)) << "not in the distant past either";
    }
  }
}

TEST(CaptureStamp, UvcvideoComputesStampsOnlyWithHwtimestamps) {
  const std::string file = ::testing::TempDir() + "touchline_hwtimestamps_" + std::to_string(::getpid());
  for (const auto& [content, expected] :
       {std::pair("Y\n", true), {"1\n", true}, {"N\n", false}, {"0\n", false}, {"", false}}) {
    std::ofstream(file) << content;
    EXPECT_EQ(uvc_computes_stamps(file), expected) << content;
  }
  std::filesystem::remove(file);
  EXPECT_FALSE(uvc_computes_stamps(file)) << "the driver is not loaded";
}

TEST(CaptureStamp, BoottimeStampsAreConvertedToMonotonicTime) {
  EXPECT_EQ(monotonic_stamp(at(90), at(100), at(100)), at(90));
  EXPECT_EQ(monotonic_stamp(at(90), at(100), at(5100)), at(90)) << "a stamp of CLOCK_MONOTONIC after a suspension";
  EXPECT_EQ(monotonic_stamp(at(5090), at(100), at(5100)), at(90)) << "a stamp of CLOCK_BOOTTIME";
}

}  // namespace
}  // namespace touchline::hal
