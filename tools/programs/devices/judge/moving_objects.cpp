#include "tools/programs/devices/judge/moving_objects.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace touchline::devices {
namespace {

// One pixel in 300 000 exceeds five standard deviations; small regions are left out anyway.
constexpr double kThresholdInNoise = 5.0;
// JPEG and lamps change still pixels by a few levels.
constexpr double kMinThreshold = 6.0;
// Smaller objects are skipped. The error of an edge is a fraction of a pixel, so their lean would be too uncertain.
constexpr double kMinArea = 150.0;

}  // namespace

MovingObjectFinder::MovingObjectFinder(LumaPicture background, double noise)
    : background_(std::move(background)),
      threshold_(static_cast<float>(std::max(kMinThreshold, kThresholdInNoise * noise))),
      weight_(background_.value.size()) {}

const std::vector<MovingObject>& MovingObjectFinder::find(const LumaPicture& picture) {
  found_.clear();
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    const float difference = std::abs(picture.value[i] - background_.value[i]);
    // Edge pixels that are partly covered get a fractional weight, so that moments do not change in steps of a pixel.
    weight_[i] = std::clamp((difference - threshold_) / threshold_, 0.0f, 1.0f);
  }
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    if (weight_[i] <= 0.0f) continue;
    const MovingObject object = measure(i);
    if (object.area >= kMinArea) found_.push_back(object);
  }
  return found_;
}

/// Measures the region that contains `seed` (8-neighborhood) and clears its weights.
MovingObject MovingObjectFinder::measure(std::size_t seed) {
  const std::size_t width = background_.width, height = background_.height;
  MovingObject object;
  double sum = 0.0, sum_x = 0.0, sum_y = 0.0, sum_xy = 0.0, sum_yy = 0.0;
  // Coordinates are relative to the seed, because squares of large coordinates lose digits.
  const std::size_t seed_row = seed / width;
  const auto origin_x = static_cast<double>(seed % width), origin_y = static_cast<double>(seed_row);
  open_.assign(1, seed);
  double weight = static_cast<double>(std::exchange(weight_[seed], 0.0f));
  std::vector<double> weights{weight};
  while (!open_.empty()) {
    const std::size_t i = open_.back();
    open_.pop_back();
    weight = weights.back();
    weights.pop_back();
    const std::size_t column = i % width, row = i / width;
    const double x = static_cast<double>(column) - origin_x, y = static_cast<double>(row) - origin_y;
    sum += weight;
    sum_x += weight * x;
    sum_y += weight * y;
    sum_xy += weight * x * y;
    sum_yy += weight * y * y;
    object.cut_at_side = object.cut_at_side || column == 0 || column + 1 == width;
    object.cut_at_end = object.cut_at_end || row == 0 || row + 1 == height;
    const std::size_t left = column == 0 ? 0 : column - 1, right = std::min(column + 1, width - 1);
    const std::size_t top = row == 0 ? 0 : row - 1, bottom = std::min(row + 1, height - 1);
    for (std::size_t v = top; v <= bottom; ++v) {
      for (std::size_t u = left; u <= right; ++u) {
        const std::size_t next = v * width + u;
        if (weight_[next] <= 0.0f) continue;
        open_.push_back(next);
        weights.push_back(static_cast<double>(std::exchange(weight_[next], 0.0f)));
      }
    }
  }
  const double mean_x = sum_x / sum, mean_y = sum_y / sum;
  const double variance_y = std::max(sum_yy / sum - mean_y * mean_y, 1e-6);
  object.x = origin_x + mean_x;
  object.y = origin_y + mean_y;
  object.lean = (sum_xy / sum - mean_x * mean_y) / variance_y;
  object.log_height = 0.5 * std::log(variance_y);
  object.area = sum;
  return object;
}

}  // namespace touchline::devices
