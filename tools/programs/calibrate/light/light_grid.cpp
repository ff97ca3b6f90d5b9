#include "tools/programs/calibrate/light/light_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

constexpr std::size_t kMaxColumns = 64, kMaxRows = 48;
// In smaller cells, the median has too few pixels to be robust.
constexpr std::size_t kMinCellSide_px = 4;

}  // namespace

LightGrid::LightGrid(std::size_t width_px, std::size_t height_px)
    : width_px_(width_px),
      height_px_(height_px),
      columns_(std::min(kMaxColumns, std::max<std::size_t>(1, width_px / kMinCellSide_px))),
      rows_(std::min(kMaxRows, std::max<std::size_t>(1, height_px / kMinCellSide_px))) {}

Plane LightGrid::reduce(const Plane& pixels, const std::vector<std::uint8_t>& counts, double least_share) const {
  Plane out(cells(), std::numeric_limits<double>::quiet_NaN());
  std::vector<double> values;
  for (std::size_t row = 0; row < rows_; ++row) {
    for (std::size_t column = 0; column < columns_; ++column) {
      values.clear();
      double all = 0;
      for (std::size_t v = top_px(row); v < top_px(row + 1); ++v) {
        for (std::size_t u = left_px(column); u < left_px(column + 1); ++u) {
          all += 1;
          if (counts[v * width_px_ + u] != 0) values.push_back(pixels[v * width_px_ + u]);
        }
      }
      if (!values.empty() && static_cast<double>(values.size()) >= least_share * all) {
        out[row * columns_ + column] = statistics::median(values);
      }
    }
  }
  return out;
}

void LightGrid::fill(Plane& plane) const {
  const Plane known = plane;
  for (std::size_t i = 0; i < cells(); ++i) {
    if (!std::isnan(known[i])) continue;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < cells(); ++j) {
      if (std::isnan(known[j])) continue;
      const double dx = static_cast<double>(i % columns_) - static_cast<double>(j % columns_);
      const std::size_t row = i / columns_, other = j / columns_;
      const double dy = static_cast<double>(row) - static_cast<double>(other);
      if (dx * dx + dy * dy < nearest) {
        nearest = dx * dx + dy * dy;
        plane[i] = known[j];
      }
    }
  }
}

Plane LightGrid::smooth(const Plane& plane) const {
  constexpr std::array<double, 7> kKernel = {0.0044, 0.0540, 0.2420, 0.3992, 0.2420, 0.0540, 0.0044};
  const auto reflect = [](std::ptrdiff_t i, std::size_t n) {
    const auto size = static_cast<std::ptrdiff_t>(n);
    while (i < 0 || i >= size) i = i < 0 ? -i - 1 : 2 * size - 1 - i;
    return static_cast<std::size_t>(i);
  };
  Plane across(cells()), out(cells());
  for (std::size_t i = 0; i < cells(); ++i) {
    for (std::size_t k = 0; k < kKernel.size(); ++k) {
      const auto x = static_cast<std::ptrdiff_t>(i % columns_ + k) - 3;
      across[i] += kKernel[k] * plane[i / columns_ * columns_ + reflect(x, columns_)];
    }
  }
  for (std::size_t i = 0; i < cells(); ++i) {
    for (std::size_t k = 0; k < kKernel.size(); ++k) {
      const auto y = static_cast<std::ptrdiff_t>(i / columns_ + k) - 3;
      out[i] += kKernel[k] * across[reflect(y, rows_) * columns_ + i % columns_];
    }
  }
  return out;
}

Plane LightGrid::around(const Plane& plane, double sigma) const {
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(3 * sigma));
  std::vector<double> kernel;
  for (std::ptrdiff_t d = -reach; d <= reach; ++d) {
    kernel.push_back(std::exp(-static_cast<double>(d * d) / (2 * sigma * sigma)));
  }
  // Sums of weights and of weighted values, first along rows, then along columns.
  const auto convolve = [&](const Plane& in, std::size_t stride, std::size_t length, Plane& out) {
    for (std::size_t i = 0; i < cells(); ++i) {
      const auto at = static_cast<std::ptrdiff_t>(i / stride % length);
      for (std::ptrdiff_t d = std::max(-reach, -at); d <= std::min(reach, static_cast<std::ptrdiff_t>(length) - 1 - at);
           ++d) {
        const auto other =
            static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + d * static_cast<std::ptrdiff_t>(stride));
        out[i] += kernel[static_cast<std::size_t>(d + reach)] * in[other];
      }
    }
  };
  Plane weight(cells(), 0.0), value(cells(), 0.0);
  for (std::size_t i = 0; i < cells(); ++i) {
    if (std::isnan(plane[i])) continue;
    weight[i] = 1;
    value[i] = plane[i];
  }
  Plane weight_across(cells(), 0.0), value_across(cells(), 0.0), weights(cells(), 0.0), values(cells(), 0.0);
  convolve(weight, 1, columns_, weight_across);
  convolve(value, 1, columns_, value_across);
  convolve(weight_across, columns_, rows_, weights);
  convolve(value_across, columns_, rows_, values);
  Plane out(cells(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < cells(); ++i) {
    const double others = weights[i] - weight[i];
    if (others > 1e-3) out[i] = (values[i] - weight[i] * value[i]) / others;
  }
  return out;
}

}  // namespace touchline::calibrate
