#include "firmware/console/picture_source.h"

#include <algorithm>

namespace touchline::console {
namespace {

// Size of a JPEG's buffer beyond a byte per pixel. At a quality of 80, noise needs about 0.6 bytes a pixel.
constexpr std::size_t kExtraBytes = std::size_t{64} * 1024;

}  // namespace

void PictureSource::request(Instant now, bool with_findings) {
  // Allow for a tolerance, because frames do not arrive exactly on time.
  if (is_outstanding_ || now - requested_ < shortest_period_ - shortest_period_ / 8) return;
  requested_ = now;
  is_outstanding_ = true;
  is_current_ = false;
  exchange_.request(with_findings);
}

bool PictureSource::poll() {
  if (!is_outstanding_ || !exchange_.has_arrived()) return false;
  is_outstanding_ = false;
  is_current_ = exchange_.frame().width_px > 0;
  if (!is_current_ && error_.empty()) error_ = "the camera's pictures have become larger than at the start";
  return is_current_;
}

std::span<std::byte> PictureSource::jpeg(PictureLevel level) {
  if (!is_current_) return {};
  auto* found = std::find_if(encoded_.begin(), encoded_.end(), [&](const Encoded& encoded) {
    return encoded.is_valid && encoded.number == number() && encoded.level == level;
  });
  if (found == encoded_.end()) {
    found = &encoded_[next_];
    next_ = (next_ + 1) % kEncoded;
    const Frame& frame = exchange_.frame();
    const std::size_t pixels = std::size_t{frame.width_px} * frame.height_px;
    found->is_valid = false;
    found->memory.resize(kMessagePrefix + kPictureHeaderBytes + kExtraBytes + pixels);
    const auto room = std::span<std::byte>(found->memory).subspan(kMessagePrefix + kPictureHeaderBytes);
    const Result<std::size_t> size = encoder_.encode(frame, level.divisor, level.quality, room);
    if (!size.ok()) {
      if (error_.empty()) error_ = size.text();
      return {};
    }
    ++compressed_;
    found->is_valid = true;
    found->number = number();
    found->level = level;
    found->bytes = size.value();
  }
  return std::span<std::byte>(found->memory).subspan(kMessagePrefix + kPictureHeaderBytes, found->bytes);
}

}  // namespace touchline::console
