#include "firmware/snapshot_ring.h"

#include <chrono>
#include <cstring>
#include <thread>

#include <gtest/gtest.h>

namespace touchline {
namespace {

using namespace std::chrono_literals;

Snapshot numbered(std::uint64_t number) {
  Snapshot snapshot;
  snapshot.number = number;
  // At the beginning, in the middle and at the end of the memory.
  snapshot.frame_sequence = static_cast<std::uint32_t>(number);
  snapshot.tracks.ball.sigma_m = static_cast<float>(number % 1024);
  snapshot.reports.packets = snapshot.reports.foreign_bytes = number;
  return snapshot;
}

bool is_consistent(const Snapshot& snapshot) {
  return snapshot.frame_sequence == static_cast<std::uint32_t>(snapshot.number) &&
         snapshot.tracks.ball.sigma_m == static_cast<float>(snapshot.number % 1024) &&
         snapshot.reports.packets == snapshot.number && snapshot.reports.foreign_bytes == snapshot.number;
}

TEST(SnapshotRing, EachReaderGetsAllInOrder) {
  const auto ring = std::make_unique<SnapshotRing>();
  SnapshotReader first(*ring), second(*ring);
  Snapshot read;
  EXPECT_FALSE(first.read(read));
  for (std::uint64_t i = 0; i < 10; ++i) ring->write(numbered(i));
  SnapshotReader late(*ring);
  EXPECT_FALSE(late.read(read)) << "a reader begins with the next snapshot";
  for (SnapshotReader* const reader : {&first, &second}) {
    for (std::uint64_t i = 0; i < 10; ++i) {
      ASSERT_TRUE(reader->read(read));
      EXPECT_EQ(read.number, i);
      EXPECT_TRUE(is_consistent(read));
    }
    EXPECT_FALSE(reader->read(read));
    EXPECT_EQ(reader->lost(), 0U);
  }
}

TEST(SnapshotRing, SlowReaderLosesTheOldestAndCountsThem) {
  const auto ring = std::make_unique<SnapshotRing>();
  SnapshotReader slow(*ring);
  constexpr std::uint64_t kWritten = SnapshotRing::kSlots + 7;
  for (std::uint64_t i = 0; i < kWritten; ++i) ring->write(numbered(i));
  Snapshot read;
  for (std::uint64_t i = 7; i < kWritten; ++i) {
    ASSERT_TRUE(slow.read(read));
    EXPECT_EQ(read.number, i);
  }
  EXPECT_FALSE(slow.read(read));
  EXPECT_EQ(slow.lost(), 7U);
}

TEST(SnapshotRing, CopiesEveryByteOfASnapshot) {
  static_assert(std::is_trivially_copyable_v<Snapshot>);
  const auto ring = std::make_unique<SnapshotRing>();
  SnapshotReader reader(*ring);
  const auto written = std::make_unique<Snapshot>(), read = std::make_unique<Snapshot>();
  auto* bytes = reinterpret_cast<unsigned char*>(written.get());
  for (std::size_t i = 0; i < sizeof(Snapshot); ++i) bytes[i] = static_cast<unsigned char>(i * 7 + 1);
  ring->write(*written);
  ASSERT_TRUE(reader.read(*read));
  EXPECT_EQ(std::memcmp(written.get(), read.get(), sizeof(Snapshot)), 0);
}

// Prints what a write costs the loop. The bound is wide because the machine may be busy.
TEST(SnapshotRing, WriteTakesAFractionOfAMicrosecond) {
  const auto ring = std::make_unique<SnapshotRing>();
  const auto snapshot = std::make_unique<Snapshot>();
  constexpr int kRounds = 50, kWrites = 1000;
  auto best = std::chrono::nanoseconds::max();
  for (int round = 0; round < kRounds; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < kWrites; ++i) ring->write(*snapshot);
    best = std::min<std::chrono::nanoseconds>(best, (std::chrono::steady_clock::now() - begin) / kWrites);
  }
  RecordProperty("write_ns", static_cast<int>(best.count()));
  std::printf("%zu bytes in %lld ns\n", sizeof(Snapshot), static_cast<long long>(best.count()));
  EXPECT_LT(best, 50us);
}

TEST(ThreadsSnapshotRing, TooSlowReaderNeverGetsAMixture) {
  const auto ring = std::make_unique<SnapshotRing>();
  constexpr std::uint64_t kCount = 30000;
  std::uint64_t read_count[2] = {}, lost[2] = {};
  const auto read_all = [&](int index, std::uint64_t pause_every) {
    SnapshotReader reader(*ring);
    const auto snapshot = std::make_unique<Snapshot>();
    std::uint64_t expected = 0;
    while (expected < kCount) {
      if (!reader.read(*snapshot)) {
        reader.wait(1s);
        continue;
      }
      ASSERT_TRUE(is_consistent(*snapshot)) << snapshot->number;
      ASSERT_EQ(snapshot->number, expected + reader.lost() - lost[index]);
      expected = snapshot->number + 1;
      lost[index] = reader.lost();
      if (++read_count[index] % pause_every == 0) std::this_thread::sleep_for(1ms);
    }
  };
  // Writes begin when both readers have their position.
  std::atomic<int> ready{0};
  std::thread fast([&] {
    ++ready;
    read_all(0, 1000000);
  });
  std::thread slow([&] {
    ++ready;
    read_all(1, 8);
  });
  while (ready < 2) std::this_thread::yield();
  std::this_thread::sleep_for(20ms);
  for (std::uint64_t i = 0; i < kCount; ++i) {
    ring->write(numbered(i));
    if (i % 16 == 0) std::this_thread::yield();
  }
  fast.join();
  slow.join();
  EXPECT_EQ(read_count[1] + lost[1], kCount);
  EXPECT_GT(lost[1], 0U);
}

TEST(ThreadsSnapshotRing, WaitEndsWithASnapshotAWakeOrTheTime) {
  const auto ring = std::make_unique<SnapshotRing>();
  SnapshotReader reader(*ring);
  const auto begin = std::chrono::steady_clock::now();
  reader.wait(20ms);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, 15ms);

  std::atomic<int> waits{0};
  std::thread thread([&] {
    reader.wait(60s);
    ++waits;
    Snapshot snapshot;
    EXPECT_TRUE(reader.read(snapshot));
    reader.wait(60s);
    ++waits;
  });
  ring->write(numbered(0));
  while (waits < 1) std::this_thread::sleep_for(1ms);
  while (waits < 2) {  // the wake may come before the wait
    ring->wake_readers();
    std::this_thread::sleep_for(1ms);
  }
  thread.join();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 50s);
}

}  // namespace
}  // namespace touchline
