#include "hal/linux/network/remote_camera.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <ctime>

#include "hal/linux/monotonic_clock.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

using std::chrono::milliseconds;

// A sender answers a connection at once; a lost packet is sent again after 1 s.
constexpr int kConnectPatience_ms = 2000;
// In lock-step the sender renders the picture, and waits for the packets of the last one, before it answers. An
// emulated computer can need seconds.
constexpr Duration kPicturePatience = std::chrono::seconds(20);
// The loop's other work, such as the end of the program, goes on at this rate while a sender in lock-step is silent.
constexpr Duration kSilentPause = milliseconds(500);

const char* word_of(CameraFormat format) { return kCameraFormats[static_cast<std::size_t>(format)].word.data(); }

}  // namespace

RemoteCamera::RemoteCamera(const TcpAddress& address, const CameraSettings& settings, FrameClock* lockstep)
    : address_(address), settings_(settings), lockstep_(lockstep), name_(address.text()) {}

Result<void> RemoteCamera::do_open() {
  do_close();
  TOUCHLINE_TRY_ASSIGN(socket_, connect_tcp(address_, kConnectPatience_ms));
  Result<void> greeted = receive_hello();
  if (!greeted.ok()) do_close();
  return greeted;
}

Result<void> RemoteCamera::receive_hello() {
  StreamHelloBytes bytes{};
  const Instant end = MonotonicClock::read() + milliseconds(kConnectPatience_ms);
  for (std::size_t received = 0; received < bytes.size();) {
    TOUCHLINE_TRY_ASSIGN(const std::size_t more, receive_some(std::span(bytes).subspan(received)));
    received += more;
    if (more > 0) continue;
    const Duration left = end - MonotonicClock::read();
    if (left <= Duration{}) {
      return failure(ErrorCode::kNotFound, "%s: connected, but the program there does not send pictures",
                     name_.c_str());
    }
    TOUCHLINE_TRY(wait_for_bytes(left));
  }
  const Result<StreamHello> hello = parse_stream_hello(bytes);
  if (!hello.ok()) return prefixed(name_, hello.error());
  TOUCHLINE_TRY(check_hello(hello.value()));
  info_ = {};
  info_.format = pixel_format(settings_.format);
  info_.width_px = settings_.width_px;
  info_.height_px = settings_.height_px;
  info_.rate_hz = hello.value().rate_mhz / 1000.0;
  ErrorText text;
  text.set("%s: %s %ux%u at %.4g Hz%s", name_.c_str(), word_of(settings_.format), unsigned{info_.width_px},
           unsigned{info_.height_px}, info_.rate_hz, lockstep_ != nullptr ? ", in lock-step" : "");
  info_.description = text.str();
  if (settings_.format == CameraFormat::kMjpg) {
    decoder_.open(info_.width_px, info_.height_px);
    layout_ = decoder_.layout();
  } else {
    layout_ = picture_layout(info_.format, info_.width_px, info_.height_px);
  }
  // One more, because the next picture arrives while the others wait or are in use.
  slots_.resize(static_cast<std::size_t>(settings_.buffers) + 1);
  for (Slot& slot : slots_) {
    slot.bytes.resize(largest_picture(settings_.format, info_.width_px, info_.height_px));
    if (settings_.format == CameraFormat::kMjpg) slot.decoded.resize(layout_.bytes);
    slot.state = SlotState::kFree;
  }
  return {};
}

Result<void> RemoteCamera::check_hello(const StreamHello& hello) const {
  if (hello.format != settings_.format || hello.width_px != settings_.width_px ||
      hello.height_px != settings_.height_px) {
    return failure(ErrorCode::kUnsupported,
                   "%s: sends %s %ux%u; camera.format, width_px and height_px ask for %s %ux%u", name_.c_str(),
                   word_of(hello.format), unsigned{hello.width_px}, unsigned{hello.height_px},
                   word_of(settings_.format), unsigned{settings_.width_px}, unsigned{settings_.height_px});
  }
  if (std::abs(hello.rate_mhz / 1000.0 - settings_.rate_hz) > 0.005 * settings_.rate_hz) {
    return failure(ErrorCode::kUnsupported, "%s: sends %.4g pictures per second; camera.rate_hz is %.4g", name_.c_str(),
                   hello.rate_mhz / 1000.0, settings_.rate_hz);
  }
  if (hello.lockstep == (lockstep_ != nullptr)) return {};
  return failure(ErrorCode::kUnsupported,
                 hello.lockstep ? "%s: sends in lock-step; set camera.lockstep = true, or serve without --lockstep"
                                : "%s: sends in real time; set camera.lockstep = false, or serve with --lockstep",
                 name_.c_str());
}

