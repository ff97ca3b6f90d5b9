#include "hal/mock/picture_faults.h"

#include <algorithm>
#include <cmath>

#include "hal/mock/renderer.h"

namespace touchline::hal::mock {
namespace {

// Random stream of the faults; physics, radio and sensor use the streams 0 to 2.
constexpr std::uint64_t kRandomStream = 16;
constexpr std::size_t kBlock_px = 16;

}  // namespace

PictureFaults::PictureFaults(const ArenaParameters& parameters, const CameraSettings& camera, std::uint64_t seed)
    : format_(pixel_format(camera.format)),
      width_(camera.width_px),
      height_(camera.height_px),
      rate_hz_(camera.rate_hz),
      layout_(picture_layout(format_, width_, height_)),
      random_(seed, kRandomStream) {
  for (const ArenaFault& fault : parameters.fault) prepare(fault.kind);
}

void PictureFaults::prepare(FaultKind kind) {
  if (kind == FaultKind::kPictureTurned || kind == FaultKind::kPictureRandom) scene_.resize(3 * width_ * height_);
  if (kind == FaultKind::kPictureFrozen) frozen_.bytes.resize(layout_.bytes);
  if (kind == FaultKind::kPictureHalfFrozen) half_frozen_.bytes.resize(layout_.bytes);
  if (kind == FaultKind::kPictureTorn && former_.empty()) {
    former_.resize(static_cast<std::size_t>(std::ceil(seconds(kTornAge) * rate_hz_)) + 1);
    for (Picture& picture : former_) picture.bytes.resize(layout_.bytes);
  }
}

std::span<const std::uint16_t> PictureFaults::turned(std::span<const std::uint16_t> scene) {
  const std::size_t pixels = width_ * height_;
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t c = 0; c < 3; ++c) scene_[3 * i + c] = scene[3 * (pixels - 1 - i) + c];
  }
  return scene_;
}

std::span<const std::uint16_t> PictureFaults::random_blocks() {
  for (std::size_t top = 0; top < height_; top += kBlock_px) {
    for (std::size_t left = 0; left < width_; left += kBlock_px) {
      std::array<std::uint16_t, 3> color{};
      for (std::uint16_t& value : color) value = static_cast<std::uint16_t>(random_.uniform(0.0, kLinearScale));
      for (std::size_t v = top; v < std::min(top + kBlock_px, height_); ++v) {
        for (std::size_t u = left; u < std::min(left + kBlock_px, width_); ++u) {
          std::copy(color.begin(), color.end(), scene_.begin() + static_cast<std::ptrdiff_t>(3 * (v * width_ + u)));
        }
      }
    }
  }
  return scene_;
}

void PictureFaults::remember(std::span<const std::uint8_t> bytes, Instant capture_time) {
  Picture& picture = former_[next_former_];
  next_former_ = (next_former_ + 1) % former_.size();
  picture.capture_time = capture_time;
  std::copy(bytes.begin(), bytes.end(), picture.bytes.begin());
}

void PictureFaults::tear(std::span<std::uint8_t> bytes, Instant capture_time) {
  const Picture* nearest = nullptr;
  const auto distance = [&](const Picture& picture) {
    const Duration age = capture_time - picture.capture_time - kTornAge;
    return age < Duration::zero() ? -age : age;
  };
  for (const Picture& picture : former_) {
    if (picture.capture_time == Instant{}) continue;
    if (nearest == nullptr || distance(picture) < distance(*nearest)) nearest = &picture;
  }
  if (nearest != nullptr) copy_part(nearest->bytes, bytes, Part::kLowerHalf);
}

void PictureFaults::repeat(std::span<std::uint8_t> bytes, bool is_active, Repeated& repeated, Part part) {
  if (is_active && !repeated.holds) std::copy(bytes.begin(), bytes.end(), repeated.bytes.begin());
  repeated.holds = is_active;
  if (is_active) copy_part(repeated.bytes, bytes, part);
}

void PictureFaults::copy_part(std::span<const std::uint8_t> from, std::span<std::uint8_t> to, Part part) const {
  for (std::size_t plane = 0; plane < info_of(format_).planes; ++plane) {
    const std::size_t rows = plane_rows(format_, plane, height_);
    const std::size_t begin =
        layout_.offset_bytes[plane] + (part == Part::kAll ? 0 : rows / 2) * layout_.stride_bytes[plane];
    const std::size_t end = layout_.offset_bytes[plane] + rows * layout_.stride_bytes[plane];
    std::copy(from.begin() + static_cast<std::ptrdiff_t>(begin), from.begin() + static_cast<std::ptrdiff_t>(end),
              to.begin() + static_cast<std::ptrdiff_t>(begin));
  }
}

}  // namespace touchline::hal::mock
