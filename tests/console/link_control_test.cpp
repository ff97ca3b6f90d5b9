#include "firmware/console/link_control.h"

#include <gtest/gtest.h>

namespace touchline::console {
namespace {

using namespace std::chrono_literals;

constexpr Instant kStart{std::chrono::hours(1)};

// A link with a limited rate and a delay: pictures arrive one after the other.
struct Line {
  /// Returns the number of pictures that have arrived until then.
  int send(LinkControl& link, double bytes_per_s, Duration round_trip, int milliseconds) {
    int arrived = 0;
    for (int i = 0; i < milliseconds; ++i, now += 1ms) {
      while (!on_the_way.empty() && on_the_way.front().seen <= now) {
        link.delivered(on_the_way.front().end, now, round_trip);
        link.seen(on_the_way.front().number);
        on_the_way.erase(on_the_way.begin());
        ++arrived;
      }
      if (!on_the_way.empty()) link.delivered(on_the_way.front().end - 1, now, round_trip);
      if (i % 66 != 0 || !link.may_send()) continue;
      const PictureLevel level = link.level();
      // size of the arena's pictures: 20 KB at a quality of 80
      const auto bytes = static_cast<std::size_t>(20000.0 * (level.quality / 80.0) / (level.divisor * level.divisor));
      link.sent(++number, bytes, end += bytes, now);
      free = std::max(free, now) + from_seconds(static_cast<double>(bytes) / bytes_per_s);
      on_the_way.push_back({number, end, free + round_trip});
    }
    return arrived;
  }

  struct OnTheWay {
    std::uint64_t number, end;
    Instant seen;
  };
  Instant now = kStart, free = kStart;
  std::vector<OnTheWay> on_the_way;
  std::uint64_t number = 0, end = 0;
};

TEST(LinkControl, AFastLinkGetsTheBestPicture) {
  LinkControl link;
  link.set(1, 66ms);
  Line line;
  const int arrived = line.send(link, 12.5e6, 1ms, 5000);
  EXPECT_EQ(link.level(), (PictureLevel{1, 80}));
  EXPECT_GE(arrived, 74);
  EXPECT_LE(arrived, 76);
}

TEST(LinkControl, ALongWayAloneShrinksNothing) {
  LinkControl link;
  link.set(1, 66ms);
  Line line;
  line.send(link, 12.5e6, 200ms, 5000);
  EXPECT_EQ(link.level(), (PictureLevel{1, 80}));
}

TEST(LinkControl, ASlowLinkGetsSmallerPicturesUntilTheyArriveInTimeAndLargerOnesWhenItRecovers) {
  LinkControl link;
  link.set(1, 66ms);
  Line line;
  line.send(link, 125000.0 / 2, 200ms, 10000);  // half a megabit per second
  const PictureLevel slow = link.level();
  EXPECT_LT(slow.quality, 80);
  EXPECT_GE(slow.divisor, 2);
  EXPECT_GT(link.throughput(), 20e3);
  EXPECT_LT(link.throughput(), 90e3);
  line.send(link, 12.5e6, 1ms, 20000);
  EXPECT_EQ(link.level(), (PictureLevel{1, 80}));
}

TEST(LinkControl, APageThatIsSlowToShowPicturesGetsFewerButNotSmallerOnes) {
  LinkControl link;
  link.set(1, 66ms);
  for (std::uint64_t number = 1; number < 40; ++number) {
    const Instant now = kStart + 1s * number;
    link.sent(number, 20000, 20000 * number, now);
    link.delivered(20000 * number, now + 2ms, 1ms);
    if (number > 1) link.seen(number - 1);
    link.seen(number);
  }
  EXPECT_EQ(link.level(), (PictureLevel{1, 80}));
}

TEST(LinkControl, AtMostTwoPicturesAreOnTheirWay) {
  LinkControl link;
  link.sent(1, 1000, 1000, kStart);
  EXPECT_TRUE(link.may_send());
  link.sent(5, 1000, 2000, kStart);
  EXPECT_FALSE(link.may_send());
  link.seen(0);
  EXPECT_FALSE(link.may_send()) << "an older one";
  link.seen(1);
  EXPECT_TRUE(link.may_send());
  link.sent(7, 1000, 3000, kStart);
  link.seen(7);
  EXPECT_EQ(link.unacknowledged(), 0U) << "the later one includes the earlier one";
  link.seen(99);
  EXPECT_EQ(link.unacknowledged(), 0U);
}

}  // namespace
}  // namespace touchline::console
