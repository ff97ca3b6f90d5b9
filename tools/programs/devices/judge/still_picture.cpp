#include "tools/programs/devices/judge/still_picture.h"

#include <algorithm>
#include <cmath>

#include "tools/programs/devices/judge/luma_picture.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::devices {
namespace {

// Darker or brighter pixels are not used, because clipping hides their noise.
constexpr float kMinUsableLuma = 24.0f, kMaxUsableLuma = 248.0f;

double deviation(const std::vector<double>& values) {
  const double mean = statistics::mean(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace

void StillMeasurement::add(const Frame& frame) {
  const LumaReader luma(frame);
  const std::size_t rows = std::min<std::size_t>(kRows, frame.height_px), width = frame.width_px;
  if (frames_ == 0) {
    last_.assign(rows * width, 0.0f);
    sum_ = squared_steps_ = last_;
  }
  const std::size_t count = std::min(kBands, rows);
  std::vector<double> bands(count, 0.0);
  std::vector<std::size_t> pixels(count, 0);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t v = row * frame.height_px / rows, band = row * count / rows;
    double total = 0.0;
    for (std::size_t u = 0; u < width; ++u) {
      const std::size_t i = row * width + u;
      const float value = luma(u, v), step = value - last_[i];
      if (frames_ > 0) squared_steps_[i] += step * step;
      sum_[i] += value;
      last_[i] = value;
      total += static_cast<double>(value);
    }
    bands[band] += total;
    pixels[band] += width;
  }
  for (std::size_t band = 0; band < count; ++band) bands[band] /= static_cast<double>(pixels[band]);
  bands_.push_back(std::move(bands));
  ++frames_;
}

StillReport StillMeasurement::report() const {
  StillReport report;
  if (frames_ < 2) return report;
  const auto frames = static_cast<float>(frames_);
  std::vector<float> means, variances, usable;
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    const float mean = sum_[i] / frames;
    means.push_back(mean);
    // A difference of consecutive frames has twice the variance of a pixel, and is free of slow changes of the light.
    const float variance = squared_steps_[i] / (2.0f * (frames - 1.0f));
    variances.push_back(variance);
    if (mean > kMinUsableLuma && mean < kMaxUsableLuma) usable.push_back(variance);
  }
  report.brightness = static_cast<double>(statistics::median(means));
  std::vector<float>& pixels = usable.size() * 10 >= variances.size() ? usable : variances;
  report.noise = std::sqrt(static_cast<double>(statistics::median(pixels)));
  const std::size_t bands = bands_[0].size();
  std::vector<double> common(frames_, 0.0), flickers, differences;
  std::vector<std::vector<double>> relative(bands, std::vector<double>(frames_, 0.0));
  for (std::size_t band = 0; band < bands; ++band) {
    double mean = 0.0;
    for (const std::vector<double>& frame : bands_) mean += frame[band] / static_cast<double>(frames_);
    for (std::size_t i = 0; i < frames_; ++i) {
      relative[band][i] = bands_[i][band] / std::max(mean, 1.0) - 1.0;
      common[i] += relative[band][i] / static_cast<double>(bands);
    }
  }
  for (std::vector<double>& band : relative) {
    flickers.push_back(deviation(band));
    for (std::size_t i = 0; i < frames_; ++i) band[i] -= common[i];
    differences.push_back(deviation(band));
  }
  report.flicker = statistics::median(flickers);
  report.has_bands = statistics::median(differences) > 0.5 * report.flicker;
  return report;
}

}  // namespace touchline::devices
