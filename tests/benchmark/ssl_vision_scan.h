#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/region/region_scanner.h"

namespace touchline::testing {

/// The method of ssl-vision's segmentation (CMVision), written anew for comparison: a table of 16 bits per pixel value
/// gives the color, with AVX2 for the table's indexes; runs; connection of runs by their parents; regions with area,
/// box and centroid; lists by color, sorted by area. Colors are rounded to 5, 6 and 5 bits, so regions differ a little.
/// ssl-vision's mask image is not computed, which makes this version faster. It supports only RGB without a light map.
class SslVisionScan {
 public:
  struct Found {
    ColorId color = kBackground;
    std::int32_t area = 0, left = 0, top = 0, right = 0, bottom = 0;
    float u = 0, v = 0;
    std::int32_t next = -1;
  };
  /// kUnsupported: another format than RGB24.
  Status configure(const ScanParameters& parameters);
  /// Returns the regions, in no particular order, valid until the next call.
  const std::vector<Found>& scan(const Frame& frame);
  /// Returns the index of the largest region of a color, or -1. The others follow with Found::next.
  [[nodiscard]] std::int32_t largest(ColorId color) const { return first_[color]; }

 private:
  struct ColorRun {
    std::int16_t row = 0, begin = 0, width = 0;
    ColorId color = kBackground;
    std::int32_t parent = 0;
  };

  void threshold(const Frame& frame);
  void encode_runs();
  void connect();
  void extract();
  void sort_by_area();

  std::vector<ColorId> table_;
  std::vector<ColorId> colors_;
  std::vector<std::uint8_t> mask_;
  std::vector<ColorRun> runs_;
  std::vector<Found> found_;
  std::array<std::int32_t, kMaxColors + 1> first_{};
  int width_ = 0, height_ = 0;
};

}  // namespace touchline::testing