Result<void> RemoteCamera::do_start() {
  if (!socket_.is_open()) return failure(ErrorCode::kInconsistent, "%s: not open", name_.c_str());
  is_running_ = true;
  if (lockstep_ != nullptr) {
    lockstep_->set_driven(true);
    return {};
  }
  // Pictures since the connection are old: a program needs up to a second from open() to start(). The limit is for a
  // sender that is faster than this loop.
  constexpr int kMaxOldRounds = 100;
  for (int i = 0; i < kMaxOldRounds; ++i) {
    TOUCHLINE_TRY(receive_pictures());
    if (!oldest_ready()) break;
    for (Slot& slot : slots_) {
      if (slot.state == SlotState::kReady) slot.state = SlotState::kFree;
    }
  }
  return {};
}

void RemoteCamera::do_close() {
  is_running_ = is_requested_ = false;
  if (lockstep_ != nullptr) lockstep_->set_driven(false);
  socket_.reset();
  filling_.reset();
  header_bytes_ = picture_bytes_ = 0;
  offset_.reset();
  estimate_ = {};
  lost_.reset();
}

void RemoteCamera::do_release(std::uint32_t buffer) noexcept { slots_[buffer].state = SlotState::kFree; }

Error RemoteCamera::lose(const char* why) {
  lost_ = failure(ErrorCode::kDisconnected, "%s: %s", name_.c_str(), why);
  if (lockstep_ != nullptr) lockstep_->set_driven(false);
  return *lost_;
}

/// Returns the number of bytes received; 0: none at the moment.
Result<std::size_t> RemoteCamera::receive_some(std::span<std::byte> into) {
  for (;;) {
    const ssize_t count = ::recv(socket_.get(), into.data(), into.size(), MSG_DONTWAIT);
    if (count > 0) return static_cast<std::size_t>(count);
    if (count == 0) return lose("the sender of the pictures has closed the connection");
    if (errno == EAGAIN) return std::size_t{0};
    if (errno != EINTR) return lose(system_text(errno));
  }
}

std::optional<std::size_t> RemoteCamera::oldest_ready() const {
  std::optional<std::size_t> oldest;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const bool is_older = slots_[i].state == SlotState::kReady && (!oldest || slots_[i].order < slots_[*oldest].order);
    if (is_older) oldest = i;
  }
  return oldest;
}

/// Chooses the memory for the next picture: a free slot, else that of the oldest picture, which is lost. Returns false
/// if all are lent.
bool RemoteCamera::choose_slot() {
  const auto free =
      std::find_if(slots_.begin(), slots_.end(), [](const Slot& s) { return s.state == SlotState::kFree; });
  filling_ = free != slots_.end() ? std::optional(static_cast<std::size_t>(free - slots_.begin())) : oldest_ready();
  if (filling_) slots_[*filling_].state = SlotState::kFilling;
  return filling_.has_value();
}

/// Receives what has arrived, at most as many pictures as there are slots.
Result<void> RemoteCamera::receive_pictures() {
  for (std::size_t complete = 0; complete < slots_.size();) {
    if (!filling_ && !choose_slot()) return {};
    Slot& slot = slots_[*filling_];
    if (header_bytes_ < header_.size()) {
      TOUCHLINE_TRY_ASSIGN(const std::size_t more, receive_some(std::span(header_).subspan(header_bytes_)));
      if (more == 0) return {};
      header_bytes_ += more;
      if (header_bytes_ < header_.size()) continue;
      const Result<PictureHeader> header = parse_picture_header(header_, slot.bytes.size());
      if (!header.ok()) return lose(header.error().text.c_str());
      slot.header = header.value();
      if (settings_.format != CameraFormat::kMjpg && slot.header.bytes != layout_.bytes) {
        return lose("a picture has another size than its format");
      }
      slot.arrival = MonotonicClock::read();
      picture_bytes_ = 0;
      continue;
    }
    const std::span rest = std::span(slot.bytes).first(slot.header.bytes).subspan(picture_bytes_);
    TOUCHLINE_TRY_ASSIGN(const std::size_t more, receive_some(std::as_writable_bytes(rest)));
    if (more == 0) return {};
    picture_bytes_ += more;
    if (picture_bytes_ < slot.header.bytes) continue;
    slot.state = SlotState::kReady;
    slot.order = received_++;
    filling_.reset();
    header_bytes_ = 0;
    ++complete;
  }
  return {};
}

Result<bool> RemoteCamera::wait_for_bytes(Duration patience) {
  pollfd watched{socket_.get(), POLLIN, 0};
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(patience);
  const timespec timeout{static_cast<std::time_t>(whole.count()), static_cast<long>((patience - whole).count())};
  const int ready = ::ppoll(&watched, 1, &timeout, nullptr);
  if (ready >= 0 || errno == EINTR) return ready > 0;
  return failure(ErrorCode::kIo, "%s: waiting for a picture failed: %s", name_.c_str(), system_text(errno));
}

