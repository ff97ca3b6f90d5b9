#include "core/marker/linear_picture.h"

#include <algorithm>

#include "core/color/pixel.h"

namespace touchline {
namespace {

// Newton's method by sums and products alone, so that the table is the same on every board.
constexpr double fifth_root(double x) {
  double y = 1.0;
  for (int i = 0; i < 60; ++i) y -= (y * y * y * y * y - x) / (5.0 * y * y * y * y);
  return y;
}

constexpr auto kLight = [] {
  std::array<float, 256> light{};
  for (std::size_t value = 1; value < light.size(); ++value) {
    const double x = static_cast<double>(value) / 255.0;
    light[value] = static_cast<float>(x * x * fifth_root(x));
  }
  return light;
}();

LinearColor from_yuv(int y, int u, int v) {
  const int luma = 298 * (y - 16) + 128;
  const auto channel = [](int value) { return kLight[static_cast<std::size_t>(std::clamp(value >> 8, 0, 255))]; };
  return {channel(luma + 409 * (v - 128)), channel(luma - 100 * (u - 128) - 208 * (v - 128)),
          channel(luma + 516 * (u - 128))};
}

}  // namespace

float linear_light(std::uint8_t value) { return kLight[value]; }

LinearColor LinearPicture::at(int u, int v) const {
  const std::array<std::uint8_t, 3> value = pixel_at(frame_, static_cast<std::size_t>(u), static_cast<std::size_t>(v));
  if (color_space(frame_.format) == ColorSpace::kYuv) return from_yuv(value[0], value[1], value[2]);
  return {kLight[value[0]], kLight[value[1]], kLight[value[2]]};
}

bool LinearPicture::at(PixelPoint point, LinearColor& out) const {
  // From the picture's corner; compared as floats first, because what lies far out does not fit an int.
  const float right = point.u_px + 0.5f, down = point.v_px + 0.5f;
  if (!(right > 0.0f && down > 0.0f && right < static_cast<float>(frame_.width_px) &&
        down < static_cast<float>(frame_.height_px))) {
    return false;
  }
  out = at(static_cast<int>(right), static_cast<int>(down));
  return true;
}

}  // namespace touchline
