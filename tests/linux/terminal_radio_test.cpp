// A serial radio at a pseudo terminal of the real kernel. UARTs: serial_radio_test.cpp.
#include <gtest/gtest.h>

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <span>
#include <string>

#include "hal/linux/network/descriptor.h"
#include "hal/linux/serial/serial_radio.h"
#include "tests/results.h"

namespace touchline::hal {
namespace {

/// A pseudo terminal, of which the radio opens the other side.
class TerminalRadio : public ::testing::Test {
 protected:
  TerminalRadio() {
    EXPECT_EQ(::grantpt(robots_.get()), 0);
    EXPECT_EQ(::unlockpt(robots_.get()), 0);
    settings_.backend = RadioBackend::kSerial;
    settings_.device = ::ptsname(robots_.get());
    settings_.baud = 1200;
  }
  /// The next bytes, or none if none arrive for a moment: the kernel passes them on later than write() returns.
  std::string received() {
    pollfd line{robots_.get(), POLLIN, 0};
    ::poll(&line, 1, 100);
    std::array<char, 4096> block{};
    const ssize_t count = ::read(robots_.get(), block.data(), block.size());
    return count > 0 ? std::string(block.data(), static_cast<std::size_t>(count)) : std::string();
  }
  static Packet packet(int value, std::size_t size) {
    Packet packet;
    for (std::size_t i = 0; i < size; ++i) packet.push_back(static_cast<std::byte>(value));
    return packet;
  }

  Descriptor robots_{::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)};
  RadioPortSettings settings_;
};

TEST_F(TerminalRadio, PassesAllBytesOnUnchangedWithoutABaudRate) {
  SerialRadio radio(settings_);
  ASSERT_OK(radio.open());
  EXPECT_EQ(radio.description(), settings_.device + ": a terminal without a baud rate (" + settings_.device +
                                     "), opened without libserialport");
  std::string all;
  for (int value = 0; value < 256; ++value) {
    ASSERT_OK(radio.send(packet(value, 1)));  // at 1200 baud the line would be busy
    all += static_cast<char>(value);
  }
  std::string arrived;
  while (arrived.size() < all.size()) {
    const std::string part = received();
    if (part.empty()) break;
    arrived += part;
  }
  EXPECT_EQ(arrived, all);
  ASSERT_EQ(::write(robots_.get(), "\r\n\x03\x11", 4), 4);
  std::array<std::byte, 16> into{};
  std::size_t count = 0;
  for (int i = 0; i < 1000 && count < 4; ++i) {
    count += radio.receive(std::span(into).subspan(count)).value();
    ::usleep(1000);
  }
  EXPECT_EQ(count, 4U);
  EXPECT_EQ(into[0], std::byte{'\r'});
  EXPECT_EQ(radio.receive(into).value(), 0U);
}

TEST_F(TerminalRadio, AReaderThatStopsGetsTheNewestPacketLater) {
  SerialRadio radio(settings_);
  ASSERT_OK(radio.open());
  bool is_full = false;
  for (int i = 0; i < 10000 && !is_full; ++i) is_full = radio.send(packet('a', 100)).code() == ErrorCode::kBusy;
  ASSERT_TRUE(is_full);
  EXPECT_EQ(radio.send(packet('b', 3)).code(), ErrorCode::kBusy);
  std::string all;
  for (std::string part = received(); !part.empty(); part = received()) {
    all += part;
    EXPECT_OK(radio.serve());
  }
  EXPECT_EQ(all.substr(all.find('b')), "bbb");
  EXPECT_EQ(all.find('b') % 100, 0U) << "packets are complete";
}

TEST_F(TerminalRadio, TheOtherSideCanGoAndComeBack) {
  SerialRadio radio(settings_);
  ASSERT_OK(radio.open());
  robots_.reset();
  std::array<std::byte, 16> into{};
  EXPECT_EQ(radio.receive(into).code(), ErrorCode::kDisconnected);
  EXPECT_EQ(radio.send(packet('a', 1)).code(), ErrorCode::kDisconnected);
  EXPECT_EQ(radio.open().code(), ErrorCode::kNotFound);
}

TEST_F(TerminalRadio, CanBeOpenedAgain) {
  for (int i = 0; i < 3; ++i) {
    SerialRadio radio(settings_), other(settings_);
    ASSERT_OK(radio.open());
    EXPECT_EQ(other.open().code(), ErrorCode::kDeviceBusy) << "the port is locked";
  }
}

TEST_F(TerminalRadio, AFileThatIsNoTerminalIsRefused) {
  settings_.device = "/dev/null";
  const Result<void> opened = SerialRadio(settings_).open();
  EXPECT_EQ(opened.code(), ErrorCode::kUnsupported);
  EXPECT_NE(opened.text().find("/dev/null: not a serial port"), std::string::npos) << opened.text();
}

}  // namespace
}  // namespace touchline::hal
