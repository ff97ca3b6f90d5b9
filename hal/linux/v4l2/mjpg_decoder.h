#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/pixel_format.h"
#include "hal/result.h"

namespace touchline::hal {

/// Decodes the JPEG pictures of a camera to planar YUV (yuvj422p) with libjpeg-turbo.
///
/// The samples of the JPEG are not converted: pictures with 4:2:2 are decoded into the planes. Other pictures get a
/// chroma sample for each pair of pixels in a row by repeating samples (4:2:0, 4:1:1) or by averaging two (4:4:4,
/// 4:4:0). Gray pictures get chroma 128. open() allocates all memory, including that of the library during decoding.
class MjpgDecoder {
 public:
  MjpgDecoder();
  ~MjpgDecoder();
  MjpgDecoder(const MjpgDecoder&) = delete;
  MjpgDecoder& operator=(const MjpgDecoder&) = delete;

  /// Sets the size of the pictures, in the range of a Frame.
  void open(std::uint16_t width_px, std::uint16_t height_px);
  /// Returns the layout in which decode() writes the planes of a picture. Rows are padded.
  [[nodiscard]] const PictureLayout& layout() const { return layout_; }
  /// Decodes into `picture`, which has layout().bytes bytes. kCorruptFrame: the JPEG is truncated, damaged, of another
  /// size, or not a baseline JPEG in YUV; then the content of `picture` is undefined, and the next picture may be good.
  /// Does not allocate.
  Result<void> decode(std::span<const std::uint8_t> jpeg, std::uint8_t* picture);

 private:
  struct Library;
  std::unique_ptr<Library> library_;
  PictureLayout layout_;
};

}  // namespace touchline::hal
