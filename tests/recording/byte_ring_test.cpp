// Records pass from thread to thread as they were written, whatever their sizes.
#include "firmware/recording/byte_ring.h"

#include <gtest/gtest.h>

#include <random>
#include <thread>

namespace touchline::testing {
namespace {

using recording::ByteRing;

bool put(ByteRing& ring, std::size_t bytes, unsigned value) {
  const std::span<std::byte> room = ring.reserve(bytes);
  if (room.empty()) return false;
  EXPECT_EQ(room.size(), bytes);
  std::fill(room.begin(), room.end(), static_cast<std::byte>(value));
  ring.commit();
  return true;
}

TEST(ByteRing, KeepsWhatFitsAndRefusesTheRest) {
  ByteRing ring(100);
  EXPECT_EQ(ring.capacity(), 104U);
  EXPECT_TRUE(ring.front().empty());
  EXPECT_TRUE(put(ring, 40, 1));  // 48 with its size
  EXPECT_TRUE(put(ring, 41, 2));  // 56
  EXPECT_FALSE(put(ring, 1, 3));
  EXPECT_EQ(ring.free(), 0U);
  EXPECT_EQ(ring.front().size(), 40U);
  ring.pop();
  EXPECT_EQ(ring.front().size(), 41U);
  EXPECT_EQ(ring.front()[40], std::byte{2});
  EXPECT_TRUE(put(ring, 40, 3)) << "at the memory's beginning";
  ring.pop();
  EXPECT_EQ(ring.front()[0], std::byte{3});
  ring.pop();
  EXPECT_TRUE(ring.front().empty());
  EXPECT_EQ(ring.free(), ring.capacity());
}

TEST(ByteRing, NeverReturnsARecordInTwoParts) {
  ByteRing ring(104);
  EXPECT_TRUE(put(ring, 60, 1));
  ring.pop();
  EXPECT_TRUE(ring.front().empty());
  // 36 bytes are left before the end, so that the record begins at the beginning.
  EXPECT_TRUE(put(ring, 48, 2));
  EXPECT_EQ(ring.front().size(), 48U);
  EXPECT_FALSE(put(ring, 96, 3)) << "all of the memory is needed";
}

TEST(ByteRing, PassesRecordsBetweenThreads) {
  constexpr unsigned kRecords = 20000;
  ByteRing ring(4096);
  std::thread producer([&] {
    std::mt19937 random(1);
    for (unsigned i = 0; i < kRecords;) {
      const std::size_t bytes = 1 + random() % 700;
      while (!put(ring, bytes, i)) std::this_thread::yield();
      ++i;
    }
  });
  std::mt19937 random(1);
  unsigned wrong = 0;
  for (unsigned i = 0; i < kRecords;) {
    const std::span<const std::byte> record = ring.front();
    if (record.empty()) {
      std::this_thread::yield();
      continue;
    }
    const std::size_t bytes = 1 + random() % 700;
    const auto is_value = [i](std::byte byte) { return byte == static_cast<std::byte>(i); };
    wrong += record.size() == bytes && std::all_of(record.begin(), record.end(), is_value) ? 0U : 1U;
    ring.pop();
    ++i;
  }
  producer.join();
  EXPECT_EQ(wrong, 0U);
}

}  // namespace
}  // namespace touchline::testing
