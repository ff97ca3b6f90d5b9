#include "hal/poses/packet_order.h"

#include <gtest/gtest.h>

#include <chrono>

namespace touchline::hal {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kSender = 7, kOther = 8;

/// Packets that arrive 16 ms apart, each with other content.
class PacketStream {
 public:
  PacketPlace place(std::uint32_t number, std::uint64_t sender = kSender) {
    return order.place(number, sender, ++content, now += 16ms);
  }
  PacketOrder order;
  std::uint64_t content = 0;
  Instant now{};
};

TEST(PacketOrder, NumbersThatRiseComeNext) {
  PacketStream stream;
  EXPECT_EQ(stream.place(1000), PacketPlace::kNext);
  EXPECT_EQ(stream.order.missing(), 0u);
  EXPECT_EQ(stream.place(1001), PacketPlace::kNext);
  EXPECT_EQ(stream.place(1004), PacketPlace::kNext);
  EXPECT_EQ(stream.order.missing(), 2u);
}

TEST(PacketOrder, NumbersWrapAround) {
  PacketStream stream;
  stream.place(0xFFFFFFFFu);
  EXPECT_EQ(stream.place(0), PacketPlace::kNext);
  EXPECT_EQ(stream.place(0xFFFFFFFFu), PacketPlace::kLate);
}

TEST(PacketOrder, ADoubledPacketIsRecognizedByNumberAndContent) {
  PacketStream stream;
  stream.place(5);
  EXPECT_EQ(stream.order.place(5, kSender, stream.content, stream.now), PacketPlace::kDoubled);
  EXPECT_EQ(stream.place(6), PacketPlace::kNext);
}

TEST(PacketOrder, ASenderThatDoesNotCountIsHeard) {
  PacketStream stream;
  for (int i = 0; i < 20; ++i) EXPECT_EQ(stream.place(0), PacketPlace::kNext);
}

TEST(PacketOrder, AnOvertakenPacketIsLate) {
  PacketStream stream;
  stream.place(10);
  stream.place(12);
  EXPECT_EQ(stream.place(11), PacketPlace::kLate);
  EXPECT_EQ(stream.place(13), PacketPlace::kNext);
}

TEST(PacketOrder, ASenderThatBeginsAnewIsHeardAgain) {
  PacketStream stream;
  stream.place(5000);
  EXPECT_EQ(stream.place(1), PacketPlace::kNext) << "no network delays by 4999 packets";
  EXPECT_EQ(stream.order.missing(), 0u);
  PacketStream early;
  early.place(50);
  int late = 0;
  std::uint32_t number = 1;
  while (early.place(number++) == PacketPlace::kLate) ++late;
  EXPECT_EQ(late, 9);
}

TEST(PacketOrder, ASecondSenderIsIgnoredWhileTheFirstOneSends) {
  PacketStream stream;
  stream.place(100);
  for (std::uint32_t i = 0; i < 50; ++i) {
    EXPECT_EQ(stream.place(7000 + i, kOther), PacketPlace::kForeign);
    EXPECT_EQ(stream.place(101 + i), PacketPlace::kNext);
  }
  stream.now += 600ms;
  EXPECT_EQ(stream.place(7100, kOther), PacketPlace::kNext) << "the first one is silent";
}

}  // namespace
}  // namespace touchline::hal
