#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "core/color/color_tables.h"
#include "core/types.h"

// Pictures in every pixel format, and an independent, simple implementation that reads their pixels.
namespace touchline::testing {

inline constexpr auto kAllFormats = [] {
  std::array<PixelFormat, kPixelFormatTable.size()> formats{};
  for (std::size_t i = 0; i < formats.size(); ++i) formats[i] = kPixelFormatTable[i].format;
  return formats;
}();
std::string name_of(PixelFormat format);

using Channels = std::array<std::uint8_t, 3>;

/// Owns exactly the bytes that the format needs, so that a sanitizer detects reads beyond them: the last row has no
/// padding. Other rows have `padding` bytes of padding, and three more in each further plane.
class OwnedPicture {
 public:
  OwnedPicture(PixelFormat format, int width, int height, int padding);

  [[nodiscard]] Frame frame() const;
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Sets a pixel. Shared chroma changes for the whole pair or block.
  void set(int u, int v, Channels value);
  /// Fills all bytes, including the padding.
  template <class Source>
  void fill(Source source) {
    for (auto& plane : bytes_) {
      for (std::uint8_t& byte : plane) byte = source();
    }
  }

 private:
  PixelFormat format_;
  int width_, height_;
  std::array<std::size_t, kMaxPlanes> stride_{};
  std::array<std::vector<std::uint8_t>, kMaxPlanes> bytes_;
};

/// Returns R, G, B or Y, U, V of a pixel.
Channels channels_at(const Frame& frame, int u, int v);

/// Returns the color of the first box that contains the corrected value, which is the definition, without tables.
ColorId color_by_boxes(const ColorBoxes& boxes, ColorSpace space, Channels value, Channels level);

/// Returns random boxes, some of them one level wide, some with the full range.
ColorBoxes random_boxes(std::mt19937& random, std::size_t count);

/// Returns a value that tests the bounds: 0, 255, a bound of a box or its neighbor; sometimes any value.
std::uint8_t critical_value(std::mt19937& random, const ColorBoxes& boxes);

/// Returns a uniformly distributed number in [low, high]. (The standard distributions differ between libraries.)
int pick(std::mt19937& random, int low, int high);

}  // namespace touchline::testing
