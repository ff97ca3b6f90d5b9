#include "hal/linux/serial/serial_radio.h"

#include <fcntl.h>
#include <libserialport.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <memory>
#include <utility>

#include "hal/linux/monotonic_clock.h"
#include "hal/linux/serial/serial_list.h"
#include "hal/linux/serial/terminal.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

// Bits on the line per byte: a start bit, eight data bits and a stop bit.
constexpr double kBitsPerByte = 10.0;
// Size of the largest transmit FIFO of common UARTs. The kernel's count does not include its bytes, which matters if
// the line is slower than its baud rate.
constexpr std::size_t kFifoBytes = 64;
// Receivers sample ten bits after one start edge, so sender and receiver may differ by about 5 % in total. This is the
// part for the sender, because receivers have an error, too.
constexpr double kMaxBaudError = 0.02;
// An adapter that sends nothing for this long has stalled, and reopening may help. It is not shorter, because reopening
// restarts many radios, and some need seconds to start.
constexpr Duration kStallTimeout = std::chrono::seconds(5);
// Poll interval of drain().
constexpr Duration kDrainPeriod = std::chrono::milliseconds(1);
// Shortest poll interval of a busy line; the kernel updates its count no more often.
constexpr Duration kMinPause = std::chrono::microseconds(500);

/// A tty that disappeared returns EIO, other devices ENODEV.
ErrorCode port_error(int error) { return error == EIO ? ErrorCode::kDisconnected : use_error(error); }

}  // namespace

Result<void> SerialRadio::do_open() {
  do_close();
  lost_.reset();
  slot_.clear();
  line_free_at_ = {};
  in_driver_ = 0;
  last_progress_ = MonotonicClock::read();
  Result<void> opened = open_port();
  if (!opened.ok()) do_close();
  return opened;
}

Result<void> SerialRadio::open_port() {
  // libserialport accepts only the kernel's names of ports. Each open() follows links such as /dev/serial/by-id/...
  // again, because an adapter may get another number when it is plugged in again.
  const std::unique_ptr<char, decltype(&std::free)> path(::realpath(name(), nullptr), &std::free);
  if (path == nullptr) {
    const int error = errno;
    const ErrorCode code = open_error(error);
    if (code == ErrorCode::kNotFound) {
      return failure(code, "%s: no such port; available ports: %s", name(), available_ports().c_str());
    }
    return failure(code, "%s: cannot be reached: %s", name(), system_text(error));
  }
  if (sp_get_port_by_name(path.get(), &port_) != SP_OK) {
    port_ = nullptr;
    return open_terminal(path.get());
  }
  if (sp_get_port_transport(port_) == SP_TRANSPORT_BLUETOOTH) {
    sp_free_port(port_);
    port_ = nullptr;
    return open_terminal(path.get());
  }
  TOUCHLINE_TRY(open_uart());
  return configure_port();
}

Result<void> SerialRadio::open_terminal(const char* path) {
  const int file = terminal::open_raw(path);
  if (file == -ENOTTY) {
    return failure(ErrorCode::kUnsupported, "%s: not a serial port; available ports: %s", name(),
                   available_ports().c_str());
  }
  if (file < 0) return refusal(-file);
  Result<void> claimed = claim_port(file);
  if (!claimed.ok()) {
    terminal::close(file);
    return claimed;
  }
  byte_time_ = {};
  description_ = std::string(name()) + ": a terminal without a baud rate (" + path + "), opened without libserialport";
  return {};
}

/// Returns the error of a port that cannot be opened.
Error SerialRadio::refusal(int error) const {
  const ErrorCode code = open_error(error);
  if (code == ErrorCode::kPermission) return permission_denied(name(), "dialout");
  if (code == ErrorCode::kDeviceBusy) return device_busy(name());
  if (error == EIO) {
    return failure(ErrorCode::kNotFound, "%s: no UART behind this port; available ports: %s", name(),
                   available_ports().c_str());
  }
  return failure(code, "%s: cannot be opened: %s", name(), system_text(error));
}

Result<void> SerialRadio::open_uart() {
  if (sp_open(port_, SP_MODE_READ_WRITE) != SP_OK) {
    const int error = sp_last_error_code();
    sp_free_port(port_);
    port_ = nullptr;
    return refusal(error);
  }
  int file = -1;
  if (sp_get_port_handle(port_, &file) != SP_OK) return fail("getting the file descriptor", sp_last_error_code());
  return claim_port(file);
}

