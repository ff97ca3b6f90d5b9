// The loop's side of a recording: every step with its inputs, no allocation, and pictures left out first.
#include "firmware/recording/step_tap.h"

#include <chrono>
#include <cstring>

#include "tests/firmware/loop_fixture.h"
#include "tools/programs/latency/allocation_counter.h"

namespace touchline::testing {
namespace {

using namespace recording;

class StepTapTest : public LoopTest {
 protected:
  /// The headers of all records, which are removed from the ring.
  static std::vector<StepHeader> take_headers(ByteRing& ring) {
    std::vector<StepHeader> headers;
    for (std::span<const std::byte> record = ring.front(); !record.empty(); record = ring.front()) {
      headers.emplace_back();
      std::memcpy(&headers.back(), record.data(), sizeof(StepHeader));
      ring.pop();
    }
    return headers;
  }
};

TEST_F(StepTapTest, RecordsFramesAndStopsInTheirOrder) {
  ByteRing memory(std::size_t{8} << 20);
  StepTap tap(memory, 2);
  tap.begin_session(false);
  settings.recording = &tap;
  camera.add({0.5, 0.9, ErrorCode::kTimeout});
  start();
  run_until(1.2);
  loop->close();
  const std::vector<StepHeader> headers = take_headers(memory);
  ASSERT_GT(headers.size(), 40U);
  std::uint64_t frames = 0, stops = 0, pictures = 0;
  for (std::size_t i = 0; i < headers.size(); ++i) {
    EXPECT_EQ(headers[i].number, i);
    EXPECT_EQ(headers[i].session, 1U);
    if (headers[i].kind == StepKind::kStop) {
      ++stops;
      continue;
    }
    EXPECT_EQ(headers[i].frame_number, frames);
    EXPECT_EQ(headers[i].picture, frames % 2 == 0 ? PictureKind::kRaw : PictureKind::kNone) << "every second picture";
    pictures += headers[i].picture == PictureKind::kRaw ? 1U : 0U;
    ++frames;
  }
  EXPECT_EQ(frames, loop->statistics().frames);
  EXPECT_GT(stops, 5U) << "without frames, and at the end";
  EXPECT_GT(pictures, 15U);
  EXPECT_EQ(tap.lost_steps() + tap.lost_pictures(), 0U);
}

TEST_F(StepTapTest, CountsStepsThatNobodyRecords) {
  ByteRing memory(std::size_t{8} << 20);
  StepTap tap(memory, 0);
  tap.begin_session(false);
  tap.end();
  settings.recording = &tap;
  start();
  run_until(0.5);
  EXPECT_TRUE(take_headers(memory).empty());
  const std::uint64_t frames = loop->statistics().frames;
  tap.begin(7);
  run_until(1.0);
  StepParts parts;
  std::memcpy(&parts, memory.front().data(), sizeof(StepParts));
  EXPECT_EQ(parts.recording, 7U);
  const std::vector<StepHeader> headers = take_headers(memory);
  ASSERT_GT(headers.size(), 10U);
  EXPECT_GE(headers.front().number, frames) << "a recording that begins later begins with a gap";
  EXPECT_EQ(headers.front().frame_number, frames);
  loop->close();
}

TEST_F(StepTapTest, AllocatesNothing) {
  ByteRing memory(std::size_t{16} << 20);
  StepTap tap(memory, 1);
  tap.begin_session(false);
  settings.recording = &tap;
  start();
  run_until(0.5);
  const std::uint64_t before = latency::allocations_of_this_thread();
  run_until(2.0);
  const std::uint64_t allocations = latency::allocations_of_this_thread() - before;
  EXPECT_GT(take_headers(memory).size(), 90U);
  loop->close();
  if (!latency::allocations_are_counted()) GTEST_SKIP() << "a sanitizer has its own allocator";
  EXPECT_EQ(allocations, 0U);
}

TEST_F(StepTapTest, WithoutMemoryPicturesAreLeftOutFirstAndTheLoopGoesOn) {
  // A picture has 9 KB, the rest of a step 16 KB.
  ByteRing memory(std::size_t{1} << 20);
  StepTap tap(memory, 1);
  tap.begin_session(false);
  settings.recording = &tap;
  start();
  run_until(4.0);
  EXPECT_GT(loop->statistics().frames, 190U);
  EXPECT_GT(tap.lost_pictures(), 100U);
  EXPECT_GT(tap.lost_steps(), 50U);
  EXPECT_LT(tap.lost_steps(), tap.lost_pictures());
  const std::vector<StepHeader> headers = take_headers(memory);
  EXPECT_EQ(headers.front().picture, PictureKind::kRaw);
  EXPECT_EQ(headers.back().picture, PictureKind::kNone) << "the last eighth of the memory is for steps";
  // After the gap the numbers tell how much is missing.
  run_until(4.1);
  const std::vector<StepHeader> later = take_headers(memory);
  ASSERT_FALSE(later.empty());
  EXPECT_GE(later.front().number, headers.size() + tap.lost_steps());
  loop->close();
}

TEST_F(StepTapTest, SimulatedTimeWaitsOnlyOnceForARecorderThatDoesNotWrite) {
  ByteRing memory(std::size_t{1} << 20);
  StepTap tap(memory, 2);
  tap.begin_session(true);
  settings.recording = &tap;
  start();
  const auto begin = std::chrono::steady_clock::now();
  run_until(4.0);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  EXPECT_GT(loop->statistics().frames, 190U);
  EXPECT_GT(tap.lost_pictures(), 0U);
  EXPECT_GT(tap.lost_steps(), 0U);
  EXPECT_GE(elapsed.count(), 2.0);
  EXPECT_LT(elapsed.count(), 3.9) << "it has waited twice";
  // When the recorder writes again, simulated time waits again: nothing more is lost.
  const std::uint64_t lost = tap.lost_steps();
  static_cast<void>(take_headers(memory));
  run_until(4.2);
  EXPECT_EQ(tap.lost_steps(), lost);
  loop->close();
}

TEST_F(StepTapTest, RecordsNothingAfterItsEnd) {
  ByteRing memory(std::size_t{1} << 20);
  StepTap tap(memory, 1);
  // As if simulated time waited for a recorder that has ended.
  tap.begin_session(true);
  settings.recording = &tap;
  start();
  tap.end();
  run_until(4.0);
  loop->close();
  EXPECT_TRUE(memory.front().empty());
  EXPECT_GT(loop->statistics().frames, 190U);
}

}  // namespace
}  // namespace touchline::testing
