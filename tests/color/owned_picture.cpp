#include "tests/color/owned_picture.h"

#include <algorithm>
#include <cmath>

#include "tests/color/rgb_to_yuv.h"

namespace touchline::testing {
namespace {

// Plane and byte of a channel of a pixel.
struct Place {
  std::size_t plane, offset;
};
std::array<Place, 3> places(PixelFormat format, const std::array<std::size_t, kMaxPlanes>& stride, int u, int v) {
  const auto x = static_cast<std::size_t>(u), y = static_cast<std::size_t>(v);
  const std::size_t row = y * stride[0], pair = x / 2;
  switch (format) {
    case PixelFormat::kRgb24:
      return {{{0, row + 3 * x}, {0, row + 3 * x + 1}, {0, row + 3 * x + 2}}};
    case PixelFormat::kBgr24:
      return {{{0, row + 3 * x + 2}, {0, row + 3 * x + 1}, {0, row + 3 * x}}};
    case PixelFormat::kYuyv:
      return {{{0, row + 2 * x}, {0, row + 4 * pair + 1}, {0, row + 4 * pair + 3}}};
    case PixelFormat::kUyvy:
      return {{{0, row + 2 * x + 1}, {0, row + 4 * pair}, {0, row + 4 * pair + 2}}};
    case PixelFormat::kNv12:
      return {{{0, row + x}, {1, y / 2 * stride[1] + 2 * pair}, {1, y / 2 * stride[1] + 2 * pair + 1}}};
    case PixelFormat::kXrgb8888:
      return {{{0, row + 4 * x + 2}, {0, row + 4 * x + 1}, {0, row + 4 * x}}};
    case PixelFormat::kI420:
      return {{{0, row + x}, {1, y / 2 * stride[1] + pair}, {2, y / 2 * stride[2] + pair}}};
    case PixelFormat::kYuvj422p:
      return {{{0, row + x}, {1, y * stride[1] + pair}, {2, y * stride[2] + pair}}};
  }
  return {};
}

}  // namespace

std::string name_of(PixelFormat format) { return std::string(info_of(format).word); }

OwnedPicture::OwnedPicture(PixelFormat format, int width, int height, int padding)
    : format_(format), width_(width), height_(height) {
  const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  const std::size_t even = (w + 1) / 2 * 2, half_rows = (h + 1) / 2;
  std::array<std::size_t, kMaxPlanes> row{}, rows{h, half_rows, half_rows};
  switch (format) {
    case PixelFormat::kRgb24:
    case PixelFormat::kBgr24:
      row = {3 * w};
      break;
    case PixelFormat::kYuyv:
    case PixelFormat::kUyvy:
      row = {2 * even};
      break;
    case PixelFormat::kNv12:
      row = {w, even};
      break;
    case PixelFormat::kI420:
      row = {w, even / 2, even / 2};
      break;
    case PixelFormat::kXrgb8888:
      row = {4 * w};
      break;
    case PixelFormat::kYuvj422p:
      row = {w, even / 2, even / 2};
      rows = {h, h, h};
      break;
  }
  for (std::size_t plane = 0; plane < kMaxPlanes; ++plane) {
    if (row[plane] == 0) continue;
    stride_[plane] = row[plane] + static_cast<std::size_t>(padding) + 3 * plane;
    bytes_[plane] = std::vector<std::uint8_t>(stride_[plane] * (rows[plane] - 1) + row[plane]);
  }
}

Frame OwnedPicture::frame() const {
  Frame frame;
  frame.format = format_;
  frame.width_px = static_cast<std::uint16_t>(width_);
  frame.height_px = static_cast<std::uint16_t>(height_);
  for (std::size_t plane = 0; plane < kMaxPlanes; ++plane) {
    frame.plane[plane] = bytes_[plane].empty() ? nullptr : bytes_[plane].data();
    frame.stride_bytes[plane] = static_cast<std::uint32_t>(stride_[plane]);
  }
  return frame;
}

void OwnedPicture::set(int u, int v, Channels value) {
  const auto where = places(format_, stride_, u, v);
  for (std::size_t c = 0; c < 3; ++c) bytes_[where[c].plane][where[c].offset] = value[c];
}

Channels channels_at(const Frame& frame, int u, int v) {
  const auto where = places(frame.format, {frame.stride_bytes[0], frame.stride_bytes[1], frame.stride_bytes[2]}, u, v);
  Channels value{};
  for (std::size_t c = 0; c < 3; ++c) value[c] = frame.plane[where[c].plane][where[c].offset];
  return value;
}

ColorId color_by_boxes(const ColorBoxes& boxes, ColorSpace space, Channels value, Channels level) {
  for (const ColorBox& box : boxes) {
    bool inside = true;
    for (std::size_t c = 0; c < 3; ++c) {
      const double origin = in_space(space, {0.0, 0.0, 0.0})[c];  // black
      const double gain = static_cast<double>(gain_of_level(level[c]));
      const double seen = std::clamp(origin + std::round((value[c] - origin) * gain), 0.0, 255.0);
      const bool is_bright_enough = box.low[c] <= seen || value[c] == 255;  // 255 also stands for all brighter light
      inside = inside && is_bright_enough && seen <= box.high[c];
    }
    if (inside) return box.color;
  }
  return kBackground;
}

int pick(std::mt19937& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<std::uint32_t>(high - low + 1));
}

ColorBoxes random_boxes(std::mt19937& random, std::size_t count) {
  ColorBoxes boxes;
  for (std::size_t i = 0; i < count; ++i) {
    ColorBox box;
    box.color = static_cast<ColorId>(pick(random, 1, static_cast<int>(kMaxColors)));
    for (std::size_t c = 0; c < 3; ++c) {
      int low = pick(random, 0, 255), high = pick(random, 0, 255);
      const int kind = pick(random, 0, 5);
      if (kind == 0) low = high;
      if (kind == 1) low = 0, high = 255;
      box.low[c] = static_cast<std::uint8_t>(std::min(low, high));
      box.high[c] = static_cast<std::uint8_t>(std::max(low, high));
    }
    boxes.push_back(box);
  }
  return boxes;
}

std::uint8_t critical_value(std::mt19937& random, const ColorBoxes& boxes) {
  const int kind = pick(random, 0, 9);
  if (kind == 0) return 0;
  if (kind == 1) return 255;
  if (kind < 5 || boxes.empty()) return static_cast<std::uint8_t>(random());
  const ColorBox& box = boxes[random() % boxes.size()];
  const std::size_t c = random() % 3;
  const int bound = kind < 8 ? box.low[c] : box.high[c];
  return static_cast<std::uint8_t>(std::clamp(bound + pick(random, -1, 1), 0, 255));
}

}  // namespace touchline::testing
