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

/// A radio at a serial port: 8 data bits, no parity, 1 stop bit, no flow control, opened exclusively. The port may also
/// be a pseudo terminal or a serial port of Bluetooth, whose speed is not known: their driver decides when a line is
/// free.
///
/// PacketSlot decides which packet is sent. The line is busy for the time that the written bytes need at the baud rate,
/// even if the driver or the adapter buffers them. The port is set to low latency if the driver supports it: an FTDI
/// adapter then delivers received bytes after 1 ms instead of 16 ms. If the port sends nothing for five seconds, calls
/// return kIo, and it must be reopened. close() drops unsent bytes, so that a lost port does not delay the exit; call
/// drain() first to send them.
class SerialRadio final : public Radio, private ByteLine {
 public:
  explicit SerialRadio(RadioPortSettings settings) : settings_(std::move(settings)) {}
  ~SerialRadio() override { SerialRadio::do_close(); }
  SerialRadio(const SerialRadio&) = delete;
  SerialRadio& operator=(const SerialRadio&) = delete;

  [[nodiscard]] const std::string& description() const override { return description_; }

  void add_routes(std::size_t receiver, RadioRoutes& out) const override;

  /// Number of packets that the port accepted in several parts.
  [[nodiscard]] std::uint64_t split_packets() const { return slot_.split_packets(); }

 private:
  Result<void> do_open() override;
  Result<void> do_send(const Packet& packet, std::size_t receiver) override;
  Result<Duration> do_serve() override;
  Result<std::size_t> do_receive(std::span<std::byte> into, std::size_t& sender) override;
  Result<void> do_drain(Instant deadline) override;
  void do_close() override;

  Result<void> open_port();
  Result<void> open_terminal(const char* path);
  Result<void> open_uart();
  [[nodiscard]] Error refusal(int error) const;
  Result<void> claim_port(int file);
  Result<void> configure_port();
  Result<void> check_usable();
  Result<void> check_baud();
  bool request_low_latency(int file);
  Result<std::size_t> unsent_bytes() override;
  Result<std::size_t> write(std::span<const std::byte> bytes) override;
  [[nodiscard]] Duration time_of(std::size_t bytes) const { return static_cast<Duration::rep>(bytes) * byte_time_; }
  Error fail(const char* doing, int error) noexcept;
  [[nodiscard]] const char* name() const { return settings_.device.c_str(); }

  RadioPortSettings settings_;
  std::string description_;
  sp_port* port_ = nullptr;    // null: a terminal without a baud rate (terminal.h)
  int file_ = -1;              // file descriptor while the port is open
  std::optional<Error> lost_;  // an error after which the port must be reopened
  PacketSlot slot_;
  Duration byte_time_{};    // of one byte at the baud rate; 0: there is none
  Instant line_free_at_{};  // time when all written bytes will be sent
  std::size_t in_driver_ = 0;
  Instant last_progress_{};  // time when the driver last accepted or sent a byte
};

}  // namespace touchline::hal
