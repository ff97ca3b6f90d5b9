#include "hal/debouncer.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace touchline::hal {
namespace {

using namespace std::chrono_literals;

constexpr Instant kStart{10s};

class DebouncerTest : public ::testing::Test {
 protected:
  void begin(bool active = false) { debouncer.begin(5ms, active, kStart); }
  void edge(bool active, Duration at) { debouncer.edge(active, kStart + at); }
  Debouncer::State poll(Duration at) { return debouncer.poll(kStart + at); }
  Debouncer debouncer;
};

TEST_F(DebouncerTest, TheLevelAtTheStartIsAcceptedAtOnceAndIsNotAPress) {
  begin(true);
  EXPECT_TRUE(poll(0ms).active);
  EXPECT_FALSE(poll(1ms).activated);
  edge(false, 2ms);
  EXPECT_TRUE(poll(6ms).active);
  EXPECT_TRUE(poll(7ms).active) << "it was active since the last poll";
  EXPECT_FALSE(poll(8ms).active);
}

TEST_F(DebouncerTest, AnEdgeJustBeforeTheStartIsNotBouncing) {
  begin();
  edge(false, -1ms);
  edge(true, 1ms);
  EXPECT_FALSE(poll(2ms).bouncing);
}

TEST_F(DebouncerTest, PulsesAreDetectedIfTheyLastForTheDebounceTime) {
  for (const Duration length : {1us, 1000us, 4999us, 5000us, 5001us, 100000us}) {
    begin();
    edge(true, 20ms);
    edge(false, 20ms + length);
    const Debouncer::State state = poll(1s);
    EXPECT_EQ(state.active, length >= 5ms) << length.count();
    EXPECT_EQ(state.activated, length >= 5ms) << length.count();
    EXPECT_FALSE(poll(1s + 1ms).active) << "reported once";
    EXPECT_FALSE(poll(1s + 2ms).activated);
  }
}

TEST_F(DebouncerTest, ReportsWhenANewLevelWillBeAccepted) {
  begin();
  EXPECT_EQ(poll(10ms).settles_in, Duration::max());
  edge(true, 20ms);
  EXPECT_FALSE(poll(22ms).active);
  EXPECT_EQ(poll(22ms).settles_in, 3ms);
  EXPECT_TRUE(poll(25ms).active);
  EXPECT_EQ(poll(25ms).settles_in, Duration::max());
}

TEST_F(DebouncerTest, ALevelIsAcceptedWhenBouncingHasEnded) {
  begin();
  for (int i = 0; i < 10; ++i) {
    edge(true, 20ms + i * 1ms);
    edge(false, 20ms + i * 1ms + 500us);
  }
  edge(true, 30ms);
  EXPECT_FALSE(poll(34ms).active);
  EXPECT_TRUE(poll(35ms).activated);
  for (int i = 0; i < 10; ++i) {
    edge(false, 50ms + i * 1ms);
    edge(true, 50ms + i * 1ms + 500us);
  }
  EXPECT_FALSE(poll(100ms).activated) << "it was never released";
}

TEST_F(DebouncerTest, BouncingIsReportedAfterFiftyMilliseconds) {
  begin();
  bool bouncing = false;
  for (int ms = 20; ms < 60; ++ms) {
    edge(ms % 2 == 0, ms * 1ms);
    bouncing = bouncing || poll(ms * 1ms).bouncing;
  }
  EXPECT_FALSE(bouncing);
  for (int ms = 60; ms < 100; ++ms) edge(ms % 2 == 0, ms * 1ms);
  EXPECT_TRUE(poll(100ms).bouncing);
  EXPECT_FALSE(poll(100ms).active);
  EXPECT_FALSE(poll(110ms).bouncing) << "stable again";
}

TEST_F(DebouncerTest, ShortPulsesWithPausesAreIgnored) {
  begin();
  for (int i = 1; i < 1000; ++i) {
    edge(true, i * 10ms);
    edge(false, i * 10ms + 4ms);
    const Debouncer::State state = poll(i * 10ms + 4ms);
    ASSERT_FALSE(state.active || state.activated || state.bouncing) << i;
  }
}

TEST_F(DebouncerTest, AMissedEdgeRestartsTheDebounceTime) {
  begin();
  edge(true, 20ms);
  edge(true, 24ms);  // the input was low in between
  EXPECT_FALSE(poll(26ms).active);
  EXPECT_TRUE(poll(29ms).active);
}

TEST_F(DebouncerTest, WithoutDebounceTimeEveryLevelIsAccepted) {
  debouncer.begin(0ms, false, kStart);
  edge(true, 20ms);
  edge(false, 20ms);
  EXPECT_TRUE(poll(30ms).activated);
  EXPECT_FALSE(poll(31ms).active);
}

// Compares with the definition: active if, at some time in (last poll, now], a level had lasted for 5 ms.
TEST_F(DebouncerTest, AgreesWithItsDefinitionOnRandomEdges) {
  std::mt19937 random(4);
  std::uniform_int_distribution<int> gap_us(100, 12000), poll_us(500, 20000);
  for (int trial = 0; trial < 200; ++trial) {
    begin();
    std::vector<std::pair<Duration, bool>> edges;
    Duration at = 0us;
    for (int i = 0; i < 60; ++i) {
      at += gap_us(random) * 1us;
      edges.emplace_back(at, i % 2 == 0);
    }
    // The debounced level as a list of its changes.
    std::vector<std::pair<Duration, bool>> stable{{Duration::min(), false}};
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const Duration until = i + 1 < edges.size() ? edges[i + 1].first : 10s;
      if (until - edges[i].first >= 5ms && stable.back().second != edges[i].second) {
        stable.emplace_back(edges[i].first + 5ms, edges[i].second);
      }
    }
    std::size_t next_edge = 0;
    for (Duration last = 0us, now = 0us; now < at; last = now) {
      now += poll_us(random) * 1us;
      for (; next_edge < edges.size() && edges[next_edge].first <= now; ++next_edge)
        edge(edges[next_edge].second, edges[next_edge].first);
      bool active = false, activated = false;
      for (std::size_t i = 0; i < stable.size(); ++i) {
        const Duration end = i + 1 < stable.size() ? stable[i + 1].first : Duration::max();
        active = active || (stable[i].second && stable[i].first <= now && end > last);
        activated = activated || (stable[i].second && stable[i].first > last && stable[i].first <= now);
      }
      const Debouncer::State state = poll(now);
      ASSERT_EQ(state.active, active) << trial << " " << now.count();
      ASSERT_EQ(state.activated, activated) << trial << " " << now.count();
    }
  }
}

}  // namespace
}  // namespace touchline::hal
