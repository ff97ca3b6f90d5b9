#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/color/owned_picture.h"
#include "tests/color/rgb_to_yuv.h"

// Renders pictures as a camera does: averages the light over a pixel and the lens blur, applies the camera's gamma,
// rounds, and shares chroma between neighbors if the format does.
namespace touchline::testing {

using Light = std::array<double, 3>;  // red, green, blue; 1 is full scale

class Photograph {
 public:
  Photograph(PixelFormat format, int width, int height) : picture_(format, width, height, 5), format_(format) {}

  /// Renders pixels [left, right) x [top, bottom), clipped to the picture; light(u, v) is the light of a point of the
  /// picture.
  template <class Scene>
  void expose(int left, int top, int right, int bottom, Scene light) {
    // Extend to complete pairs and blocks, so that all pixels with shared chroma are present.
    left = std::max(left / 2 * 2, 0);
    top = std::max(top / 2 * 2, 0);
    right = std::min((right + 1) / 2 * 2, picture_.width());
    bottom = std::min((bottom + 1) / 2 * 2, picture_.height());
    const int across = right - left;
    if (across <= 0 || bottom <= top) return;
    std::vector<std::array<double, 3>> values;
    for (int v = top; v < bottom; ++v) {
      for (int u = left; u < right; ++u) values.push_back(encode(blurred(u, v, light)));
    }
    if (is_yuv(color_space(format_))) share_chroma(values, static_cast<std::size_t>(across));
    std::size_t i = 0;
    for (int v = top; v < bottom; ++v) {
      for (int u = left; u < right; ++u, ++i) picture_.set(u, v, rounded(values[i]));
    }
  }

  [[nodiscard]] Frame frame() const { return picture_.frame(); }

 private:
  // Averages over a pixel and a uniform blur of 1.5 pixels around it.
  template <class Scene>
  static Light blurred(int u, int v, Scene light) {
    constexpr int kSteps = 5;
    constexpr double kWidth = 1.6;
    Light sum{};
    for (int i = 0; i < kSteps * kSteps; ++i) {
      const double du = kWidth * ((i % kSteps + 0.5) / kSteps - 0.5), dv = kWidth * ((i / kSteps + 0.5) / kSteps - 0.5);
      const Light one = light(u + du, v + dv);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += one[c] / (kSteps * kSteps);
    }
    return sum;
  }

  [[nodiscard]] std::array<double, 3> encode(const Light& light) const {
    std::array<double, 3> rgb{};
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = 255.0 * std::pow(std::clamp(light[c], 0.0, 1.0), 1.0 / 2.2);
    return in_space(color_space(format_), rgb);
  }

  void share_chroma(std::vector<std::array<double, 3>>& values, std::size_t across) const {
    const std::size_t rows = std::size_t{1} << info_of(format_).channel[1].shift_v;
    for (std::size_t first = 0; first < values.size(); first += 2) {
      if (first / across % rows != 0) continue;
      for (std::size_t c = 1; c < 3; ++c) {
        double sum = 0;
        for (std::size_t r = 0; r < rows; ++r) sum += values[first + r * across][c] + values[first + r * across + 1][c];
        for (std::size_t r = 0; r < rows; ++r) {
          values[first + r * across][c] = values[first + r * across + 1][c] = sum / (2.0 * static_cast<double>(rows));
        }
      }
    }
  }

  static Channels rounded(const std::array<double, 3>& value) {
    Channels out{};
    for (std::size_t c = 0; c < 3; ++c) {
      out[c] = static_cast<std::uint8_t>(std::lround(std::clamp(value[c], 0.0, 255.0)));
    }
    return out;
  }

  OwnedPicture picture_;
  PixelFormat format_;
};

}  // namespace touchline::testing
