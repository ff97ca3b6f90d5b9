#include "tools/programs/relight/changed_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace touchline::relight {
namespace {

constexpr double kGamma = 2.2;

std::uint8_t to_byte(double value) { return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L)); }

// One channel of a picture. Reads beyond the border return the nearest pixel.
struct Plane {
  std::size_t width = 0, height = 0;
  std::vector<double> values;

  [[nodiscard]] double at(std::ptrdiff_t u, std::ptrdiff_t v) const {
    const auto column =
        static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(u, 0, static_cast<std::ptrdiff_t>(width) - 1));
    const auto row =
        static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(v, 0, static_cast<std::ptrdiff_t>(height) - 1));
    return values[row * width + column];
  }
};

template <class Value>
Plane make_plane(std::size_t width, std::size_t height, Value&& value) {
  Plane plane{width, height, {}};
  plane.values.reserve(width * height);
  for (std::size_t v = 0; v < height; ++v) {
    for (std::size_t u = 0; u < width; ++u) plane.values.push_back(value(u, v));
  }
  return plane;
}

void relight(hal::Picture& picture, const PictureChange& change) {
  std::array<std::array<std::uint8_t, 256>, 2> table{};  // left half, right half
  for (std::size_t i = 0; i < 256; ++i) {
    const auto value = static_cast<double>(i);
    table[0][i] = to_byte(value * std::pow(change.light * change.shadow, 1 / kGamma));
    table[1][i] = to_byte(value * std::pow(change.light, 1 / kGamma));
  }
  for (std::size_t i = 0; i < picture.rgb8.size(); ++i) {
    const bool left = 2 * ((i / 3) % picture.width_px) < picture.width_px;
    picture.rgb8[i] = table[left ? 0 : 1][picture.rgb8[i]];
  }
}

Plane blurred(const Plane& in, double deviation) {
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(3 * deviation));
  std::vector<double> weights;
  double sum = 0;
  for (std::ptrdiff_t i = -reach; i <= reach; ++i) {
    weights.push_back(std::exp(-0.5 * static_cast<double>(i * i) / (deviation * deviation)));
    sum += weights.back();
  }
  const auto along = [&](const Plane& plane, std::ptrdiff_t du, std::ptrdiff_t dv) {
    return make_plane(plane.width, plane.height, [&](std::size_t u, std::size_t v) {
      double value = 0;
      for (std::ptrdiff_t i = -reach; i <= reach; ++i) {
        value += weights[static_cast<std::size_t>(i + reach)] *
                 plane.at(static_cast<std::ptrdiff_t>(u) + i * du, static_cast<std::ptrdiff_t>(v) + i * dv);
      }
      return value / sum;
    });
  };
  return along(along(in, 1, 0), 0, 1);
}

void blur(hal::Picture& picture, double deviation) {
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const Plane plane =
        blurred(make_plane(picture.width_px, picture.height_px,
                           [&](std::size_t u, std::size_t v) {
                             return static_cast<double>(picture.rgb8[3 * (v * picture.width_px + u) + channel]);
                           }),
                deviation);
    for (std::size_t i = 0; i < plane.values.size(); ++i) picture.rgb8[3 * i + channel] = to_byte(plane.values[i]);
  }
}

constexpr std::size_t kBlock = 8;
using Quantization = std::array<int, kBlock * kBlock>;

// ITU-T T.81 tables K.1 and K.2, which libjpeg scales with its quality.
constexpr Quantization kLuminance = {16, 11, 10, 16, 24,  40,  51,  61,  12, 12, 14, 19, 26,  58,  60,  55,
                                     14, 13, 16, 24, 40,  57,  69,  56,  14, 17, 22, 29, 51,  87,  80,  62,  //
                                     18, 22, 37, 56, 68,  109, 103, 77,  24, 35, 55, 64, 81,  104, 113, 92,
                                     49, 64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99};
constexpr Quantization kChrominance = {17, 18, 24, 47, 99, 99, 99, 99, 18, 21, 26, 66, 99, 99, 99, 99,
                                       24, 26, 56, 99, 99, 99, 99, 99, 47, 66, 99, 99, 99, 99, 99, 99,  //
                                       99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99,
                                       99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99};

double step_of(const Quantization& table, std::size_t i, int quality) {
  const int scale = quality < 50 ? 5000 / quality : 200 - 2 * quality;
  return std::clamp((table[i] * scale + 50) / 100, 1, 255);
}

// Returns the orthonormal discrete cosine transform; row k is its k-th basis vector.
const std::array<std::array<double, kBlock>, kBlock>& cosines() {
  static const auto rows = [] {
    std::array<std::array<double, kBlock>, kBlock> out{};
    for (std::size_t k = 0; k < kBlock; ++k) {
      for (std::size_t i = 0; i < kBlock; ++i) {
        out[k][i] =
            std::sqrt((k == 0 ? 1.0 : 2.0) / kBlock) *
            std::cos(std::numbers::pi * (2.0 * static_cast<double>(i) + 1) * static_cast<double>(k) / (2.0 * kBlock));
      }
    }
    return out;
  }();
  return rows;
}

