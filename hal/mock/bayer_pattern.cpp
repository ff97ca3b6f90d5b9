#include "hal/mock/bayer_pattern.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace touchline::hal::mock {
namespace {

// Beyond the edge, the picture is mirrored about its last pixel, which keeps the pattern.
std::size_t mirrored(std::size_t at, int by, std::size_t size) {
  const auto moved = static_cast<std::ptrdiff_t>(at) + by, last = static_cast<std::ptrdiff_t>(size) - 1;
  return static_cast<std::size_t>(moved < 0 ? -moved : moved > last ? 2 * last - moved : moved);
}

}  // namespace

BayerInterpolation::BayerInterpolation(BayerPattern pattern, std::size_t width_px, std::size_t height_px)
    : width_(width_px),
      height_(height_px),
      red_column_(pattern == BayerPattern::kGrbg || pattern == BayerPattern::kBggr ? 1 : 0),
      red_row_(pattern == BayerPattern::kGbrg || pattern == BayerPattern::kBggr ? 1 : 0) {}

std::size_t BayerInterpolation::color_at(std::size_t column, std::size_t row) const {
  return (column + red_column_) % 2 + (row + red_row_) % 2;
}

void BayerInterpolation::interpolate_row(std::span<const float> measured, std::size_t row, std::span<float> out) const {
  const auto line = [&](int by) { return measured.subspan(mirrored(row, by, height_) * width_, width_); };
  const std::span<const float> above = line(-1), here = line(0), below = line(1);
  for (std::size_t column = 0; column < width_; ++column) {
    const std::size_t left = mirrored(column, -1, width_), right = mirrored(column, 1, width_);
    const float beside = 0.5f * (here[left] + here[right]), stacked = 0.5f * (above[column] + below[column]);
    const float diagonal = 0.25f * (above[left] + above[right] + below[left] + below[right]);
    const std::size_t own = color_at(column, row);
    float* const rgb = &out[3 * column];
    rgb[own] = here[column];
    if (own != 1) {
      rgb[1] = 0.5f * (beside + stacked);
      rgb[2 - own] = diagonal;
    } else {
      const std::size_t in_row = color_at(right, row);
      rgb[in_row] = beside;
      rgb[2 - in_row] = stacked;
    }
  }
}

GaussianBlur::GaussianBlur(double sigma_px, std::size_t width_px, std::size_t height_px)
    : width_(width_px), height_(height_px), across_(3 * width_px * height_px), out_(across_.size()) {
  const auto reach = static_cast<std::size_t>(std::ceil(4.0 * sigma_px));
  double sum = 0.0;
  for (std::size_t i = 0; i <= reach; ++i) {
    const double at = static_cast<double>(i) / sigma_px, value = std::exp(-0.5 * at * at);
    weight_.push_back(static_cast<float>(value));
    sum += i == 0 ? value : 2.0 * value;
  }
  for (float& weight : weight_) weight /= static_cast<float>(sum);
}

std::span<const std::uint16_t> GaussianBlur::operator()(std::span<const std::uint16_t> linear) {
  const auto blurred = [this](std::size_t at, std::size_t size, const auto& value) {
    float sum = weight_[0] * value(at);
    for (std::size_t i = 1; i < weight_.size(); ++i) {
      sum += weight_[i] * (value(at < i ? 0 : at - i) + value(std::min(at + i, size - 1)));
    }
    return sum;
  };
  for (std::size_t row = 0; row < height_; ++row) {
    for (std::size_t i = 0; i < 3 * width_; ++i) {
      across_[3 * width_ * row + i] = blurred(i / 3, width_, [&](std::size_t column) {
        return static_cast<float>(linear[3 * (width_ * row + column) + i % 3]);
      });
    }
  }
  for (std::size_t i = 0; i < out_.size(); ++i) {
    const float value = blurred(i / (3 * width_), height_,
                                [&](std::size_t row) { return across_[3 * width_ * row + i % (3 * width_)]; });
    out_[i] = static_cast<std::uint16_t>(std::lround(value));
  }
  return out_;
}

}  // namespace touchline::hal::mock
