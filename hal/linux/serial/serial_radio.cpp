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
#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

// A start bit, eight data bits, a stop bit.
constexpr double kBitsPerByte = 10.0;
// The largest transmit FIFO of common UARTs. Its bytes are in no count, which matters if the line is slower than its
// baud rate.
constexpr std::size_t kFifoBytes = 64;
// Receivers sample ten bits after one start edge: the two ends may differ by about 5 % in total, and each has its own
// error.
constexpr double kMaxBaudError = 0.02;
// An adapter that sends nothing for this time hangs, and reopening it may help. Not earlier: reopening restarts many
// radios, and some need seconds to start.
constexpr Duration kStandstill = std::chrono::seconds(5);
// Poll interval of drain().
constexpr Duration kDrainPeriod = std::chrono::milliseconds(1);
// Shortest poll interval of a busy line; the kernel's count has no finer resolution.
constexpr Duration kShortestPause = std::chrono::microseconds(500);

/// A tty that disappeared returns EIO, other devices ENODEV.
ErrorCode port_error(int error) { return error == EIO ? ErrorCode::kDisconnected : use_error(error); }

}  // namespace

Result<void> SerialRadio::do_open() {
  do_close();
  lost_.reset();
  slot_.clear();
  free_at_ = {};
  in_driver_ = 0;
  moved_at_ = MonotonicClock::read();
  Result<void> opened = open_port();
  if (!opened.ok()) do_close();
  return opened;
}

Result<void> SerialRadio::open_port() {
  TOUCHLINE_TRY(find_port());
  TOUCHLINE_TRY(claim_port());
  return configure_port();
}

Result<void> SerialRadio::find_port() {
  // libserialport only knows the kernel names of ports. Links such as /dev/serial/by-id/... are followed again at each
  // open(), because an adapter that is plugged in again may have another number.
  const std::unique_ptr<char, decltype(&std::free)> path(::realpath(name(), nullptr), &std::free);
  if (path == nullptr) {
    const int error = errno;
    const ErrorCode code = open_error(error);
    if (code == ErrorCode::kNotFound) {
      return failure(code, "%s: no such port; ports here: %s", name(), ports_here().c_str());
    }
    return failure(code, "%s: cannot be reached: %s", name(), system_text(error));
  }
  if (sp_get_port_by_name(path.get(), &port_) != SP_OK) {
    port_ = nullptr;
    return failure(ErrorCode::kUnsupported, "%s: not a serial port; ports here: %s", name(), ports_here().c_str());
  }
  return {};
}

Result<void> SerialRadio::claim_port() {
  if (sp_open(port_, SP_MODE_READ_WRITE) != SP_OK) {
    const int error = sp_last_error_code();
    sp_free_port(port_);
    port_ = nullptr;
    const ErrorCode code = open_error(error);
    if (code == ErrorCode::kPermission) return permission_denied(name(), "dialout");
    if (code == ErrorCode::kDeviceBusy) return device_busy(name());
    if (error == EIO) {
      return failure(ErrorCode::kNotFound, "%s: no UART behind this port; ports here: %s", name(),
                     ports_here().c_str());
    }
    return failure(code, "%s: cannot be opened: %s", name(), system_text(error));
  }
  int file = -1;
  if (sp_get_port_handle(port_, &file) != SP_OK) return fail("asking for the port's file", sp_last_error_code());
  // Two programs on one radio would mix their packets. The lock excludes all programs that lock, also those of root;
  // exclusive mode excludes all others but root.
  if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return device_busy(name());
    return fail("locking", errno);
  }
  if (::ioctl(file, TIOCEXCL) != 0) return fail("claiming", errno);
  if (::fcntl(file, F_SETFD, FD_CLOEXEC) != 0) return fail("claiming", errno);
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
  // Bytes that another program left in the buffers would be half a packet for the robots.
  if (sp_flush(port_, SP_BUF_BOTH) != SP_OK) return fail("emptying", sp_last_error_code());

  return check_baud();
}

Result<void> SerialRadio::check_baud() {
  sp_port_config* raw = nullptr;
  if (sp_new_config(&raw) != SP_OK) return fail("reading the settings back", ENOMEM);
  const std::unique_ptr<sp_port_config, decltype(&sp_free_config)> config(raw, &sp_free_config);
  int granted = 0;
  if (sp_get_config(port_, config.get()) != SP_OK || sp_get_config_baudrate(config.get(), &granted) != SP_OK) {
    return fail("reading the settings back", sp_last_error_code());
  }
  const double error = static_cast<double>(std::abs(granted - settings_.baud)) / settings_.baud;
  if (error > kMaxBaudError) {
    return failure(ErrorCode::kUnsupported,
                   "%s: baud = %d: set to %d, which is too far off for the robots to understand", name(),
                   settings_.baud, granted);
  }
  // The slowest allowed rate, so that the estimate is never ahead of the line.
  byte_time_ = from_seconds(kBitsPerByte * (1.0 + kMaxBaudError) / granted);
  description_ = std::string(name()) + ": " + std::to_string(settings_.baud) + " baud";
  if (granted != settings_.baud) description_ += ", set to " + std::to_string(granted);
  int file = -1;
  if (sp_get_port_handle(port_, &file) == SP_OK && ask_for_low_latency(file)) description_ += ", low latency";
  return {};
}

