#include "firmware/recording/step_tap.h"

#include <algorithm>
#include <cstring>

#include "hal/linux/monotonic_clock.h"

namespace touchline::recording {
namespace {

// Steps without pictures have 20 KB: an eighth of the preset memory (64 MB) holds them for 6 s at 60 Hz, one of the
// smallest (8 MB) for 0.8 s. A larger share of the smallest would leave no room for a picture of 640 x 480 pixels.
constexpr std::size_t kShareForSteps = 8;
// Simulated time waits in sleeps that are short beside the writing of a picture.
constexpr Duration kWaitPause = std::chrono::microseconds(200);
// A disk that answers at all takes a record sooner; one that does not must not stop the simulation.
constexpr Duration kMaxWait = std::chrono::seconds(2);

/// Copies rows without their padding.
void copy_rows(const Frame& frame, std::byte* to) {
  for (std::size_t plane = 0; plane < info_of(frame.format).planes; ++plane) {
    const std::size_t bytes = row_bytes(frame.format, plane, frame.width_px);
    const std::uint8_t* row = frame.plane[plane];
    for (std::size_t v = plane_rows(frame.format, plane, frame.height_px); v > 0; --v) {
      std::memcpy(to, row, bytes);
      to += bytes;
      row += frame.stride_bytes[plane];
    }
  }
}

std::byte* append(std::byte* to, const void* from, std::size_t bytes) {
  std::memcpy(to, from, bytes);
  return to + bytes;
}

}  // namespace

void StepTap::begin_session(bool waits) {
  ++session_;
  waits_ = waits;
  reloads_ = 0;
  next_ = 0;
  complete_ = 0;
}

StepHeader StepTap::next_header(const StepInputs& inputs, StepKind kind) {
  StepHeader header;
  header.number = next_++;
  header.session = session_;
  if (inputs.events.control) ++reloads_;
  header.reload = reloads_;
  header.kind = kind;
  return header;
}

void StepTap::note_state(const Pipeline& pipeline) {
  // A session begins with what its configuration says.
  if (parts_.header.number == 0) complete_ = parts_.recording;
  state_.clear();
  const bool is_due = parts_.header.number % kStatePeriod == kStatePeriod - 1;
  if (is_due || complete_ != parts_.recording) write_state(pipeline, state_);
  parts_.state_bytes = static_cast<std::uint32_t>(state_.bytes().size());
}

void StepTap::add(const Pipeline& pipeline, const StepTrace& trace, const Snapshot& snapshot,
                  const hal::FrameLease& lease) {
  half_.store(snapshot.referee.half, std::memory_order_relaxed);
  const Frame& frame = trace.frame;
  StepHeader& header = parts_.header;
  // Counts also while nothing is recorded: what begins later begins with a gap.
  header = next_header(*trace.inputs, StepKind::kFrame);
  parts_.recording = recording_.load(std::memory_order_acquire);
  if (parts_.recording == 0) {
    complete_ = 0;
    return;
  }
  header.format = frame.format;
  header.width_px = frame.width_px;
  header.height_px = frame.height_px;
  header.sequence = frame.sequence;
  header.captured = frame.capture_time;
  header.revoked = trace.revoked;
  header.is_unusable = trace.picture.is_unusable();
  header.was_cut_short = trace.sightings.cut_short;
  header.frame_number = snapshot.number;
  parts_.inputs = *trace.inputs;
  parts_.drives = pipeline.drive_corrections();
  parts_.packets = trace.packets;
  note_state(pipeline);
  const bool is_wanted = every_ > 0 && snapshot.number % every_ == 0 && frame.sightings == nullptr;
  if (is_wanted) header.picture = lease.jpeg().empty() ? PictureKind::kRaw : PictureKind::kJpeg;
  put(&snapshot, &frame, lease.jpeg());
}

void StepTap::add_stop(const Pipeline& pipeline, const StepInputs& inputs, const OutgoingPackets& packets) {
  parts_.header = next_header(inputs, StepKind::kStop);
  parts_.recording = recording_.load(std::memory_order_acquire);
  if (parts_.recording == 0) {
    complete_ = 0;
    return;
  }
  parts_.header.captured = inputs.now;
  parts_.inputs = inputs;
  parts_.drives = pipeline.drive_corrections();
  parts_.packets = packets;
  note_state(pipeline);
  put(nullptr, nullptr, {});
}

void StepTap::wait_for(std::size_t bytes) {
  if (!waits_) return;
  // Only the recorder can have made more room than there was.
  if (stalled_free_ && ring_.free() > *stalled_free_) stalled_free_.reset();
  if (stalled_free_) return;
  const Instant end = hal::MonotonicClock::read() + kMaxWait;
  while (!has_ended() && ring_.free() < bytes) {
    const Instant now = hal::MonotonicClock::read();
    if (now >= end) {
      stalled_free_ = ring_.free();
      return;
    }
    hal::MonotonicClock::wait_for(now + kWaitPause);
  }
}

void StepTap::put(const Snapshot* snapshot, const Frame* frame, std::span<const std::uint8_t> jpeg) {
  PictureKind& kind = parts_.header.picture;
  std::size_t picture = 0;
  if (kind == PictureKind::kJpeg) picture = jpeg.size();
  if (kind == PictureKind::kRaw) {
    picture = picture_layout(frame->format, frame->width_px, frame->height_px).bytes;
  }
  const std::span<const std::byte> state = state_.bytes();
  const std::size_t bytes = sizeof(StepParts) + (snapshot != nullptr ? sizeof(Snapshot) : 0) + state.size();
  const std::size_t reserve = ring_.capacity() / kShareForSteps;
  // A record that meets the memory's end needs at most twice its size.
  wait_for(std::min(picture > 0 ? 2 * (bytes + picture) + reserve : 4 * bytes, ring_.capacity()));
  std::span<std::byte> room;
  if (picture > 0 && ring_.free() >= bytes + picture + reserve) room = ring_.reserve(bytes + picture);
  if (room.empty()) {
    if (picture > 0) {
      lost_pictures_.fetch_add(1, std::memory_order_relaxed);
      kind = PictureKind::kNone;
    }
    room = ring_.reserve(bytes);
  }
  if (room.empty()) {
    lost_steps_.fetch_add(1, std::memory_order_relaxed);
    complete_ = 0;
    return;
  }
  std::byte* to = append(room.data(), &parts_, sizeof(StepParts));
  if (snapshot != nullptr) to = append(to, snapshot, sizeof(Snapshot));
  to = append(to, state.data(), state.size());
  if (kind == PictureKind::kJpeg) to = append(to, jpeg.data(), jpeg.size());
  if (kind == PictureKind::kRaw) copy_rows(*frame, to);
  ring_.commit();
  if (!state.empty()) complete_ = parts_.recording;
}

}  // namespace touchline::recording
