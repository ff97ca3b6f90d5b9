#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "core/types.h"
#include "tests/color/rgb_to_yuv.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"

namespace touchline::calibrate {

/// A patch of 12 x 12 pixels on a dark robot top, or a ball of 12 pixels on the floor.
struct PaintedPatch {
  std::string color;
  std::array<double, 3> rgb{};
  int u_px = 0, v_px = 0;  // position of its center
  bool is_ball = false;
};

/// Draws a dark floor with patches, a lamp, blurred edges and noise in one of the camera's pixel formats.
inline CameraPicture painted_field(const std::vector<PaintedPatch>& patches, PixelFormat format, unsigned seed,
                                   const std::function<double(int, int)>& lamp) {
  constexpr int kFieldWidth = 320, kFieldHeight = 240, kPatch = 6, kRobot = 11;
  std::vector<std::array<double, 3>> image(kFieldWidth * kFieldHeight, {45, 48, 50});
  const auto fill = [&](int cu, int cv, int half, const std::array<double, 3>& rgb) {
    for (int v = cv - half; v < cv + half; ++v) {
      for (int u = cu - half; u < cu + half; ++u) image[static_cast<std::size_t>(v * kFieldWidth + u)] = rgb;
    }
  };
  const auto fill_disk = [&](const PaintedPatch& ball) {
    for (int v = -kPatch; v <= kPatch; ++v) {
      for (int u = -kPatch; u <= kPatch; ++u) {
        if (u * u + v * v > kPatch * kPatch) continue;
        image[static_cast<std::size_t>((ball.v_px + v) * kFieldWidth + ball.u_px + u)] = ball.rgb;
      }
    }
  };
  for (const PaintedPatch& p : patches) {
    if (!p.is_ball) fill(p.u_px, p.v_px, kRobot, {15, 15, 15});
  }
  for (const PaintedPatch& p : patches) {
    p.is_ball ? fill_disk(p) : fill(p.u_px, p.v_px, kPatch, p.rgb);
  }
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 4.0);
  std::vector<std::array<std::uint8_t, 3>> pixels(image.size());
  for (int v = 0; v < kFieldHeight; ++v) {
    for (int u = 0; u < kFieldWidth; ++u) {
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (int k = -1; k <= 1; ++k) {
          const int column = std::min(std::max(u + k, 0), kFieldWidth - 1);
          sum += (k == 0 ? 0.5 : 0.25) * image[static_cast<std::size_t>(v * kFieldWidth + column)][c];
        }
        const double value = sum * lamp(u, v) + noise(random);
        pixels[static_cast<std::size_t>(v * kFieldWidth + u)][c] =
            static_cast<std::uint8_t>(std::min(255.0, std::max(0.0, value + 0.5)));
      }
    }
  }
  Frame frame;
  frame.format = format;
  frame.width_px = kFieldWidth;
  frame.height_px = kFieldHeight;
  // A chroma sample is the mean of the pixels that share it.
  const auto value_of = [&](const std::array<std::uint8_t, 3>& pixel, std::size_t c) {
    std::array<double, 3> rgb{};
    std::copy(pixel.begin(), pixel.end(), rgb.begin());
    return std::min(255.0, testing::in_space(color_space(format), rgb)[c]);
  };
  const PictureLayout layout = picture_layout(format, kFieldWidth, kFieldHeight);
  std::vector<std::uint8_t> bytes(layout.bytes);
  for (std::size_t c = 0; c < 3; ++c) {
    const ChannelLayout& channel = info_of(format).channel[c];
    const std::size_t across = std::size_t{1} << channel.shift_u, down = std::size_t{1} << channel.shift_v;
    for (std::size_t v = 0; v < kFieldHeight; v += down) {
      for (std::size_t u = 0; u < kFieldWidth; u += across) {
        double sum = 0;
        for (std::size_t i = 0; i < across * down; ++i) {
          sum += value_of(pixels[(v + i / across) * kFieldWidth + u + i % across], c);
        }
        const std::size_t row = layout.offset_bytes[channel.plane] + (v / down) * layout.stride_bytes[channel.plane];
        bytes[row + channel.byte(u)] = static_cast<std::uint8_t>(sum / static_cast<double>(across * down) + 0.5);
      }
    }
  }
  frame.stride_bytes = layout.stride_bytes;
  for (std::size_t i = 0; i < info_of(format).planes; ++i) frame.plane[i] = bytes.data() + layout.offset_bytes[i];
  return CameraPicture::copy_of(frame);
}

}  // namespace touchline::calibrate
