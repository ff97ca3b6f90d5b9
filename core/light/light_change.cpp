#include "core/light/light_change.h"

#include <algorithm>
#include <numeric>

namespace touchline {

Status LightChange::configure(std::uint16_t width_px, std::uint16_t height_px, float max_levels) {
  if (width_px < 2 || height_px < 2 || !(max_levels > 0.0f)) return ErrorCode::kOutOfRange;
  columns_per_px_ = static_cast<float>(kColumns - 1) / static_cast<float>(width_px - 1);
  rows_per_px_ = static_cast<float>(kRows - 1) / static_cast<float>(height_px - 1);
  max_levels_ = max_levels;
  reset();
  return {};
}

void LightChange::reset() {
  for (Plane& plane : levels_) plane.fill(0.0f);
}

void LightChange::observe(const PixelPoint& where, const std::array<float, 3>& levels,
                          const std::array<float, 3>& weight, float step) {
  const std::array<Corner, 4> corners = around(where);
  float squares = 0;
  for (const Corner& corner : corners) squares += corner.weight * corner.weight;
  for (std::size_t channel = 0; channel < levels_.size(); ++channel) {
    Plane& plane = levels_[channel];
    const float deviation = std::clamp(levels[channel] - value_at(plane, corners), -kMaxStep_levels, kMaxStep_levels);
    // With this scale, the interpolated value at `where` moves by step * weight * deviation.
    const float move = step * weight[channel] * deviation / squares;
    for (const Corner& corner : corners) {
      plane[corner.node] = std::clamp(plane[corner.node] + move * corner.weight, -max_levels_, max_levels_);
    }
  }
}

void LightChange::relax(float step) {
  const std::array<Plane, 3> before = levels_;
  for (std::size_t node = 0; node < kColumns * kRows; ++node) {
    const std::size_t column = node % kColumns, row = node / kColumns;
    const float common = (before[0][node] + before[1][node] + before[2][node]) / 3.0f;
    for (std::size_t channel = 0; channel < levels_.size(); ++channel) {
      const Plane& old = before[channel];
      float sum = 0, neighbors = 0;
      const auto add = [&](bool there, std::size_t neighbor) {
        if (!there) return;
        sum += old[neighbor];
        neighbors += 1;
      };
      add(column > 0, node - 1);
      add(column + 1 < kColumns, node + 1);
      add(row > 0, node - kColumns);
      add(row + 1 < kRows, node + kColumns);
      levels_[channel][node] += step * (kSpread * (sum / neighbors - old[node]) + kCommon * (common - old[node]));
    }
  }
}

float LightChange::at(std::size_t channel, const PixelPoint& where) const {
  return value_at(levels_[channel], around(where));
}

std::array<float, 3> LightChange::at(const PixelPoint& where) const {
  const std::array<Corner, 4> corners = around(where);
  return {value_at(levels_[0], corners), value_at(levels_[1], corners), value_at(levels_[2], corners)};
}

float LightChange::mean() const {
  float sum = 0;
  for (const Plane& plane : levels_) sum = std::accumulate(plane.begin(), plane.end(), sum);
  return sum / static_cast<float>(levels_.size() * kColumns * kRows);
}

std::array<LightChange::Corner, 4> LightChange::around(const PixelPoint& where) const {
  const float x = std::clamp(where.u_px * columns_per_px_, 0.0f, static_cast<float>(kColumns - 1));
  const float y = std::clamp(where.v_px * rows_per_px_, 0.0f, static_cast<float>(kRows - 1));
  const std::size_t column = std::min<std::size_t>(static_cast<std::size_t>(x), kColumns - 2);
  const std::size_t row = std::min<std::size_t>(static_cast<std::size_t>(y), kRows - 2);
  const float right = x - static_cast<float>(column), down = y - static_cast<float>(row);
  const std::size_t node = row * kColumns + column;
  return {{{node, (1 - right) * (1 - down)},
           {node + 1, right * (1 - down)},
           {node + kColumns, (1 - right) * down},
           {node + kColumns + 1, right * down}}};
}

float LightChange::value_at(const Plane& plane, const std::array<Corner, 4>& corners) {
  float value = 0;
  for (const Corner& corner : corners) value += corner.weight * plane[corner.node];
  return value;
}

}  // namespace touchline
