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

std::array<float, 3> from_yuv(int y, int u, int v) {
  const int luma = 298 * (y - 16) + 128;
  const auto channel = [](int value) { return kLight[static_cast<std::size_t>(std::clamp(value >> 8, 0, 255))]; };
  return {channel(luma + 409 * (v - 128)), channel(luma - 100 * (u - 128) - 208 * (v - 128)),
          channel(luma + 516 * (u - 128))};
}

// Of a channel of four pixels.
Lanes light_of(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c, const std::uint8_t* d) {
  return Lanes{kLight[*a], kLight[*b], kLight[*c], kLight[*d]};
}

// Of pixels of which the first bytes are given.
LightLanes of_rgb(PixelFormat format, const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c,
                  const std::uint8_t* d) {
  const LightLanes light{light_of(a, b, c, d), light_of(a + 1, b + 1, c + 1, d + 1),
                         light_of(a + 2, b + 2, c + 2, d + 2)};
  return format == PixelFormat::kRgb24 ? light : LightLanes{light[2], light[1], light[0]};
}

LightLanes of_yuv(const Frame& frame, LaneMask u, LaneMask v) {
  LightLanes light;
  for (int i = 0; i < kLanes; ++i) {
    const std::array<std::uint8_t, 3> value =
        pixel_at(frame, static_cast<std::size_t>(u[i]), static_cast<std::size_t>(v[i]));
    const std::array<float, 3> color = from_yuv(value[0], value[1], value[2]);
    for (std::size_t c = 0; c < 3; ++c) light[c][i] = color[c];
  }
  return light;
}

}  // namespace

float linear_light(std::uint8_t value) { return kLight[value]; }

LightLanes LinearPicture::along_row(int u, int v, int step) const {
  const int last = frame_.width_px - 1;
  const int second = std::min(u + step, last), third = std::min(u + 2 * step, last),
            fourth = std::min(u + 3 * step, last);
  if (color_space(frame_.format) == ColorSpace::kYuv) {
    return of_yuv(frame_, LaneMask{u, second, third, fourth}, LaneMask{v, v, v, v});
  }
  const std::uint8_t* row = frame_.plane[0] + static_cast<std::size_t>(v) * frame_.stride_bytes[0];
  const auto pixel = [row](int at) { return row + std::size_t{3} * static_cast<std::size_t>(at); };
  return of_rgb(frame_.format, pixel(u), pixel(second), pixel(third), pixel(fourth));
}

LightLanes LinearPicture::nearest(Lanes u_px, Lanes v_px, LaneMask& inside) const {
  // From the picture's corner. Held inside as floats, because what lies far out does not fit an int.
  const Lanes right = u_px + all_lanes(0.5f), down = v_px + all_lanes(0.5f);
  const Lanes width = all_lanes(frame_.width_px), height = all_lanes(frame_.height_px);
  inside = (right > Lanes{}) & (down > Lanes{}) & (right < width) & (down < height);
  const auto number = [](Lanes place, Lanes size) {
    return __builtin_convertvector(smaller(larger(place, Lanes{}), size - all_lanes(1.0f)), LaneMask);
  };
  const LaneMask u = number(right, width), v = number(down, height);
  if (color_space(frame_.format) == ColorSpace::kYuv) return of_yuv(frame_, u, v);
  const auto pixel = [&](int i) {
    return frame_.plane[0] + static_cast<std::size_t>(v[i]) * frame_.stride_bytes[0] +
           std::size_t{3} * static_cast<std::size_t>(u[i]);
  };
  return of_rgb(frame_.format, pixel(0), pixel(1), pixel(2), pixel(3));
}

}  // namespace touchline
