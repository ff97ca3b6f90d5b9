#include "hal/mock/sensor.h"

#include <algorithm>
#include <cmath>

#include "hal/mock/renderer.h"

namespace touchline::hal::mock {
namespace {

constexpr std::uint64_t kSensorStream = 3;

// ITU-R BT.601, limited range, in 16-bit fixed point.
struct Yuv {
  int y, u, v;
};
Yuv to_yuv(const std::uint8_t* rgb) {
  const int r = rgb[0], g = rgb[1], b = rgb[2];
  constexpr int kHalf = 1 << 15;
  return {((16829 * r + 33039 * g + 6416 * b + kHalf) >> 16) + 16,
          ((-9714 * r - 19070 * g + 28784 * b + kHalf) >> 16) + 128,
          ((28784 * r - 24103 * g - 4681 * b + kHalf) >> 16) + 128};
}

}  // namespace

PictureLayout layout_of(PixelFormat format, std::uint16_t width_px, std::uint16_t height_px) {
  const std::uint32_t width = width_px, height = height_px;
  const std::uint32_t pairs = (width + 1) / 2;
  switch (format) {
    case PixelFormat::kRgb24:
    case PixelFormat::kBgr24:
      return {{3 * width, 0}, 0, std::size_t{3} * width * height};
    case PixelFormat::kYuyv:
    case PixelFormat::kUyvy:
      return {{4 * pairs, 0}, 0, std::size_t{4} * pairs * height};
    case PixelFormat::kNv12:
      return {{width, 2 * pairs},
              std::size_t{width} * height,
              std::size_t{width} * height + std::size_t{2} * pairs * ((height + 1) / 2)};
  }
  return {};
}

Sensor::Sensor(const SensorParameters& parameters, PixelFormat format, std::uint16_t width_px, std::uint16_t height_px,
               std::uint64_t seed)
    : parameters_(parameters),
      format_(format),
      width_(width_px),
      height_(height_px),
      layout_(layout_of(format, width_px, height_px)),
      random_(seed, kSensorStream),
      mean_(kLinearScale + 1),
      sigma_(kLinearScale + 1),
      tone_(kLinearScale + 1),
      row_(3 * width_),
      chroma_(2 * ((width_ + 1) / 2)) {
  for (std::size_t i = 0; i <= kLinearScale; ++i) {
    const double value = static_cast<double>(i) / kLinearScale;
    tone_[i] = static_cast<std::uint8_t>(std::lround(255.0 * std::pow(value, 1.0 / parameters.gamma)));
  }
  set_brightness(1.0);
}

void Sensor::set_brightness(double brightness) {
  const double electrons_per_step = parameters_.full_well_electrons / kLinearScale;
  const double read_noise = parameters_.read_noise_electrons;
  for (std::size_t i = 0; i <= kLinearScale; ++i) {
    const double value = std::min(static_cast<double>(i) * brightness, double{kLinearScale});
    mean_[i] = static_cast<float>(value);
    sigma_[i] =
        static_cast<float>(std::sqrt(read_noise * read_noise + value * electrons_per_step) / electrons_per_step);
  }
}

void Sensor::expose(std::span<const std::uint16_t> linear, std::span<std::uint8_t> out) {
  for (std::size_t row = 0; row < height_; ++row) {
    add_noise_and_gamma(&linear[3 * width_ * row]);
    write_row(row, out);
  }
}

void Sensor::add_noise_and_gamma(const std::uint16_t* linear) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < row_.size(); ++i) {
    if (i % 4 == 0) bits = random_.bits();
    const std::uint16_t value = linear[i];
    const float noisy =
        mean_[value] + sigma_[value] * normal_[bits] + 0.5f;  // + 0.5: the conversion to an index truncates
    bits >>= 16U;
    row_[i] = tone_[static_cast<std::size_t>(std::clamp(noisy, 0.0f, static_cast<float>(kLinearScale)))];
  }
}

void Sensor::write_row(std::size_t row, std::span<std::uint8_t> out) {
  std::uint8_t* to = out.data() + row * layout_.stride_bytes[0];
  const std::uint8_t* from = row_.data();
  switch (format_) {
    case PixelFormat::kRgb24:
      std::copy(row_.begin(), row_.end(), to);
      return;
    case PixelFormat::kBgr24:
      for (std::size_t i = 0; i < row_.size(); i += 3) {
        to[i] = from[i + 2];
        to[i + 1] = from[i + 1];
        to[i + 2] = from[i];
      }
      return;
    case PixelFormat::kYuyv:
    case PixelFormat::kUyvy: {
      const std::size_t luma = format_ == PixelFormat::kYuyv ? 0 : 1;
      for (std::size_t column = 0; column < width_; column += 2) {
        const Yuv a = to_yuv(from + 3 * column);
        const Yuv b = column + 1 < width_ ? to_yuv(from + 3 * column + 3) : a;
        std::uint8_t* quad = to + 2 * column;
        quad[luma] = static_cast<std::uint8_t>(a.y);
        quad[luma + 2] = static_cast<std::uint8_t>(b.y);
        quad[1 - luma] = static_cast<std::uint8_t>((a.u + b.u + 1) / 2);
        quad[3 - luma] = static_cast<std::uint8_t>((a.v + b.v + 1) / 2);
      }
      return;
    }
    case PixelFormat::kNv12: {
      const bool begins_block = row % 2 == 0, ends_block = !begins_block || row + 1 == height_;
      std::uint8_t* chroma = out.data() + layout_.second_plane + row / 2 * layout_.stride_bytes[1];
      if (begins_block) std::fill(chroma_.begin(), chroma_.end(), std::uint16_t{0});
      for (std::size_t column = 0; column < width_; column += 2) {
        const Yuv a = to_yuv(from + 3 * column);
        const Yuv b = column + 1 < width_ ? to_yuv(from + 3 * column + 3) : a;
        to[column] = static_cast<std::uint8_t>(a.y);
        if (column + 1 < width_) to[column + 1] = static_cast<std::uint8_t>(b.y);
        chroma_[column] = static_cast<std::uint16_t>(chroma_[column] + a.u + b.u);
        chroma_[column + 1] = static_cast<std::uint16_t>(chroma_[column + 1] + a.v + b.v);
      }
      const int count = begins_block ? 2 : 4;
      for (std::size_t i = 0; ends_block && i < chroma_.size(); ++i) {
        chroma[i] = static_cast<std::uint8_t>((chroma_[i] + count / 2) / count);
      }
      return;
    }
  }
}

}  // namespace touchline::hal::mock
