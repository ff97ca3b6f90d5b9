#include "tools/calibrate/light_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tools/calibrate/channel_image.h"
#include "tools/calibrate/text.h"

namespace touchline::calibrate {
namespace {

constexpr std::size_t kMaxColumns = 64, kMaxRows = 48;
// A cell of fewer pixels has no robust median.
constexpr std::size_t kLeastCellSide_px = 4;
// 8-bit values: the last steps before the sensor's end, and where one step is more than 10 %.
constexpr double kSaturated = 250.0, kDark = 10.0;
// Below, core/light has no gain (it ends at 4); above, the file has no value (65535 is 1.99997).
constexpr float kLeastIllumination = 0.25f, kMostIllumination = 65535.0f / 32768.0f;

using Plane = std::vector<double>;

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double value_at(const hal::Picture& picture, std::size_t index) {
  return picture.deep() ? picture.rgb16[index] / 257.0 : static_cast<double>(picture.rgb8[index]);
}

class Grid {
 public:
  Grid(std::size_t width, std::size_t height)
      : width_(width),
        height_(height),
        columns_(std::min(kMaxColumns, std::max<std::size_t>(1, width / kLeastCellSide_px))),
        rows_(std::min(kMaxRows, std::max<std::size_t>(1, height / kLeastCellSide_px))) {}

  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t cells() const { return columns_ * rows_; }

  // Median of every cell's pixels that count; NaN where there are none.
  [[nodiscard]] Plane reduce(const Plane& pixels, const std::vector<std::uint8_t>& inside) const {
    Plane out(cells(), std::numeric_limits<double>::quiet_NaN());
    std::vector<double> values;
    for (std::size_t row = 0; row < rows_; ++row) {
      for (std::size_t column = 0; column < columns_; ++column) {
        values.clear();
        for (std::size_t v = row * height_ / rows_; v < (row + 1) * height_ / rows_; ++v) {
          for (std::size_t u = column * width_ / columns_; u < (column + 1) * width_ / columns_; ++u) {
            if (inside[v * width_ + u] != 0) values.push_back(pixels[v * width_ + u]);
          }
        }
        if (!values.empty()) out[row * columns_ + column] = median(values);
      }
    }
    return out;
  }

  // A cell without pixels takes the nearest cell that has some.
  void fill(Plane& plane) const {
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

  // The paper's "slight Gaussian blurring", sigma one cell, mirrored at the border.
  [[nodiscard]] Plane smooth(const Plane& plane) const {
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

 private:
  std::size_t width_, height_, columns_, rows_;
};

}  // namespace

Status fit_light(const std::vector<hal::Picture>& pictures, const Polygon& region_of_interest, LightMap& out,
                 LightReport& report, std::string& reason) {
  report = {};
  if (pictures.empty() || pictures[0].width_px == 0 || pictures[0].height_px == 0) {
    reason = "no reference picture";
    return ErrorCode::kOutOfRange;
  }
  const std::size_t width = pictures[0].width_px, height = pictures[0].height_px;
  for (const hal::Picture& p : pictures) {
    if (p.width_px != width || p.height_px != height) {
      reason =
          text("the reference pictures differ in size: %zu x %zu and %u x %u", width, height, p.width_px, p.height_px);
      return ErrorCode::kInconsistent;
    }
  }
  const std::vector<std::uint8_t> inside =
      inside_mask(region_of_interest, static_cast<int>(width), static_cast<int>(height));
  const Grid grid(width, height);
  std::array<Plane, 3> planes;
  std::vector<std::uint8_t> known(grid.cells(), 0), saturated(grid.cells(), 0), dark(grid.cells(), 0);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    Plane mean(width * height, 0.0);
    for (std::size_t i = 0; i < mean.size(); ++i) {
      for (const hal::Picture& p : pictures) mean[i] += value_at(p, 3 * i + channel);
      mean[i] /= static_cast<double>(pictures.size());
    }
    planes[channel] = grid.reduce(mean, inside);
    for (std::size_t i = 0; i < grid.cells(); ++i) {
      if (std::isnan(planes[channel][i])) continue;
      known[i] = 1;
      if (planes[channel][i] >= kSaturated) saturated[i] = 1;
      if (planes[channel][i] < kDark) dark[i] = 1;
    }
  }
  const auto cells = static_cast<std::size_t>(std::count(known.begin(), known.end(), 1));
  report.saturated_cells = static_cast<std::size_t>(std::count(saturated.begin(), saturated.end(), 1));
  report.dark_cells = static_cast<std::size_t>(std::count(dark.begin(), dark.end(), 1));
  if (cells == 0 || 2 * report.saturated_cells > cells || 2 * report.dark_cells > cells) {
    reason = text("%zu of %zu cells are saturated and %zu are black: change the exposure", report.saturated_cells,
                  cells, report.dark_cells);
    return ErrorCode::kOutOfRange;
  }

  std::array<Plane, 3> smooth;
  // One factor for all channels: a grey surface stays grey.
  double factor = 1.0;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    grid.fill(planes[channel]);
    smooth[channel] = grid.smooth(planes[channel]);
    std::vector<double> values;
    for (std::size_t i = 0; i < grid.cells(); ++i) {
      if (known[i] != 0) values.push_back(smooth[channel][i]);
    }
    report.normal[channel] = median(values);
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    report.least[channel] = *least;
    report.most[channel] = *most;
    factor = std::max(factor, *most / report.normal[channel] / static_cast<double>(kMostIllumination));
  }
  LightMap map;
  map.columns = static_cast<std::uint16_t>(grid.columns());
  map.rows = static_cast<std::uint16_t>(grid.rows());
  std::vector<std::uint8_t> clamped(grid.cells(), 0);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    report.normal[channel] *= factor;
    report.least[channel] /= report.normal[channel];
    report.most[channel] /= report.normal[channel];
    for (std::size_t i = 0; i < grid.cells(); ++i) {
      const auto ratio = static_cast<float>(smooth[channel][i] / report.normal[channel]);
      map.illumination[channel][i] = std::clamp(ratio, kLeastIllumination, kMostIllumination);
      if (known[i] != 0 && ratio < kLeastIllumination) clamped[i] = 1;
    }
  }
  report.clamped_cells = static_cast<std::size_t>(std::count(clamped.begin(), clamped.end(), 1));
  out = map;
  return {};
}

hal::Picture map_picture(const LightMap& map) {
  hal::Picture picture;
  picture.width_px = map.columns;
  picture.height_px = map.rows;
  const std::size_t cells = static_cast<std::size_t>(map.columns) * map.rows;
  picture.rgb16.resize(3 * cells);
  for (std::size_t i = 0; i < cells; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const long value = std::lround(static_cast<double>(map.illumination[c][i]) * 32768.0);
      picture.rgb16[3 * i + c] = static_cast<std::uint16_t>(std::clamp(value, 1L, 65535L));
    }
  }
  return picture;
}

}  // namespace touchline::calibrate
