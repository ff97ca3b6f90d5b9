#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/time.h"
#include "tests/linux/fake_kernel.h"

namespace touchline::fake {

/// A serial port for libserialport (sp_* are wrapped), with a transmit buffer that empties at the baud rate.
class SerialPort final : public File {
 public:
  explicit SerialPort(std::string path) : path_(std::move(path)) {}

  // Properties and faults.
  std::string description = "FT232R USB UART";
  int usb_vendor = 0x0403, usb_product = 0x6001;  // -1: not a USB device
  bool is_bluetooth = false;
  std::size_t buffer_bytes = 4096;
  std::size_t chip_bytes = 0;  // bytes in the adapter, which the kernel does not count
  bool stalled = false;        // the port sends nothing
  bool flushes = true;         // false: the driver cannot drop bytes
  int open_error = 0;
  int actual_baud = 0;  // 0: as requested
  int baud_error = 0, bits_error = 0, write_error = 0;
  bool locked_by_another = false;
  bool offers_low_latency = true;  // true for FTDI adapters and most UARTs
  int read_error = 0;
  /// Makes bytes from the robots available for reading.
  void receive_from_robots(std::span<const std::byte> bytes) {
    received_.insert(received_.end(), bytes.begin(), bytes.end());
  }
  void hang_up(int error) { error_ = error; }

  // Observations.
  [[nodiscard]] const std::vector<std::byte>& wire();
  [[nodiscard]] bool is_open() const { return number_ >= 0; }
  [[nodiscard]] std::size_t waiting();
  [[nodiscard]] std::size_t flushed() const { return flushed_; }
  int baud = 0, bits = 0, parity = -1, stop_bits = 0, flow_control = -1;
  bool exclusive = false, low_latency = false;
  [[nodiscard]] const std::string& path() const { return path_; }

  int ioctl(unsigned long request, void* argument) override;
  int lock() override { return locked_by_another ? -11 : 0; }  // EWOULDBLOCK

  // Entry points of the wrapped functions. They return a value or a negative errno.
  int open_port();
  void close_port();
  int write(const std::byte* bytes, std::size_t count);
  int read(std::byte* bytes, std::size_t count);
  int output_waiting();
  int flush();
  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] int trouble() const { return error_; }

 private:
  void transmit();
  std::string path_;
  int number_ = -1;
  int error_ = 0;
  std::vector<std::byte> buffer_, wire_, received_;
  std::size_t flushed_ = 0;
  Instant sent_until_{};
};

/// All ports of the machine while it exists.
class SerialPorts {
 public:
  explicit SerialPorts(std::vector<SerialPort*> ports);
  ~SerialPorts();
  SerialPorts(const SerialPorts&) = delete;
  SerialPorts& operator=(const SerialPorts&) = delete;
  [[nodiscard]] const std::vector<SerialPort*>& all() const { return ports_; }
  [[nodiscard]] SerialPort* find(const std::string& path) const;
  int last_error = 0;
  int unfreed = 0;  // objects of the library that were not freed

 private:
  std::vector<SerialPort*> ports_;
};

}  // namespace touchline::fake