Result<void> SerialRadio::claim_port(int file) {
  // Two programs on one radio would mix their packets. The lock excludes programs that use locks, even those of root;
  // exclusive mode excludes all other programs except those of root.
  if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return device_busy(name());
    return fail("locking", errno);
  }
  if (::ioctl(file, TIOCEXCL) != 0) return fail("setting exclusive mode", errno);
  if (::fcntl(file, F_SETFD, FD_CLOEXEC) != 0) return fail("setting close-on-exec", errno);
  file_ = file;
  return {};
}

Result<void> SerialRadio::configure_port() {
  if (sp_set_baudrate(port_, settings_.baud) != SP_OK) {
    const int error = sp_last_error_code();
    if (port_error(error) == ErrorCode::kDisconnected) return fail("setting the baud rate", error);
    return failure(ErrorCode::kUnsupported, "%s: refuses baud = %d: %s", name(), settings_.baud, system_text(error));
  }
  if (sp_set_bits(port_, 8) != SP_OK || sp_set_parity(port_, SP_PARITY_NONE) != SP_OK ||
      sp_set_stopbits(port_, 1) != SP_OK || sp_set_flowcontrol(port_, SP_FLOWCONTROL_NONE) != SP_OK) {
    return fail("setting 8N1 without flow control", sp_last_error_code());
  }
  // Flush the buffers: robots would mistake bytes of another program for a part of a packet.
  if (sp_flush(port_, SP_BUF_BOTH) != SP_OK) return fail("flushing the buffers", sp_last_error_code());

  return check_baud();
}

Result<void> SerialRadio::check_baud() {
  sp_port_config* raw = nullptr;
  if (sp_new_config(&raw) != SP_OK) return fail("reading the settings back", ENOMEM);
  const std::unique_ptr<sp_port_config, decltype(&sp_free_config)> config(raw, &sp_free_config);
  int actual = 0;
  if (sp_get_config(port_, config.get()) != SP_OK || sp_get_config_baudrate(config.get(), &actual) != SP_OK) {
    return fail("reading the settings back", sp_last_error_code());
  }
  const double error = static_cast<double>(std::abs(actual - settings_.baud)) / settings_.baud;
  if (error > kMaxBaudError) {
    return failure(ErrorCode::kUnsupported,
                   "%s: baud = %d: set to %d, which is too far off for the robots to understand", name(),
                   settings_.baud, actual);
  }
  // Assumes the slowest rate that the tolerance allows, so that no byte is taken as sent before it has left the port.
  byte_time_ = from_seconds(kBitsPerByte * (1.0 + kMaxBaudError) / actual);
  description_ = std::string(name()) + ": " + std::to_string(settings_.baud) + " baud";
  if (actual != settings_.baud) description_ += ", set to " + std::to_string(actual);
  int file = -1;
  if (sp_get_port_handle(port_, &file) == SP_OK && request_low_latency(file)) description_ += ", low latency";
  return {};
}

bool SerialRadio::request_low_latency(int file) {
  // Drivers without low-latency mode refuse one of the calls or ignore the flag.
  constexpr auto kLowLatency = static_cast<int>(ASYNC_LOW_LATENCY);
  serial_struct line{};
  if (::ioctl(file, TIOCGSERIAL, &line) != 0) return false;
  line.flags |= kLowLatency;
  if (::ioctl(file, TIOCSSERIAL, &line) != 0) return false;
  return ::ioctl(file, TIOCGSERIAL, &line) == 0 && (line.flags & kLowLatency) != 0;
}

Result<void> SerialRadio::check_usable() {
  if (lost_) return *lost_;
  if (file_ >= 0) return {};
  return failure(ErrorCode::kDisconnected, "%s: not open", name());
}

void SerialRadio::add_routes(std::size_t /*receiver*/, RadioRoutes& out) const {
  if (file_ < 0) return;
  out.push_back({.descriptor = file_, .line = {byte_time_, from_seconds(settings_.pause_s)}});
}

Result<void> SerialRadio::do_send(const Packet& packet, std::size_t receiver) {
  TOUCHLINE_TRY(check_usable());
  Result<void> sent = slot_.send(packet, receiver, *this);
  if (sent.code() == ErrorCode::kBusy && port_ == nullptr) {
    return failure(ErrorCode::kBusy, "%s: the other side does not read; a newer packet replaced an older one", name());
  }
  if (sent.code() == ErrorCode::kBusy) {
    return failure(
        ErrorCode::kBusy,
        "%s: the line is still busy; a newer packet replaced an older one; %d baud is too slow for the rate of "
        "packets, or the port has stalled",
        name(), settings_.baud);
  }
  return sent;
}

