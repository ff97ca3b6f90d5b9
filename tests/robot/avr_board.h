#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <vector>

namespace touchline::testing {

/// Instead of a PWM value: forward and backward at the same time, or a PWM value without a direction.
constexpr int kContradiction = 1000;

/// What the pins of the sketch arduino_robot tell a motor driver: the PWM value, negative backward. 0: all pins are
/// low.
struct MotorPins {
  int left = 0, right = 0;
  friend bool operator==(const MotorPins&, const MotorPins&) = default;
  friend void PrintTo(const MotorPins& pins, std::ostream* out) { *out << pins.left << " and " << pins.right; }
};

/// An Arduino Uno: an ATmega328P with 16 MHz, simulated by simavr instruction by instruction. Time is virtual.
class AvrBoard {
 public:
  /// `flash`: a file with the bytes of the flash memory. Runs until the sketch has opened its serial port.
  explicit AvrBoard(const std::string& flash, int baud = 115200);
  AvrBoard(const AvrBoard&) = delete;
  AvrBoard& operator=(const AvrBoard&) = delete;
  ~AvrBoard();

  void run_us(std::int64_t time_us);
  /// Queues bytes for the serial port's line, without a gap after those that are still queued.
  void send(std::span<const std::byte> bytes);
  /// The same; then runs until the last byte has arrived and the sketch had 1.5 ms to react:
  /// the checksum of eleven robots takes it up to 0.4 ms, the second payload of an nRF24 up to 1.1 ms.
  void send_all(std::span<const std::byte> bytes);
  [[nodiscard]] MotorPins motors() const;
  /// Returns and forgets the bytes that the sketch has sent, and when each of them was written.
  struct SentByte {
    std::byte value{};
    std::int64_t time_us = 0;
  };
  std::vector<SentByte> take_sent() { return std::move(sent_); }
  /// Sets the voltage at A0.
  void set_a0(unsigned millivolts);
  [[nodiscard]] std::int64_t now_us() const;

 private:
  struct Simulator;
  std::unique_ptr<Simulator> simulator_;
  std::deque<std::byte> line_;
  std::vector<SentByte> sent_;
};

}  // namespace touchline::testing
