#include "hal/linux/shared_instance.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace touchline::hal {
namespace {

/// An object whose destructor takes long, like that of libcamera's camera manager.
struct Slow {
  static inline std::atomic<int> alive{0}, max_alive{0};
  Slow() { max_alive = std::max(max_alive.load(), ++alive); }
  ~Slow() {
    std::this_thread::sleep_for(std::chrono::microseconds(300));
    --alive;
  }
};

std::unique_ptr<Slow> make() { return std::make_unique<Slow>(); }

TEST(SharedInstance, IsDestroyedWithTheLastUser) {
  SharedInstance<Slow> shared;
  Slow* const first = shared.acquire(make);
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(shared.acquire(make), first);
  shared.release();
  EXPECT_EQ(Slow::alive, 1);
  shared.release();
  EXPECT_EQ(Slow::alive, 0);
}

TEST(SharedInstance, AUserThatArrivesDuringDestructionGetsANewOne) {
  SharedInstance<Slow> shared;
  Slow::max_alive = 0;
  const auto come_and_go = [&] {
    for (int i = 0; i < 100; ++i) {
      ASSERT_NE(shared.acquire(make), nullptr);
      shared.release();
    }
  };
  std::thread other(come_and_go);
  come_and_go();
  other.join();
  EXPECT_EQ(Slow::alive, 0);
  EXPECT_EQ(Slow::max_alive, 1);
}

TEST(SharedInstance, AFailedCreationIsNotAUser) {
  SharedInstance<Slow> shared;
  EXPECT_EQ(shared.acquire([] { return std::unique_ptr<Slow>(); }), nullptr);
  EXPECT_NE(shared.acquire(make), nullptr) << "the next attempt succeeds";
  shared.release();
  EXPECT_EQ(Slow::alive, 0);
}

}  // namespace
}  // namespace touchline::hal
