#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "hal/result.h"

namespace touchline::hal {

/// Decodes the JPEG pictures of a camera to RGB24 with libjpeg-turbo.
///
/// JPEG has full-range YUV, for which the core has no format; RGB keeps all levels, and black is 0. Chroma is not
/// interpolated, as in YUYV. open() allocates all memory, including that of the library during decoding.
class MjpgDecoder {
 public:
  MjpgDecoder();
  ~MjpgDecoder();
  MjpgDecoder(const MjpgDecoder&) = delete;
  MjpgDecoder& operator=(const MjpgDecoder&) = delete;

  /// Size of the pictures, in the range of a Frame.
  void open(std::uint16_t width_px, std::uint16_t height_px);
  /// Writes rows of 3 * width_px bytes to `rgb`. kCorruptFrame: truncated, damaged, of another size, or not a baseline
  /// JPEG; then the content of `rgb` is undefined, and the next picture may be good. Does not allocate.
  Result<void> decode(std::span<const std::uint8_t> jpeg, std::uint8_t* rgb);

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace touchline::hal
