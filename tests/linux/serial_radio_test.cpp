#include <cerrno>
#include <utility>

#include "tests/linux/driver_allocations.h"
#include "tests/linux/serial_radio_fixture.h"
#include "tests/results.h"

namespace touchline::testing {
namespace {

TEST_F(SerialRadioTest, OnlyTheNewestPacketWaitsForTheLine) {
  SerialRadio radio(settings(9600));
  ASSERT_TRUE(radio.open().ok());
  ASSERT_TRUE(radio.send(packet(100, 1)).ok());
  ASSERT_TRUE(radio.send(packet(100, 2)).ok()) << "it waits; no packet is lost yet";
  expect_error(radio.send(packet(100, 3)), ErrorCode::kBusy,
               text("the line is still busy; a newer packet replaced an older one; 9600 baud is too slow for "
                    "the rate of packets, or the port has stalled"));
  EXPECT_EQ(adapter_.waiting(), 100u) << "the driver has only the packet that it is sending";
  ASSERT_TRUE(radio.serve().ok());
  EXPECT_NEAR(seconds(radio.serve().value()), 1.02 * 100 * 10.0 / 9600, 0.001);
  kernel_.advance(std::chrono::milliseconds(107));
  EXPECT_EQ(radio.serve().value(), Duration::max());
  EXPECT_TRUE(radio.drain(kernel_.now() + std::chrono::seconds(1)).ok());
  EXPECT_EQ(adapter_.wire(), std::vector<std::byte>{} + packet(100, 1) + packet(100, 3));
  EXPECT_EQ(radio.counters().packets, 3u);
  EXPECT_EQ(radio.counters().dropped, 1u);
  EXPECT_EQ(radio.counters().refused, 0u);
}

TEST_F(SerialRadioTest, ANewPacketReplacesAWaitingOneEvenIfTheLineIsFree) {
  SerialRadio radio(settings(9600));
  ASSERT_TRUE(radio.open().ok());
  ASSERT_TRUE(radio.send(packet(50, 1)).ok());
  ASSERT_TRUE(radio.send(packet(50, 2)).ok());
  kernel_.advance(std::chrono::milliseconds(60));
  EXPECT_EQ(radio.send(packet(50, 3)).code(), ErrorCode::kBusy) << "the second packet is outdated by now";
  EXPECT_TRUE(radio.drain(kernel_.now() + std::chrono::seconds(1)).ok());
  EXPECT_EQ(adapter_.wire(), std::vector<std::byte>{} + packet(50, 1) + packet(50, 3));
}

TEST_F(SerialRadioTest, APacketWaitsWhileTheDriversBufferIsFull) {
  adapter_.buffer_bytes = 0;
  SerialRadio radio(settings());
  ASSERT_TRUE(radio.open().ok());
  EXPECT_TRUE(radio.send(packet(100, 1)).ok());
  EXPECT_EQ(radio.send(packet(20, 2)).code(), ErrorCode::kBusy);
  EXPECT_EQ(adapter_.waiting(), 0u);
  EXPECT_EQ(radio.split_packets(), 0u);
  adapter_.buffer_bytes = 100;
  EXPECT_TRUE(radio.drain(kernel_.now() + std::chrono::seconds(1)).ok());
  EXPECT_EQ(adapter_.wire(), std::vector<std::byte>{} + packet(20, 2));
}

TEST_F(SerialRadioTest, ASplitPacketIsCompletedFirst) {
  adapter_.buffer_bytes = 40;
  SerialRadio radio(settings());
  ASSERT_TRUE(radio.open().ok());
  ASSERT_TRUE(radio.send(packet(66, 1)).ok()) << "40 bytes fit, 26 follow";
  EXPECT_EQ(radio.split_packets(), 1u);
  EXPECT_TRUE(radio.send(packet(66, 2)).ok()) << "it waits";
  kernel_.advance(std::chrono::milliseconds(1));  // 11 bytes
  EXPECT_EQ(radio.send(packet(66, 3)).code(), ErrorCode::kBusy);
  EXPECT_TRUE(radio.drain(kernel_.now() + std::chrono::seconds(1)).ok());
  EXPECT_EQ(adapter_.wire(), std::vector<std::byte>{} + packet(66, 1) + packet(66, 3));
  EXPECT_EQ(radio.counters().dropped, 1u);
}

TEST_F(SerialRadioTest, ReceiveReturnsAvailableBytesWithoutWaiting) {
  SerialRadio radio(settings());
  std::array<std::byte, 16> bytes{};
  EXPECT_EQ(radio.receive(bytes).code(), ErrorCode::kDisconnected);
  ASSERT_TRUE(radio.open().ok());
  EXPECT_EQ(radio.receive(bytes).value(), 0u);
  const Packet words = packet(20, 7);
  adapter_.receive_from_robots({words.data(), words.size()});
  EXPECT_EQ(radio.receive(bytes).value(), 16u);
  EXPECT_EQ(bytes[15], std::byte{7});
  EXPECT_EQ(radio.receive(bytes).value(), 4u);
  EXPECT_EQ(radio.receive(bytes).value(), 0u);
  EXPECT_EQ(radio.counters().received_bytes, 20u);
  adapter_.read_error = EIO;
  expect_error(radio.receive(bytes), ErrorCode::kDisconnected, text("the port went away (receiving)"));
}

TEST_F(SerialRadioTest, DrainCompletesASplitPacket) {
  adapter_.buffer_bytes = 40;
  SerialRadio radio(settings());
  ASSERT_TRUE(radio.open().ok());
  ASSERT_TRUE(radio.send(packet(66, 1)).ok());
  EXPECT_TRUE(radio.drain(kernel_.now() + std::chrono::milliseconds(100)).ok());
  EXPECT_EQ(adapter_.wire(), std::vector<std::byte>{} + packet(66, 1));
}

TEST_F(SerialRadioTest, DrainTakesTheTransmissionTimeIncludingTheFifo) {
  SerialRadio radio(settings(9600));
  ASSERT_TRUE(radio.open().ok());
  ASSERT_TRUE(radio.send(packet(96, 1)).ok());
  const Instant start = kernel_.now();
  EXPECT_TRUE(radio.drain(start + std::chrono::seconds(1)).ok());
  const double taken_s = seconds(kernel_.now() - start);
  EXPECT_GE(taken_s, (96 + 64) * 10.0 / 9600);
  EXPECT_LE(taken_s, 1.02 * (96 + 64) * 10.0 / 9600 + 0.002);
}

TEST_F(SerialRadioTest, DrainWaitsForBytesInTheAdapter) {
  adapter_.chip_bytes = 600;
  SerialRadio radio(settings(9600));
  ASSERT_TRUE(radio.open().ok());
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(radio.send(packet(120, i)).ok());
  EXPECT_TRUE(radio.drain(kernel_.now() + std::chrono::seconds(1)).ok());
  EXPECT_EQ(adapter_.wire(), std::vector<std::byte>{} + packet(120, 0) + packet(120, 1));
}

TEST_F(SerialRadioTest, DrainTimesOutAtTheDeadline) {
  adapter_.stalled = true;
  adapter_.buffer_bytes = 50;
  SerialRadio radio(settings());
  ASSERT_TRUE(radio.open().ok());
  ASSERT_TRUE(radio.send(packet(66, 1)).ok());
  const Instant deadline = kernel_.now() + std::chrono::milliseconds(30);
  expect_error(radio.drain(deadline), ErrorCode::kTimeout, text("66 bytes were not sent before the deadline"));
  EXPECT_GE(kernel_.now(), deadline);
  EXPECT_LE(kernel_.now(), deadline + std::chrono::milliseconds(1));
  radio.close();
  EXPECT_EQ(adapter_.flushed(), 50u) << "otherwise closing would wait for the stalled line";
}

TEST_F(SerialRadioTest, ReopensUnderAnotherNumberAfterReplugging) {
  SerialRadio radio(settings());
  ASSERT_TRUE(radio.open().ok());
  ASSERT_TRUE(radio.send(packet(10, 1)).ok());
  adapter_.hang_up(EIO);
  expect_error(radio.send(packet(10, 2)), ErrorCode::kDisconnected,
               text("the port went away (reading the length of the output queue)"));
  adapter_.hang_up(0);
  EXPECT_EQ(radio.send(packet(10, 3)).code(), ErrorCode::kDisconnected) << "until it is reopened";
  EXPECT_EQ(radio.drain(kernel_.now()).code(), ErrorCode::kDisconnected);
  radio.close();
  kernel_.link(kById, "/dev/ttyS0");
  ASSERT_OK(radio.open());
  ASSERT_TRUE(radio.send(packet(10, 4)).ok());
  EXPECT_EQ(on_board_.waiting(), 10u);
  EXPECT_EQ(radio.counters().refused, 2u);
  EXPECT_EQ(radio.counters().packets, 2u);
}

TEST_F(SerialRadioTest, AStalledPortIsAnErrorAfterFiveSeconds) {
  SerialRadio radio(settings(1200));
  ASSERT_TRUE(radio.open().ok());
  adapter_.stalled = true;
  const auto send_for = [&](Duration time) -> Result<void> {
    for (const Instant end = kernel_.now() + time; kernel_.now() < end;) {
      Result<void> sent = radio.send(packet(60, 1));
      if (!sent.ok() && sent.code() != ErrorCode::kBusy) return sent;
      kernel_.advance(std::chrono::milliseconds(17));
    }
    return {};
  };
  EXPECT_TRUE(send_for(std::chrono::milliseconds(4900)).ok());
  adapter_.stalled = false;
  EXPECT_TRUE(send_for(std::chrono::seconds(10)).ok()) << "slow, but not stalled";
  adapter_.stalled = true;
  expect_error(send_for(std::chrono::milliseconds(5100)), ErrorCode::kIo,
               text("the port has stalled: it sent none of " + std::to_string(adapter_.waiting()) + " bytes for 5 s"));
  EXPECT_EQ(radio.send(packet(60, 1)).code(), ErrorCode::kIo);
  adapter_.stalled = false;
  ASSERT_TRUE(radio.open().ok());
  EXPECT_TRUE(send_for(std::chrono::seconds(1)).ok());
}

TEST_F(SerialRadioTest, BytesOfAPreviousOpenAreNotYetAStall) {
  SerialRadio radio(settings());
  adapter_.stalled = true;
  adapter_.flushes = false;
  ASSERT_TRUE(radio.open().ok());
  ASSERT_TRUE(radio.send(packet(60, 1)).ok());
  kernel_.advance(std::chrono::seconds(20));
  ASSERT_TRUE(radio.open().ok());
  ASSERT_EQ(adapter_.waiting(), 60u);
  EXPECT_EQ(radio.send(packet(60, 2)).code(), ErrorCode::kOk);
  kernel_.advance(std::chrono::milliseconds(4900));
  EXPECT_NE(radio.send(packet(60, 3)).code(), ErrorCode::kIo);
  kernel_.advance(std::chrono::milliseconds(200));
  EXPECT_EQ(radio.send(packet(60, 4)).code(), ErrorCode::kIo);
}

TEST_F(SerialRadioTest, WriteErrorsAreReported) {
  SerialRadio radio(settings());
  ASSERT_TRUE(radio.open().ok());
  adapter_.write_error = EIO;
  expect_error(radio.send(packet(10, 1)), ErrorCode::kDisconnected, text("the port went away (sending)"));
  radio.close();
  adapter_.write_error = EPERM;
  ASSERT_TRUE(radio.open().ok());
  expect_error(radio.send(packet(10, 1)), ErrorCode::kIo, text("sending failed: Operation not permitted"));
}

TEST_F(SerialRadioTest, ReopeningDropsTheRestOfASplitPacket) {
  adapter_.buffer_bytes = 40;
  adapter_.stalled = true;
  SerialRadio radio(settings());
  ASSERT_TRUE(radio.open().ok());
  ASSERT_TRUE(radio.send(packet(66, 1)).ok());
  ASSERT_TRUE(radio.open().ok());
  adapter_.stalled = false;
  ASSERT_TRUE(radio.send(packet(30, 2)).ok());
  EXPECT_TRUE(radio.drain(kernel_.now() + std::chrono::milliseconds(100)).ok());
  EXPECT_EQ(adapter_.wire(), std::vector<std::byte>{} + packet(30, 2));
}

TEST_F(SerialRadioTest, AllocatesNothingEvenOnErrors) {
  if (!DriverAllocations::are_counted()) GTEST_SKIP() << "the sanitizer replaces the allocator";
  adapter_.buffer_bytes = 50;
  SerialRadio radio(settings());
  ASSERT_TRUE(radio.open().ok());
  const Packet one = packet(66, 1);
  std::array<std::byte, 16> bytes{};
  int busy = 0, sent = 0, gone = 0;
  const DriverAllocations counter;
  for (int i = 0; i < 1000; ++i) {
    kernel_.advance(std::chrono::milliseconds(i % 2 == 0 ? 3 : 5));
    if (i == 900) adapter_.hang_up(EIO);
    const ErrorCode code = radio.send(one).code();
    static_cast<void>(radio.serve());
    static_cast<void>(radio.receive(bytes));
    (code == ErrorCode::kOk ? sent : code == ErrorCode::kBusy ? busy : gone) += 1;
  }
  const std::uint64_t allocations = counter.count();
  EXPECT_EQ(allocations, 0u);
  EXPECT_GT(sent, 400);
  EXPECT_GT(busy, 100);
  EXPECT_GT(radio.split_packets(), 10u);
  EXPECT_EQ(gone, 100);
}

// For any baud rate, buffer size and timing: packets arrive whole and in order, the newest one last, and no packet was
// older than the previous frame when its first byte was sent.
TEST_F(SerialRadioTest, PacketsArriveWholeInOrderAndUpToDate) {
  for (const int baud : {9600, 57600, 115200, 1000000}) {
    for (const auto& [buffer_bytes, chip_bytes] :
         {std::pair{7, 0}, std::pair{30, 0}, std::pair{97, 16}, std::pair{4096, 0}, std::pair{4096, 576}}) {
      SCOPED_TRACE(std::to_string(baud) + " baud, buffer of " + std::to_string(buffer_bytes) + " bytes, of which " +
                   std::to_string(chip_bytes) + " are in the adapter");
      fake::SerialPort port("/dev/ttyS9");
      port.buffer_bytes = static_cast<std::size_t>(buffer_bytes);
      port.chip_bytes = static_cast<std::size_t>(chip_bytes);
      port.actual_baud = baud - baud / 60;  // the slowest accepted rate
      const fake::SerialPorts machine({&port});
      kernel_.add("/dev/ttyS9", port);
      RadioSettings requested = settings(baud);
      requested.device = "/dev/ttyS9";
      SerialRadio radio(requested);
      ASSERT_TRUE(radio.open().ok());
      int taken = 0;
      for (int i = 0; i < 200; ++i) {
        kernel_.advance(std::chrono::microseconds(2000 + 970 * (i % 13)));
        // Each byte is the packet's number, which also determines the length.
        taken += radio.send(packet(static_cast<std::size_t>(20 + i % 50), i)).code() == ErrorCode::kBusy ? 0 : 1;
        EXPECT_LE(port.waiting(), 69u) << "more than a packet waits in the driver";
        for (int k = 0; k < 3; ++k) {
          kernel_.advance(std::chrono::microseconds(900));
          ASSERT_TRUE(radio.serve().ok());
        }
      }
      EXPECT_TRUE(radio.drain(kernel_.now() + std::chrono::seconds(5)).ok());
      int last = -1, whole = 0;
      const std::vector<std::byte>& wire = port.wire();
      for (std::size_t at = 0; at < wire.size(); ++whole) {
        const int number = std::to_integer<int>(wire[at]);
        EXPECT_GT(number, last);
        last = number;
        const std::size_t end = at + static_cast<std::size_t>(20 + number % 50);
        ASSERT_LE(end, wire.size());
        for (; at < end; ++at) ASSERT_EQ(std::to_integer<int>(wire[at]), number) << "incomplete packet";
      }
      EXPECT_EQ(last, 199);
      EXPECT_EQ(static_cast<std::uint64_t>(whole), radio.counters().packets - radio.counters().dropped);
      EXPECT_EQ(radio.counters().dropped, static_cast<std::uint64_t>(200 - taken));
      if (baud == 9600) {
        EXPECT_LT(whole, 100);
      } else if (baud == 1000000 && buffer_bytes == 4096) {
        EXPECT_EQ(whole, 200);
      }
    }
  }
}

}  // namespace
}  // namespace touchline::testing
