#include "hal/mailbox.h"

#include <array>
#include <atomic>
#include <thread>

#include <gtest/gtest.h>

namespace touchline {
namespace {

TEST(Mailbox, NewestValueIsTakenOnce) {
  Mailbox<int> mailbox;
  int value = -1;
  EXPECT_FALSE(mailbox.take(value));
  EXPECT_EQ(value, -1);
  for (int i = 0; i < 10; ++i) mailbox.put(i);
  ASSERT_TRUE(mailbox.take(value));
  EXPECT_EQ(value, 9);
  EXPECT_FALSE(mailbox.take(value));
  mailbox.put(10);
  ASSERT_TRUE(mailbox.take(value));
  EXPECT_EQ(value, 10);
}

TEST(Mailbox, EverySequenceOfPutsAndTakesGivesTheNewestValue) {
  // Ten steps; bit k of the pattern decides between put and take.
  for (unsigned pattern = 0; pattern < 1024; ++pattern) {
    Mailbox<int> mailbox;
    int written = 0, waiting = 0, value = 0;
    for (unsigned k = 0; k < 10; ++k) {
      if ((pattern >> k & 1) != 0) {
        mailbox.put(waiting = ++written);
        continue;
      }
      ASSERT_EQ(mailbox.take(value), waiting != 0) << pattern;
      if (waiting != 0) {
        ASSERT_EQ(value, waiting) << pattern;
      }
      waiting = 0;
    }
  }
}

TEST(ThreadsMailbox, ValuesAreCompleteAndNeverGoBack) {
  struct Value {
    std::array<int, 100> copies{};  // all the same
  };
  Mailbox<Value> mailbox;
  constexpr int kLast = 20500;
  std::atomic<int> taken{0};
  std::thread writer([&] {
    Value value;
    for (int i = 1; i <= kLast; ++i) {
      value.copies.fill(i);
      mailbox.put(value);
      // Otherwise the threads might run one after the other.
      for (const int seen = taken; i % 1000 == 0 && taken == seen;) std::this_thread::yield();
    }
  });
  Value value;
  int former = 0;
  while (former < kLast) {
    if (!mailbox.take(value)) {
      std::this_thread::yield();
      continue;
    }
    ++taken;
    ASSERT_GT(value.copies[0], former);
    former = value.copies[0];
    for (const int copy : value.copies) ASSERT_EQ(copy, former);
  }
  writer.join();
  EXPECT_GT(taken, kLast / 1000);
}

}  // namespace
}  // namespace touchline