Result<Duration> SerialRadio::do_serve() {
  if (slot_.bytes() == 0) return Duration::max();
  TOUCHLINE_TRY(check_usable());
  TOUCHLINE_TRY(slot_.serve(*this));
  if (slot_.bytes() == 0) return Duration::max();
  TOUCHLINE_TRY_ASSIGN(const std::size_t before, unsent_bytes());
  return std::max(time_of(before), kMinPause);
}

Result<std::size_t> SerialRadio::do_receive(std::span<std::byte> into, std::size_t& /*sender*/) {
  TOUCHLINE_TRY(check_usable());
  if (port_ == nullptr) {
    const int count = terminal::read(file_, into);
    if (count < 0) return fail("receiving", -count);
    return static_cast<std::size_t>(count);
  }
  // An int, because the library returns counts that its enumeration does not contain.
  const int received = sp_nonblocking_read(port_, into.data(), into.size());
  if (received < 0) return fail("receiving", sp_last_error_code());
  return static_cast<std::size_t>(received);
}

/// The kernel's count does not include bytes in the device: 16 to 64 in a UART, up to a thousand in a USB adapter,
/// which at 9600 baud is a second of old packets. Therefore written bytes also count as unsent for the time that they
/// need on the line.
Result<std::size_t> SerialRadio::unsent_bytes() {
  const int bytes = port_ != nullptr ? sp_output_waiting(port_) : terminal::output_waiting(file_);
  if (bytes < 0) {
    return fail("reading the length of the output queue", port_ != nullptr ? sp_last_error_code() : -bytes);
  }
  const Instant now = MonotonicClock::read();
  const std::size_t before = std::exchange(in_driver_, static_cast<std::size_t>(bytes));
  if (in_driver_ == 0 || in_driver_ < before) last_progress_ = now;
  if (now - last_progress_ > kStallTimeout) {
    lost_ = failure(ErrorCode::kIo, "%s: the port has stalled: it sent none of %zu bytes for %.0f s", name(),
                    in_driver_, seconds(kStallTimeout));
    return *lost_;
  }
  if (byte_time_ == Duration::zero()) return in_driver_;
  const Duration left = std::max(line_free_at_ - now, Duration::zero());
  const auto on_line = static_cast<std::size_t>((left + byte_time_ - Duration(1)) / byte_time_);
  return std::max(in_driver_, on_line);
}

Result<std::size_t> SerialRadio::write(std::span<const std::byte> bytes) {
  const int taken = port_ != nullptr ? static_cast<int>(sp_nonblocking_write(port_, bytes.data(), bytes.size()))
                                     : terminal::write(file_, bytes);
  if (taken < 0) return fail("sending", port_ != nullptr ? sp_last_error_code() : -taken);
  const Instant now = MonotonicClock::read();
  line_free_at_ =
      std::max(line_free_at_, now) + time_of(static_cast<std::size_t>(taken)) + from_seconds(settings_.pause_s);
  if (taken > 0) last_progress_ = now;
  return static_cast<std::size_t>(taken);
}

Result<void> SerialRadio::do_drain(Instant deadline) {
  TOUCHLINE_TRY(check_usable());
  for (;;) {
    TOUCHLINE_TRY(slot_.serve(*this));
    TOUCHLINE_TRY_ASSIGN(const std::size_t before, unsent_bytes());
    if (slot_.bytes() + before == 0) break;
    const Instant now = MonotonicClock::read();
    if (now >= deadline) {
      return failure(ErrorCode::kTimeout, "%s: %zu bytes were not sent before the deadline", name(),
                     slot_.bytes() + before);
    }
    MonotonicClock::wait_for(std::min(deadline, now + kDrainPeriod));
  }
  MonotonicClock::wait_for(std::min(deadline, MonotonicClock::read() + time_of(kFifoBytes)));
  return {};
}

void SerialRadio::do_close() {
  const int file = std::exchange(file_, -1);
  slot_.clear();
  if (port_ == nullptr) {
    if (file >= 0) terminal::close(file);
    return;
  }
  // Without the flush, the kernel would wait up to 30 s for a blocked line. Errors of these calls do not matter here.
  static_cast<void>(sp_flush(port_, SP_BUF_OUTPUT));
  static_cast<void>(sp_close(port_));
  sp_free_port(port_);
  port_ = nullptr;
}

Error SerialRadio::fail(const char* doing, int error) noexcept {
  lost_ = device_lost(name(), "port", port_error(error), doing, error);
  return *lost_;
}

}  // namespace touchline::hal
