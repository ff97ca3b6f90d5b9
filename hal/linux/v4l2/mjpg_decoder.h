#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "hal/result.h"

namespace touchline::hal {

/// Turns the JPEG pictures of a camera into RGB24, with libjpeg-turbo.
///
/// Their YUV is of full range, which no format of the core is: RGB keeps all its levels, and black is 0. Chroma that
/// pixels share is shared in RGB too, as in YUYV. All memory is taken by open(), also what the library asks for while
/// it decodes.
class MjpgDecoder {
 public:
  MjpgDecoder();
  ~MjpgDecoder();
  MjpgDecoder(const MjpgDecoder&) = delete;
  MjpgDecoder& operator=(const MjpgDecoder&) = delete;

  /// Pictures will have this size. Ranges: those of a Frame.
  void open(std::uint16_t width_px, std::uint16_t height_px);
  /// Writes 3 * width_px bytes a row. kCorruptFrame: truncated, damaged, of another size, or no baseline JPEG; `rgb`
  /// then holds anything, and the next picture may be good. Allocates nothing.
  Result<void> decode(std::span<const std::uint8_t> jpeg, std::uint8_t* rgb);

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace touchline::hal
