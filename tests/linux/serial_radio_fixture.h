#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "hal/linux/serial/serial_radio.h"
#include "tests/linux/fake_kernel.h"
#include "tests/linux/fake_serial.h"
#include "tests/results.h"

namespace touchline::testing {

using hal::RadioSettings;
using hal::SerialRadio;

inline constexpr const char* kById = "/dev/serial/by-id/usb-FTDI_FT232R_USB_UART_A1-if00-port0";

inline Packet packet(std::size_t size, int fill) {
  Packet packet;
  for (std::size_t i = 0; i < size; ++i) packet.push_back(static_cast<std::byte>(fill));
  return packet;
}

inline std::vector<std::byte> operator+(std::vector<std::byte> bytes, const Packet& packet) {
  bytes.insert(bytes.end(), packet.begin(), packet.end());
  return bytes;
}

/// A machine with /dev/ttyUSB0, which has a link by id, and /dev/ttyS0.
class SerialRadioTest : public ::testing::Test {
 protected:
  SerialRadioTest() {
    kernel_.add("/dev/ttyUSB0", adapter_);
    kernel_.add("/dev/ttyS0", on_board_);
    kernel_.link(kById, "/dev/ttyUSB0");
    on_board_.description = "ttyS0";
  }
  void TearDown() override {
    EXPECT_EQ(ports_.unfreed, 0);
    EXPECT_EQ(kernel_.open_files(), 0u);
    EXPECT_FALSE(adapter_.is_open());
  }
  static RadioSettings settings(int baud = 115200) {
    RadioSettings settings;
    settings.backend = hal::RadioBackend::kSerial;
    settings.device = kById;
    settings.baud = baud;
    return settings;
  }
  static std::string text(const std::string& rest) { return std::string(kById) + ": " + rest; }
  static void expect_refusal(const RadioSettings& settings, ErrorCode code, const std::string& reason) {
    SerialRadio radio(settings);
    expect_error(radio.open(), code, reason);
    EXPECT_EQ(radio.send(packet(4, 0)).code(), ErrorCode::kDisconnected);
  }

  fake::Kernel kernel_;
  fake::SerialPort adapter_{"/dev/ttyUSB0"}, on_board_{"/dev/ttyS0"};
  fake::SerialPorts ports_{{&on_board_, &adapter_}};
};

}  // namespace touchline::testing