bool SerialRadio::ask_for_low_latency(int file) {
  // Drivers without low latency refuse one of the calls or ignore the flag.
  constexpr auto kLowLatency = static_cast<int>(ASYNC_LOW_LATENCY);
  serial_struct line{};
  if (::ioctl(file, TIOCGSERIAL, &line) != 0) return false;
  line.flags |= kLowLatency;
  if (::ioctl(file, TIOCSSERIAL, &line) != 0) return false;
  return ::ioctl(file, TIOCGSERIAL, &line) == 0 && (line.flags & kLowLatency) != 0;
}

Result<void> SerialRadio::check_usable() {
  if (lost_) return *lost_;
  if (port_ != nullptr) return {};
  return failure(ErrorCode::kDisconnected, "%s: not open", name());
}

Result<void> SerialRadio::do_send(const Packet& packet) {
  TOUCHLINE_TRY(check_usable());
  Result<void> sent = slot_.send(packet, *this);
  if (sent.code() == ErrorCode::kBusy) {
    return failure(
        ErrorCode::kBusy,
        "%s: the line is still busy, an older packet was dropped for a newer one; %d baud is too slow for the rate of "
        "packets, or the port stands still",
        name(), settings_.baud);
  }
  return sent;
}

Result<Duration> SerialRadio::do_serve() {
  if (slot_.bytes() == 0) return Duration::max();
  TOUCHLINE_TRY(check_usable());
  TOUCHLINE_TRY(slot_.serve(*this));
  if (slot_.bytes() == 0) return Duration::max();
  TOUCHLINE_TRY_ASSIGN(const std::size_t before, waiting());
  return std::max(time_of(before), kShortestPause);
}

Result<std::size_t> SerialRadio::do_receive(std::span<std::byte> into) {
  TOUCHLINE_TRY(check_usable());
  // An int, because the library returns counts that its enumeration does not contain.
  const int received = sp_nonblocking_read(port_, into.data(), into.size());
  if (received < 0) return fail("receiving", sp_last_error_code());
  return static_cast<std::size_t>(received);
}

/// The kernel's count does not contain bytes in the device: 16 to 64 in a UART, up to a thousand in a USB adapter,
/// which at 9600 baud is a second of old packets. Therefore the time that the bytes need on the line also counts.
Result<std::size_t> SerialRadio::waiting() {
  const int bytes = sp_output_waiting(port_);
  if (bytes < 0) return fail("asking what waits", sp_last_error_code());
  const Instant now = MonotonicClock::read();
  const std::size_t before = std::exchange(in_driver_, static_cast<std::size_t>(bytes));
  if (in_driver_ == 0 || in_driver_ < before) moved_at_ = now;
  if (now - moved_at_ > kStandstill) {
    lost_ = failure(ErrorCode::kIo, "%s: the port stands still: %zu bytes have not left for %.0f s", name(), in_driver_,
                    seconds(kStandstill));
    return *lost_;
  }
  const Duration left = std::max(free_at_ - now, Duration::zero());
  const auto on_line = static_cast<std::size_t>((left + byte_time_ - Duration(1)) / byte_time_);
  return std::max(in_driver_, on_line);
}

Result<std::size_t> SerialRadio::write(std::span<const std::byte> bytes) {
  const int taken = sp_nonblocking_write(port_, bytes.data(), bytes.size());
  if (taken < 0) return fail("sending", sp_last_error_code());
  const Instant now = MonotonicClock::read();
  free_at_ = std::max(free_at_, now) + time_of(static_cast<std::size_t>(taken));
  if (taken > 0) moved_at_ = now;
  return static_cast<std::size_t>(taken);
}

Result<void> SerialRadio::do_drain(Instant deadline) {
  TOUCHLINE_TRY(check_usable());
  for (;;) {
    TOUCHLINE_TRY(slot_.serve(*this));
    TOUCHLINE_TRY_ASSIGN(const std::size_t before, waiting());
    if (slot_.bytes() + before == 0) break;
    const Instant now = MonotonicClock::read();
    if (now >= deadline) {
      return failure(ErrorCode::kTimeout, "%s: %zu bytes have not left before the deadline", name(),
                     slot_.bytes() + before);
    }
    MonotonicClock::wait_for(std::min(deadline, now + kDrainPeriod));
  }
  MonotonicClock::wait_for(std::min(deadline, MonotonicClock::read() + time_of(kFifoBytes)));
  return {};
}

void SerialRadio::do_close() {
  file_ = -1;
  if (port_ == nullptr) return;
  // Otherwise the kernel waits up to 30 s for a line that is blocked. Errors of these calls do not matter here.
  static_cast<void>(sp_flush(port_, SP_BUF_OUTPUT));
  static_cast<void>(sp_close(port_));
  sp_free_port(port_);
  port_ = nullptr;
  slot_.clear();
}

Error SerialRadio::fail(const char* doing, int error) noexcept {
  lost_ = device_lost(name(), "port", port_error(error), doing, error);
  return *lost_;
}

}  // namespace touchline::hal
