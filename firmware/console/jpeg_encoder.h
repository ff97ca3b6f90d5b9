#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "core/types.h"
#include "hal/result.h"

namespace touchline::console {

/// Compresses pictures of any PixelFormat to JPEG. Planar YUV and RGB of full size go to the library without a copy of
/// the picture. It needs memory for some rows and for the library, independent of the picture's content.
class JpegEncoder {
 public:
  JpegEncoder();
  ~JpegEncoder();
  JpegEncoder(const JpegEncoder&) = delete;
  JpegEncoder& operator=(const JpegEncoder&) = delete;

  /// Writes a JPEG of the frame, reduced by `divisor` (1 to 8), into `out` and returns its size in bytes. `quality`: 1
  /// to 100. kFull: `out` is too small; kOutOfRange: the reduced picture has no pixels; kIo: the library failed, with
  /// its text.
  Result<std::size_t> encode(const Frame& frame, int divisor, int quality, std::span<std::byte> out);

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace touchline::console
