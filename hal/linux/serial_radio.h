#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "hal/device_parameters.h"
#include "hal/linux/reason.h"
#include "hal/radio.h"

struct sp_port;

namespace touchline::hal {

/// A radio behind a serial port: 8 data bits, no parity, 1 stop bit, no flow control, for us alone.
///
/// Commands are perishable, so that little may wait: send() refuses with kBusy what would leave more than one whole
/// packet waiting behind the one being sent. A packet of which the port took only a part is completed before anything
/// else is sent: the receiver never sees half a packet followed by another.
/// close() drops what has not left (drain() first): a port that is gone must not hold up the exit.
class SerialRadio final : public Radio {
 public:
  explicit SerialRadio(RadioSettings settings) : settings_(std::move(settings)) {}
  ~SerialRadio() override { SerialRadio::do_close(); }
  SerialRadio(const SerialRadio&) = delete;
  SerialRadio& operator=(const SerialRadio&) = delete;

  [[nodiscard]] const std::string& reason() const override { return reason_.text(); }

  /// Packets that the port took in more than one piece.
  [[nodiscard]] std::uint64_t split_packets() const { return split_packets_; }

 private:
  Status do_open() override;
  Status do_send(std::span<const std::byte> bytes) override;
  Status do_drain(Instant deadline) override;
  void do_close() override;

  Status find_port();
  Status claim_port();
  Status configure_port();
  Status check_usable();
  /// Bytes taken, at most all; a negative number is an error that fail() has told.
  int write_some(std::span<const std::byte> bytes);
  /// True when nothing of an earlier packet is left to be written.
  bool finish_split_packet();
  ErrorCode fail(const char* doing, int error) noexcept;
  [[nodiscard]] const char* name() const { return settings_.device.c_str(); }

  RadioSettings settings_;
  Reason reason_;
  sp_port* port_ = nullptr;
  ErrorCode lost_ = ErrorCode::kOk;                // an error after which only opening again helps
  std::array<std::byte, kMaxPacketBytes> rest_{};  // of a packet that the port took only a part of
  std::size_t rest_begin_ = 0, rest_end_ = 0;
  std::uint64_t split_packets_ = 0;
};

}  // namespace touchline::hal
