#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/types.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/bayer_pattern.h"
#include "hal/mock/random.h"

namespace touchline::hal::mock {

/// Converts linear light to the camera's pixel values: blur, Bayer pattern, shot noise, read noise, gamma curve, 8
/// bits, RGB or YUV (BT.601).
class Sensor {
 public:
  Sensor(const SensorParameters& parameters, PixelFormat format, std::uint16_t width_px, std::uint16_t height_px,
         std::uint64_t seed);

  /// Sets the product of exposure time and gain, relative to the product at construction. Range: above 0. Does not
  /// allocate.
  void set_brightness(double brightness);

  /// Writes one picture. `linear`: R, G, B of each pixel, 0 to kLinearScale. `out`: the bytes of picture_layout()
  /// without padding. Does not allocate.
  void expose(std::span<const std::uint16_t> linear, std::span<std::uint8_t> out);

 private:
  // Calls out(i, value) for each of the `linear` values with their noise, 0 to kLinearScale.
  template <class Out>
  void add_noise(const std::uint16_t* linear, std::size_t count, Out out);
  void add_noise_and_gamma(const std::uint16_t* linear);
  void measure_mosaic(const std::uint16_t* linear);
  void write_row(std::size_t row, std::span<std::uint8_t> out);
  void write_rgb_row(std::size_t row, std::span<std::uint8_t> out);
  void write_yuv_row(std::size_t row, std::span<std::uint8_t> out);
  [[nodiscard]] std::uint8_t* channel_row(std::size_t channel, std::size_t row, std::span<std::uint8_t> out) const;

  const SensorParameters parameters_;
  PixelFormat format_;
  std::size_t width_ = 0, height_ = 0;
  PictureLayout layout_;
  Random random_;
  NormalTable normal_;
  std::optional<GaussianBlur> blur_;
  std::optional<BayerInterpolation> bayer_;
  std::vector<std::uint16_t> filtered_;         // one value per pixel of a row: the color that it measures
  std::vector<float> measured_, interpolated_;  // one value per pixel of the picture; R, G, B of one row
  std::vector<float> mean_, sigma_;             // indexed by linear value
  std::vector<std::uint8_t> tone_;              // indexed by linear value
  std::vector<std::uint8_t> row_;               // R, G, B of one row
  std::vector<std::uint16_t> chroma_;           // sums of U and V over the pixels that share a sample
};

}  // namespace touchline::hal::mock
