#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/random.h"

namespace touchline::hal::mock {

/// Memory layout of a picture in a buffer.
struct PictureLayout {
  std::array<std::uint32_t, 2> stride_bytes{};
  std::size_t second_plane = 0;  // its offset; NV12 only
  std::size_t bytes = 0;
};
PictureLayout layout_of(PixelFormat format, std::uint16_t width_px, std::uint16_t height_px);

/// Converts linear light to the camera's pixel values: shot noise, read noise, gamma curve, 8 bits, RGB or YUV (BT.601,
/// limited range).
class Sensor {
 public:
  Sensor(const SensorParameters& parameters, PixelFormat format, std::uint16_t width_px, std::uint16_t height_px,
         std::uint64_t seed);

  /// Sets the product of exposure time and gain relative to that at construction. Range: above 0. Does not allocate.
  void set_brightness(double brightness);

  /// Writes one picture. `linear`: R, G, B of each pixel, 0 to kLinearScale. `out`: layout_of().bytes bytes. Does not
  /// allocate.
  void expose(std::span<const std::uint16_t> linear, std::span<std::uint8_t> out);

 private:
  void add_noise_and_gamma(const std::uint16_t* linear);
  void write_row(std::size_t row, std::span<std::uint8_t> out);

  const SensorParameters parameters_;
  PixelFormat format_;
  std::size_t width_ = 0, height_ = 0;
  PictureLayout layout_;
  Random random_;
  NormalTable normal_;
  std::vector<float> mean_, sigma_;    // indexed by linear value
  std::vector<std::uint8_t> tone_;     // indexed by linear value
  std::vector<std::uint8_t> row_;      // R, G, B of one row
  std::vector<std::uint16_t> chroma_;  // NV12: sums of U and V over the pixel pairs of a block's first row
};

}  // namespace touchline::hal::mock
