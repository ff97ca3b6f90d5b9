#include "tools/programs/arena/picture_outputs.h"

#include <algorithm>
#include <mutex>

#include "hal/linux/monotonic_clock.h"

namespace touchline::arena {
namespace {

// libjpeg's scale of 1 to 100; patches keep their colors.
constexpr int kJpegQuality = 90;

std::int64_t nanoseconds(Instant instant) { return instant.time_since_epoch().count(); }

}  // namespace

PictureOutputs::PictureOutputs(const hal::CameraSettings& camera)
    : camera_(camera),
      layout_(picture_layout(hal::pixel_format(camera.format), camera.width_px, camera.height_px)),
      picture_(layout_.bytes) {
  if (camera.format == hal::CameraFormat::kMjpg) jpeg_.resize(layout_.bytes);
}

Result<std::span<const std::byte>> PictureOutputs::compressed() {
  Frame frame;
  frame.format = hal::pixel_format(camera_.format);
  frame.width_px = camera_.width_px;
  frame.height_px = camera_.height_px;
  for (std::size_t i = 0; i < info_of(frame.format).planes; ++i)
    frame.plane[i] = picture_.data() + layout_.offset_bytes[i];
  frame.stride_bytes = layout_.stride_bytes;
  TOUCHLINE_TRY_ASSIGN(const std::size_t size, encoder_.encode(frame, 1, kJpegQuality, jpeg_));
  return std::span<const std::byte>(jpeg_).first(size);
}

Result<void> PictureOutputs::write(hal::mock::Arena& arena, const hal::mock::Exposure& exposure) {
  {
    // Requests to the arena may add faults.
    const std::scoped_lock lock(arena.mutex());
    arena.render(exposure, picture_);
  }
  std::span<const std::byte> bytes = std::as_bytes(std::span(picture_));
  if (camera_.format == hal::CameraFormat::kMjpg) {
    TOUCHLINE_TRY_ASSIGN(bytes, compressed());
  }
  const Instant now = hal::MonotonicClock::read() - clock_offset_;
  largest_delay_ = std::max(largest_delay_, now - exposure.ready);
  hal::PictureHeader header;
  header.bytes = static_cast<std::uint32_t>(bytes.size());
  header.sequence = exposure.sequence;
  header.captured_ns = nanoseconds(exposure.capture_time);
  header.ready_ns = nanoseconds(exposure.ready);
  header.sent_ns = nanoseconds(now);
  header.truth = arena.places_at_capture(exposure);
  sender_.send(header, bytes);
  return loopback_.is_open() ? loopback_.write(bytes) : Result<void>();
}

}  // namespace touchline::arena
