#include "hal/linux/sole_instance.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace touchline::hal {
namespace {

/// Ends slowly, as libcamera does.
struct Slow {
  static inline std::atomic<int> alive{0}, most{0};
  Slow() { most = std::max(most.load(), ++alive); }
  ~Slow() {
    std::this_thread::sleep_for(std::chrono::microseconds(300));
    --alive;
  }
};

std::unique_ptr<Slow> make() { return std::make_unique<Slow>(); }

TEST(SoleInstance, IsSharedAndEndsWithTheLast) {
  SoleInstance<Slow> sole;
  Slow* const first = sole.take(make);
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(sole.take(make), first);
  sole.give_back();
  EXPECT_EQ(Slow::alive, 1);
  sole.give_back();
  EXPECT_EQ(Slow::alive, 0);
}

TEST(SoleInstance, WhoComesWhileItEndsDoesNotMakeASecond) {
  SoleInstance<Slow> sole;
  Slow::most = 0;
  const auto come_and_go = [&] {
    for (int i = 0; i < 100; ++i) {
      ASSERT_NE(sole.take(make), nullptr);
      sole.give_back();
    }
  };
  std::thread other(come_and_go);
  come_and_go();
  other.join();
  EXPECT_EQ(Slow::alive, 0);
  EXPECT_EQ(Slow::most, 1);
}

TEST(SoleInstance, AFailureIsNoUse) {
  SoleInstance<Slow> sole;
  EXPECT_EQ(sole.take([] { return std::unique_ptr<Slow>(); }), nullptr);
  EXPECT_NE(sole.take(make), nullptr) << "another attempt";
  sole.give_back();
  EXPECT_EQ(Slow::alive, 0);
}

}  // namespace
}  // namespace touchline::hal
