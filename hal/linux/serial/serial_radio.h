#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "hal/device_parameters.h"
#include "hal/error_text.h"
#include "hal/packet_slot.h"
#include "hal/radio.h"

struct sp_port;

namespace touchline::hal {

/// A radio at a serial port: 8 data bits, no parity, 1 stop bit, no flow control, opened exclusively.
///
/// PacketSlot decides which packet is sent. The line counts as busy for as long as its bytes need at the baud rate, no
/// matter how many bytes the driver and the adapter buffer. The port is set to low latency if the driver supports it:
/// an FTDI adapter then delivers received bytes after 1 ms instead of 16 ms. If the port sends nothing for five
/// seconds, it returns kIo and must be reopened. close() drops unsent bytes (call drain() first): a lost port must not
/// delay the exit.
class SerialRadio final : public Radio, private ByteLine {
 public:
  explicit SerialRadio(RadioSettings settings) : settings_(std::move(settings)) {}
  ~SerialRadio() override { SerialRadio::do_close(); }
  SerialRadio(const SerialRadio&) = delete;
  SerialRadio& operator=(const SerialRadio&) = delete;

  [[nodiscard]] const std::string& description() const override { return description_; }

  [[nodiscard]] int descriptor() const override { return file_; }

  /// Packets that the port took in more than one piece.
  [[nodiscard]] std::uint64_t split_packets() const { return slot_.split_packets(); }

 private:
  Result<void> do_open() override;
  Result<void> do_send(const Packet& packet) override;
  Result<Duration> do_serve() override;
  Result<std::size_t> do_receive(std::span<std::byte> into) override;
  Result<void> do_drain(Instant deadline) override;
  void do_close() override;

  Result<void> open_port();
  Result<void> find_port();
  Result<void> claim_port();
  Result<void> configure_port();
  Result<void> check_usable();
  Result<void> check_baud();
  bool ask_for_low_latency(int file);
  Result<std::size_t> waiting() override;
  Result<std::size_t> write(std::span<const std::byte> bytes) override;
  [[nodiscard]] Duration time_of(std::size_t bytes) const { return static_cast<Duration::rep>(bytes) * byte_time_; }
  Error fail(const char* doing, int error) noexcept;
  [[nodiscard]] const char* name() const { return settings_.device.c_str(); }

  RadioSettings settings_;
  std::string description_;
  sp_port* port_ = nullptr;
  int file_ = -1;              // of the port while it is ours
  std::optional<Error> lost_;  // an error after which the port must be reopened
  PacketSlot slot_;
  Duration byte_time_{1};  // of one byte at the baud rate
  Instant free_at_{};      // when all written bytes will be sent
  std::size_t in_driver_ = 0;
  Instant moved_at_{};  // when the driver last took or sent a byte
};

}  // namespace touchline::hal