Result<FrameLease> RemoteCamera::do_wait(Instant deadline) {
  if (lost_) return *lost_;
  if (!is_running_) return failure(ErrorCode::kInconsistent, "%s: not started", name_.c_str());
  return lockstep_ != nullptr ? wait_in_lockstep(deadline) : wait_in_real_time(deadline);
}

Result<FrameLease> RemoteCamera::wait_in_real_time(Instant deadline) {
  for (;;) {
    // Pictures that arrived before the connection ended are handed out.
    const Result<void> received = receive_pictures();
    if (const std::optional<std::size_t> oldest = oldest_ready()) return deliver(*oldest);
    if (!received.ok()) return received.error();
    const Duration left = deadline - MonotonicClock::read();
    if (left <= Duration{}) {
      return failure(ErrorCode::kTimeout, "%s: no frame before the deadline", name_.c_str());
    }
    if (!filling_ && !choose_slot()) {
      MonotonicClock::wait_for(deadline);  // all buffers are in use
      continue;
    }
    TOUCHLINE_TRY(wait_for_bytes(left));
  }
}

/// The time at which a picture was in the sender's memory, on the FrameClock. The first one arrives now.
Instant RemoteCamera::ready_time(const PictureHeader& header) {
  const Duration ready = std::chrono::nanoseconds(header.ready_ns);
  if (!offset_) offset_ = lockstep_->now().time_since_epoch() - ready;
  return Instant(ready + *offset_);
}

Result<FrameLease> RemoteCamera::wait_in_lockstep(Instant deadline) {
  std::optional<std::size_t> oldest = oldest_ready();
  if (!oldest) {
    TOUCHLINE_TRY(request_picture());
    const Instant pause = MonotonicClock::read() + kSilentPause;
    for (;;) {
      TOUCHLINE_TRY(receive_pictures());
      oldest = oldest_ready();
      const Instant now = MonotonicClock::read();
      if (oldest || now >= pause) break;
      TOUCHLINE_TRY(wait_for_bytes(pause - now));
    }
    if (!oldest && MonotonicClock::read() - requested_ > kPicturePatience) {
      return lose("the sender in lock-step has not sent the next picture for 20 s");
    }
    if (!oldest) return failure(ErrorCode::kTimeout, "%s: the sender has not sent the picture yet", name_.c_str());
  }
  const Instant ready = ready_time(slots_[*oldest].header);
  lockstep_->advance_to(std::min(ready, deadline));
  if (ready <= deadline) return deliver(*oldest);
  return failure(ErrorCode::kTimeout, "%s: no frame before the deadline", name_.c_str());
}

Result<void> RemoteCamera::request_picture() {
  if (is_requested_) return {};
  if (::send(socket_.get(), &kNextPicture, 1, MSG_DONTWAIT | MSG_NOSIGNAL) != 1) return lose(system_text(errno));
  is_requested_ = true;
  requested_ = MonotonicClock::read();
  return {};
}

Result<FrameLease> RemoteCamera::deliver(std::size_t index) {
  Slot& slot = slots_[index];
  const PictureHeader& header = slot.header;
  slot.state = SlotState::kLent;
  is_requested_ = false;
  Frame frame;
  frame.format = info_.format;
  frame.width_px = info_.width_px;
  frame.height_px = info_.height_px;
  frame.stride_bytes = layout_.stride_bytes;
  frame.sequence = header.sequence;
  if (lockstep_ != nullptr) {
    frame.capture_time = ready_time(header) - std::chrono::nanoseconds(header.ready_ns - header.captured_ns);
  } else {
    const auto in_seconds = [](std::int64_t time_ns) { return seconds(std::chrono::nanoseconds(time_ns)); };
    frame.capture_time =
        estimate_.capture_time(in_seconds(header.captured_ns), in_seconds(header.sent_ns), slot.arrival);
  }
  const bool is_jpeg = settings_.format == CameraFormat::kMjpg;
  const std::uint8_t* const pixels = is_jpeg ? slot.decoded.data() : slot.bytes.data();
  for (std::size_t i = 0; i < info_of(frame.format).planes; ++i) frame.plane[i] = pixels + layout_.offset_bytes[i];
  FrameLease lease(*this, frame, static_cast<std::uint32_t>(index));
  if (header.truth.is_known) lease.set_truth(&header.truth);
  if (!is_jpeg) return lease;
  lease.set_jpeg({slot.bytes.data(), header.bytes});
  if (const Result<void> decoded = decoder_.decode(lease.jpeg(), slot.decoded.data()); !decoded.ok()) {
    return failure(decoded.code(), "%s: frame %u cannot be decoded: %s", name_.c_str(), frame.sequence,
                   decoded.error().text.c_str());
  }
  return lease;
}

}  // namespace touchline::hal