using Block = std::array<double, kBlock * kBlock>;

// Returns the transform of a block, or the inverse transform if `inverse` is set.
Block transformed(const Block& in, bool inverse) {
  const auto& c = cosines();
  const auto weight = [&](std::size_t k, std::size_t i) { return inverse ? c[i][k] : c[k][i]; };
  Block rows{}, out{};
  for (std::size_t y = 0; y < kBlock; ++y) {
    for (std::size_t k = 0; k < kBlock; ++k) {
      for (std::size_t i = 0; i < kBlock; ++i) rows[y * kBlock + k] += weight(k, i) * in[y * kBlock + i];
    }
  }
  for (std::size_t k = 0; k < kBlock; ++k) {
    for (std::size_t i = 0; i < kBlock; ++i) {
      for (std::size_t x = 0; x < kBlock; ++x) out[k * kBlock + x] += weight(k, i) * rows[i * kBlock + x];
    }
  }
  return out;
}

// Quantizes the plane as the encoder does, and reconstructs it.
void quantize(Plane& plane, const Quantization& table, int quality) {
  for (std::size_t top = 0; top < plane.height; top += kBlock) {
    for (std::size_t left = 0; left < plane.width; left += kBlock) {
      Block block{};
      for (std::size_t i = 0; i < block.size(); ++i) {
        block[i] =
            plane.at(static_cast<std::ptrdiff_t>(left + i % kBlock), static_cast<std::ptrdiff_t>(top + i / kBlock));
      }
      block = transformed(block, false);
      for (std::size_t i = 0; i < block.size(); ++i) {
        const double step = step_of(table, i, quality);
        block[i] = step * std::round(block[i] / step);
      }
      block = transformed(block, true);
      for (std::size_t i = 0; i < block.size(); ++i) {
        const std::size_t u = left + i % kBlock, v = top + i / kBlock;
        if (u < plane.width && v < plane.height) plane.values[v * plane.width + u] = block[i];
      }
    }
  }
}

// Compresses as JFIF does: luminance in full resolution, both color differences with half the columns and rows.
void compress(hal::Picture& picture, int quality) {
  const std::size_t width = picture.width_px, height = picture.height_px;
  const auto weighted = [&](std::size_t u, std::size_t v, const std::array<double, 3>& weights) {
    const std::uint8_t* rgb = &picture.rgb8[3 * (v * width + u)];
    return weights[0] * rgb[0] + weights[1] * rgb[1] + weights[2] * rgb[2];
  };
  const auto halved = [&](const std::array<double, 3>& weights) {
    return make_plane((width + 1) / 2, (height + 1) / 2, [&](std::size_t u, std::size_t v) {
      const std::size_t right = std::min(2 * u + 1, width - 1), below = std::min(2 * v + 1, height - 1);
      return 0.25 * (weighted(2 * u, 2 * v, weights) + weighted(right, 2 * v, weights) +
                     weighted(2 * u, below, weights) + weighted(right, below, weights));
    });
  };
  Plane luminance = make_plane(width, height, [&](std::size_t u, std::size_t v) {
    return weighted(u, v, {0.299, 0.587, 0.114}) - 128;
  });
  Plane blue = halved({-0.168736, -0.331264, 0.5}), red = halved({0.5, -0.418688, -0.081312});
  quantize(luminance, kLuminance, quality);
  quantize(blue, kChrominance, quality);
  quantize(red, kChrominance, quality);
  for (std::size_t v = 0; v < height; ++v) {
    for (std::size_t u = 0; u < width; ++u) {
      const auto half_u = static_cast<std::ptrdiff_t>(u / 2), half_v = static_cast<std::ptrdiff_t>(v / 2);
      const double y = luminance.values[v * width + u] + 128, cb = blue.at(half_u, half_v), cr = red.at(half_u, half_v);
      std::uint8_t* rgb = &picture.rgb8[3 * (v * width + u)];
      rgb[0] = to_byte(y + 1.402 * cr);
      rgb[1] = to_byte(y - 0.344136 * cb - 0.714136 * cr);
      rgb[2] = to_byte(y + 1.772 * cb);
    }
  }
}

}  // namespace

hal::Picture changed(const hal::Picture& picture, const PictureChange& change) {
  hal::Picture out = picture;
  if (change.light != 1.0 || change.shadow != 1.0) relight(out, change);
  if (change.blur_px > 0) blur(out, change.blur_px);
  if (change.values != PictureChange().values) {
    for (std::size_t i = 0; i < out.rgb8.size(); ++i) out.rgb8[i] = to_byte(out.rgb8[i] * change.values[i % 3]);
  }
  if (change.jpeg_quality > 0) compress(out, change.jpeg_quality);
  return out;
}

}  // namespace touchline::relight
