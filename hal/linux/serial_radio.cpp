#include "hal/linux/serial_radio.h"

#include <fcntl.h>
#include <libserialport.h>
#include <sys/file.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <memory>

#include "hal/linux/monotonic_clock.h"
#include "hal/linux/serial_list.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

// One packet on the wire and one behind it.
constexpr std::size_t kMaxWaitingBytes = 2 * kMaxPacketBytes;
// A start bit, eight data bits, a stop bit.
constexpr int kBitsPerByte = 10;
// The largest transmit FIFO of common UARTs; the kernel's count of waiting bytes leaves it out.
constexpr int kFifoBytes = 64;
// Receivers sample ten bits from one start edge: the two ends may differ by about 5 % in all, and each has its own
// error.
constexpr double kMaxBaudError = 0.02;
// Between looks at the output while draining.
constexpr Duration kDrainPeriod = std::chrono::milliseconds(1);

/// A disappeared tty answers EIO where other devices answer ENODEV.
ErrorCode port_error(int error) { return error == EIO ? ErrorCode::kDisconnected : use_error(error); }

}  // namespace

Status SerialRadio::do_open() {
  do_close();
  reason_.clear();
  lost_ = ErrorCode::kOk;
  rest_begin_ = rest_end_ = 0;
  Status status = find_port();
  if (status.ok()) status = claim_port();
  if (status.ok()) status = configure_port();
  if (!status.ok()) do_close();
  return status;
}

Status SerialRadio::find_port() {
  // libserialport knows ports by their kernel names only; links such as /dev/serial/by-id/... are followed anew at each
  // opening, so that a plugged-in-again adapter may have another number.
  const std::unique_ptr<char, decltype(&std::free)> path(::realpath(name(), nullptr), &std::free);
  if (path == nullptr) {
    const int error = errno;
    const ErrorCode code = open_error(error);
    if (code == ErrorCode::kNotFound) {
      reason_.set("%s: no such port; ports here: %s", name(), ports_here().c_str());
    } else {
      reason_.set("%s: cannot be reached: %s", name(), system_text(error));
    }
    return code;
  }
  if (sp_get_port_by_name(path.get(), &port_) != SP_OK) {
    port_ = nullptr;
    reason_.set("%s: not a serial port; ports here: %s", name(), ports_here().c_str());
    return ErrorCode::kUnsupported;
  }
  return {};
}

Status SerialRadio::claim_port() {
  if (sp_open(port_, SP_MODE_READ_WRITE) != SP_OK) {
    const int error = sp_last_error_code();
    sp_free_port(port_);
    port_ = nullptr;
    const ErrorCode code = open_error(error);
    if (code == ErrorCode::kPermission) return say_denied(reason_, name(), "dialout");
    if (code == ErrorCode::kDeviceBusy) return say_busy(reason_, name());
    if (error == EIO) {
      reason_.set("%s: no UART behind this port; ports here: %s", name(), ports_here().c_str());
      return ErrorCode::kNotFound;
    }
    reason_.set("%s: cannot be opened: %s", name(), system_text(error));
    return code;
  }
  int file = -1;
  if (sp_get_port_handle(port_, &file) != SP_OK) return fail("asking for the port's file", sp_last_error_code());
  // Two programs on one radio send each other's robots astray. The lock keeps out those who lock, whoever they are; the
  // exclusive mode keeps out everybody but root.
  if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return say_busy(reason_, name());
    return fail("locking", errno);
  }
  if (::ioctl(file, TIOCEXCL) != 0) return fail("claiming", errno);
  if (::fcntl(file, F_SETFD, FD_CLOEXEC) != 0) return fail("claiming", errno);
  return {};
}

Status SerialRadio::configure_port() {
  if (sp_set_baudrate(port_, settings_.baud) != SP_OK) {
    const int error = sp_last_error_code();
    if (port_error(error) == ErrorCode::kDisconnected) return fail("setting the baud rate", error);
    reason_.set("%s: refuses baud = %d: %s", name(), settings_.baud, system_text(error));
    return ErrorCode::kUnsupported;
  }
  if (sp_set_bits(port_, 8) != SP_OK || sp_set_parity(port_, SP_PARITY_NONE) != SP_OK ||
      sp_set_stopbits(port_, 1) != SP_OK || sp_set_flowcontrol(port_, SP_FLOWCONTROL_NONE) != SP_OK) {
    return fail("setting 8N1 without flow control", sp_last_error_code());
  }
  // Bytes that another program left there would be half a packet to the robots.
  if (sp_flush(port_, SP_BUF_BOTH) != SP_OK) return fail("emptying", sp_last_error_code());

  sp_port_config* raw = nullptr;
  if (sp_new_config(&raw) != SP_OK) return fail("reading the settings back", ENOMEM);
  const std::unique_ptr<sp_port_config, decltype(&sp_free_config)> config(raw, &sp_free_config);
  int granted = 0;
  if (sp_get_config(port_, config.get()) != SP_OK || sp_get_config_baudrate(config.get(), &granted) != SP_OK) {
    return fail("reading the settings back", sp_last_error_code());
  }
  const double error = static_cast<double>(std::abs(granted - settings_.baud)) / settings_.baud;
  if (error > kMaxBaudError) {
    reason_.set("%s: baud = %d: granted %d, which is too far off for the robots to understand", name(), settings_.baud,
                granted);
    return ErrorCode::kUnsupported;
  }
  if (granted != settings_.baud) reason_.set("%s: baud = %d: granted %d", name(), settings_.baud, granted);
  return {};
}

