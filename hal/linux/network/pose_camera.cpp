#include "hal/linux/network/pose_camera.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <ctime>

#include "hal/linux/monotonic_clock.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {

PoseCamera::PoseCamera(const PoseCameraSettings& settings)
    : settings_(settings), name_(settings.address.text()), input_(settings.address), source_(settings.source) {}

Result<void> PoseCamera::do_open() {
  do_close();
  TOUCHLINE_TRY(input_.open());
  info_ = {};
  info_.rate_hz = settings_.rate_hz;
  const std::string_view protocol = kPoseProtocolTable[static_cast<std::size_t>(settings_.source.protocol)].word;
  info_.description = std::string("poses of ").append(protocol).append(" at ").append(name_);
  return {};
}

Result<void> PoseCamera::do_start() {
  is_running_ = true;
  return {};
}

void PoseCamera::do_close() {
  is_running_ = false;
  input_.close();
  packets_ = 0;
}

void PoseCamera::do_release(std::uint32_t buffer) noexcept { lent_[buffer] = false; }

Result<FrameLease> PoseCamera::timed_out() const {
  return failure(ErrorCode::kTimeout, "%s: no frame before the deadline%s", name_.c_str(),
                 packets_ > 0 ? "" : "; nothing has arrived yet: is the sender running, and is this its address?");
}

Result<bool> PoseCamera::receive(MergedPoses& out) {
  for (;;) {
    const Result<std::optional<ReceivedMessage>> received = input_.receive(buffer_);
    if (!received.ok()) return received.error();
    if (!received.value()) return false;
    const ReceivedMessage& message = *received.value();
    ++packets_;
    const std::uint64_t sender = std::uint64_t{message.sender} << 16U | message.port;
    const Instant arrival = MonotonicClock::read() - message.waited;
    const Result<bool> taken = source_.take({buffer_.data(), message.size}, sender, arrival, out);
    if (!taken.ok()) {
      return failure(ErrorCode::kCorruptFrame, "%s: a packet of %zu bytes from %s is malformed: %s", name_.c_str(),
                     message.size, ipv4_text(message.sender).c_str(), taken.error().text.c_str());
    }
    if (taken.value()) return true;
  }
}

Result<FrameLease> PoseCamera::do_wait(Instant deadline) {
  if (!is_running_) return failure(ErrorCode::kInconsistent, "%s: not started", name_.c_str());
  const auto free = static_cast<std::size_t>(std::find(lent_.begin(), lent_.end(), false) - lent_.begin());
  if (free == kSlots) {
    MonotonicClock::wait_for(deadline);
    return timed_out();
  }
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const bool is_complete, receive(slots_[free]));
    if (is_complete) {
      lent_[free] = true;
      Frame frame;
      frame.capture_time = slots_[free].capture_time;
      frame.sequence = source_.sequence();
      frame.sightings = &slots_[free].sightings;
      return FrameLease(*this, frame, static_cast<std::uint32_t>(free));
    }
    const Duration left = deadline - MonotonicClock::read();
    if (left <= Duration{}) return timed_out();
    pollfd watched{input_.descriptor(), POLLIN, 0};
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(left);
    const timespec timeout{static_cast<std::time_t>(whole.count()), static_cast<long>((left - whole).count())};
    if (::ppoll(&watched, 1, &timeout, nullptr) < 0 && errno != EINTR) {
      return failure(ErrorCode::kIo, "%s: waiting for a packet failed: %s", name_.c_str(), system_text(errno));
    }
  }
}

}  // namespace touchline::hal
