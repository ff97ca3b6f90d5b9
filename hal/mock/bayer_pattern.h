#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/parameter.h"

namespace touchline::hal::mock {

/// The color filters of a sensor's first two rows and columns, row by row; they repeat every second pixel (Bayer 1976).
/// `kNone`: every pixel measures all three colors.
enum class BayerPattern : std::uint8_t { kNone, kRggb, kGrbg, kGbrg, kBggr };
inline constexpr std::array<Choice<BayerPattern>, 5> kBayerPatterns{{{"none", BayerPattern::kNone},
                                                                     {"rggb", BayerPattern::kRggb},
                                                                     {"grbg", BayerPattern::kGrbg},
                                                                     {"gbrg", BayerPattern::kGbrg},
                                                                     {"bggr", BayerPattern::kBggr}}};

/// Interpolates the two missing colors of each pixel bilinearly: the mean of the nearest pixels with that color.
class BayerInterpolation {
 public:
  /// Sizes of at least 2 x 2 pixels; `pattern` is not kNone.
  BayerInterpolation(BayerPattern pattern, std::size_t width_px, std::size_t height_px);

  /// Returns 0 for red, 1 for green, 2 for blue.
  [[nodiscard]] std::size_t color_at(std::size_t column, std::size_t row) const;

  /// Interpolates one row of a picture. `measured`: one value per pixel. `out`: R, G, B of each pixel. Does not
  /// allocate.
  void interpolate_row(std::span<const float> measured, std::size_t row, std::span<float> out) const;

 private:
  std::size_t width_, height_;
  std::size_t red_column_, red_row_;  // 0 or 1 each
};

/// Blurs a picture with a Gaussian kernel, as a lens that is slightly out of focus does. Pixels beyond the edge repeat
/// those of the edge.
class GaussianBlur {
 public:
  /// `sigma_px` above 0.
  GaussianBlur(double sigma_px, std::size_t width_px, std::size_t height_px);

  /// Returns the blurred picture (R, G, B of each pixel), valid until the next call. Does not allocate.
  std::span<const std::uint16_t> operator()(std::span<const std::uint16_t> linear);

 private:
  std::size_t width_, height_;
  std::vector<float> weight_;  // weights at distance 0, 1, ...
  std::vector<float> across_;  // picture blurred along the rows
  std::vector<std::uint16_t> out_;
};

}  // namespace touchline::hal::mock