Status SerialRadio::check_usable() {
  if (lost_ != ErrorCode::kOk) return lost_;
  if (port_ != nullptr) return {};
  reason_.set("%s: not open", name());
  return ErrorCode::kDisconnected;
}

Status SerialRadio::do_send(std::span<const std::byte> bytes) {
  if (const Status status = check_usable(); !status.ok()) return status;
  if (bytes.size() > kMaxPacketBytes) {
    reason_.set("%s: a packet of %zu bytes; at most %zu are possible", name(), bytes.size(), kMaxPacketBytes);
    return ErrorCode::kOutOfRange;
  }
  if (!finish_split_packet()) {
    if (lost_ != ErrorCode::kOk) return lost_;
    reason_.set("%s: the port has not yet taken the rest of the packet before", name());
    return ErrorCode::kBusy;
  }
  const int waiting = sp_output_waiting(port_);
  if (waiting < 0) return fail("asking what waits", sp_last_error_code());
  if (static_cast<std::size_t>(waiting) + bytes.size() > kMaxWaitingBytes) {
    reason_.set(
        "%s: %d bytes still wait to be sent; %d baud is too slow for the rate of packets, or the port stands still",
        name(), waiting, settings_.baud);
    return ErrorCode::kBusy;
  }
  const int taken = write_some(bytes);
  if (taken < 0) return lost_;
  if (taken == 0 && !bytes.empty()) {
    reason_.set("%s: the port's buffer is full", name());
    return ErrorCode::kBusy;
  }
  if (static_cast<std::size_t>(taken) < bytes.size()) {
    ++split_packets_;
    const std::span<const std::byte> rest = bytes.subspan(static_cast<std::size_t>(taken));
    std::copy(rest.begin(), rest.end(), rest_.begin());
    rest_begin_ = 0;
    rest_end_ = rest.size();
  }
  return {};
}

int SerialRadio::write_some(std::span<const std::byte> bytes) {
  // Into an int at once: the library returns counts that its enum has no values for.
  const int taken = sp_nonblocking_write(port_, bytes.data(), bytes.size());
  if (taken < 0) static_cast<void>(fail("sending", sp_last_error_code()));
  return taken;
}

bool SerialRadio::finish_split_packet() {
  if (rest_begin_ == rest_end_) return true;
  const int taken = write_some(std::span(rest_).subspan(rest_begin_, rest_end_ - rest_begin_));
  if (taken > 0) rest_begin_ += static_cast<std::size_t>(taken);
  return rest_begin_ == rest_end_;
}

Status SerialRadio::do_drain(Instant deadline) {
  if (const Status status = check_usable(); !status.ok()) return status;
  for (;;) {
    const bool finished = finish_split_packet();
    if (lost_ != ErrorCode::kOk) return lost_;
    const int waiting = sp_output_waiting(port_);
    if (waiting < 0) return fail("asking what waits", sp_last_error_code());
    if (finished && waiting == 0) break;
    const Instant now = MonotonicClock::read();
    if (now >= deadline) {
      reason_.set("%s: %zu bytes have not left before the deadline", name(),
                  static_cast<std::size_t>(waiting) + (rest_end_ - rest_begin_));
      return ErrorCode::kTimeout;
    }
    MonotonicClock::wait_for(std::min(deadline, now + kDrainPeriod));
  }
  const Duration fifo = from_seconds(static_cast<double>(kFifoBytes * kBitsPerByte) / settings_.baud);
  MonotonicClock::wait_for(std::min(deadline, MonotonicClock::read() + fifo));
  return {};
}

void SerialRadio::do_close() {
  if (port_ == nullptr) return;
  // Else the kernel waits up to 30 s for a line that stands still. Neither call can fail in a way that matters here.
  static_cast<void>(sp_flush(port_, SP_BUF_OUTPUT));
  static_cast<void>(sp_close(port_));
  sp_free_port(port_);
  port_ = nullptr;
}

ErrorCode SerialRadio::fail(const char* doing, int error) noexcept {
  lost_ = port_error(error);
  return say_lost(reason_, name(), "port", lost_, doing, error);
}

}  // namespace touchline::hal
