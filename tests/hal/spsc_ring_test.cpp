#include "hal/spsc_ring.h"

#include <thread>

#include <gtest/gtest.h>

namespace touchline {
namespace {

TEST(SpscRing, KeepsTheOrderAndCountsDroppedElements) {
  SpscRing<int, 4> ring;
  int value = 0;
  EXPECT_FALSE(ring.pop(value));
  for (int i = 0; i < 6; ++i) EXPECT_EQ(ring.push(i), i < 4);
  EXPECT_EQ(ring.dropped(), 2U);
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(ring.pop(value));
    EXPECT_EQ(value, i);
  }
  EXPECT_FALSE(ring.pop(value));
  EXPECT_TRUE(ring.push(7));
  ASSERT_TRUE(ring.pop(value));
  EXPECT_EQ(value, 7);
}

TEST(ThreadsRing, PassesAllElementsBetweenThreads) {
  struct Pair {
    int a = 0, b = 0;
  };
  SpscRing<Pair, 8> ring;
  constexpr int kCount = 20000;
  std::thread producer([&] {
    for (int i = 0; i < kCount;) {
      if (ring.push({i, -i})) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  for (int i = 0; i < kCount;) {
    Pair pair;
    if (!ring.pop(pair)) {
      std::this_thread::yield();
      continue;
    }
    ASSERT_EQ(pair.a, i);
    ASSERT_EQ(pair.b, -i);
    ++i;
  }
  producer.join();
}

}  // namespace
}  // namespace touchline
