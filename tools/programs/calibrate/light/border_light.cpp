#include "tools/programs/calibrate/light/border_light.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace touchline::calibrate {
namespace {

constexpr double kAlong_m = 0.02;
// Range across the border's edge in which samples are taken; the border is 2 to 5 cm wide and its edges are blurred.
constexpr double kNearest_m = 0.008, kOutwards_m = 0.003;
constexpr int kStepsOutwards = 15;
constexpr double kFarthest_m = kNearest_m + kStepsOutwards * kOutwards_m;
constexpr double kCorner_m = 0.15;
// Number of pixels that are averaged at each sampling point: the brightest ones, which lie inside the border.
constexpr std::size_t kBrightest = 3;
constexpr std::size_t kMinPlaces = 40;
constexpr int kRounds = 40;
// Limit of a deviation of the logarithm: below it the square counts, above it the absolute value.
constexpr double kFine = 0.01;
// Weight of the regularization of the quadratic terms, per sample.
constexpr double kStiffness = 1e-3;

constexpr int kTerms = 6;
using Terms = Eigen::Matrix<double, kTerms, 1>;

// Returns the polynomial terms at a position in the picture; x and y from -1 to 1.
Terms terms_at(double x, double y) { return (Terms() << 1, x, y, x * x, x * y, y * y).finished(); }

struct Sample {
  Terms terms;
  std::array<double, 3> log_value{};
};

Terms fit(const std::vector<Sample>& samples, std::size_t channel) {
  Terms solution = Terms::Zero();
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix<double, kTerms, kTerms> normal = Eigen::Matrix<double, kTerms, kTerms>::Zero();
    Terms right = Terms::Zero();
    for (const Sample& sample : samples) {
      const double off = std::abs(sample.terms.dot(solution) - sample.log_value[channel]);
      const double weight = round == 0 ? 1.0 : kFine / std::max(kFine, off);
      normal += weight * sample.terms * sample.terms.transpose();
      right += weight * sample.log_value[channel] * sample.terms;
    }
    for (int i = 3; i < kTerms; ++i) normal(i, i) += kStiffness * static_cast<double>(samples.size());
    solution = normal.ldlt().solve(right);
  }
  return solution;
}

}  // namespace

std::vector<BorderPlace> border_places(const CameraModel& camera, const FieldParameters& field, std::size_t width_px,
                                       std::size_t height_px) {
  std::vector<BorderPlace> places;
  const double x = static_cast<double>(field.length_m) / 2, y = static_cast<double>(field.width_m) / 2;
  const double goal = static_cast<double>(field.goal_width_m) / 2 + kFarthest_m;
  const auto add = [&](double at_x, double at_y, double out_x, double out_y) {
    BorderPlace place;
    for (int step = 0; step < kStepsOutwards; ++step) {
      const double out = kNearest_m + step * kOutwards_m;
      const PixelPoint p =
          camera.to_pixel({static_cast<float>(at_x + out * out_x), static_cast<float>(at_y + out * out_y)}, 0.0f);
      const long u = std::lround(p.u_px), v = std::lround(p.v_px);
      if (u < 0 || v < 0 || u >= static_cast<long>(width_px) || v >= static_cast<long>(height_px)) continue;
      const std::size_t index = static_cast<std::size_t>(v) * width_px + static_cast<std::size_t>(u);
      if (place.empty() || place.back() != index) place.push_back(index);
    }
    if (place.size() >= kBrightest) places.push_back(std::move(place));
  };
  const auto along = [](double half, auto&& visit) {
    const int steps = static_cast<int>((half - kCorner_m) / kAlong_m);
    for (int i = -steps; i <= steps; ++i) visit(i * kAlong_m);
  };
  along(x, [&](double at) {
    add(at, -y, 0, -1);
    add(at, y, 0, 1);
  });
  along(y, [&](double at) {
    if (std::abs(at) < goal) return;
    add(-x, at, -1, 0);
    add(x, at, 1, 0);
  });
  return places;
}

Result<void> border_light(const std::array<Plane, 3>& background, const std::vector<BorderPlace>& places,
                          const LightGrid& grid, std::size_t width_px, std::size_t height_px,
                          std::array<Plane, 3>& cells) {
  const auto place_of = [](double pixel, std::size_t size) { return 2.0 * pixel / static_cast<double>(size) - 1.0; };
  std::vector<Sample> samples;
  std::size_t saturated = 0;
  for (const BorderPlace& place : places) {
    std::vector<std::size_t> brightest = place;
    const auto brightness = [&](std::size_t i) { return background[0][i] + background[1][i] + background[2][i]; };
    std::partial_sort(brightest.begin(), brightest.begin() + kBrightest, brightest.end(),
                      [&](std::size_t a, std::size_t b) { return brightness(a) > brightness(b); });
    std::array<double, 3> value{};
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < kBrightest; ++i) value[c] += background[c][brightest[i]] / double{kBrightest};
    }
    if (*std::max_element(value.begin(), value.end()) >= kSaturated) {
      ++saturated;
      continue;
    }
    if (*std::min_element(value.begin(), value.end()) < kDark) continue;
    Sample sample;
    const std::size_t column = brightest[0] % width_px, row = brightest[0] / width_px;
    sample.terms = terms_at(place_of(static_cast<double>(column) + 0.5, width_px),
                            place_of(static_cast<double>(row) + 0.5, height_px));
    for (std::size_t c = 0; c < 3; ++c) sample.log_value[c] = std::log(value[c]);
    samples.push_back(sample);
  }
  if (2 * saturated > places.size()) {
    return failure(ErrorCode::kNotFound, "the border is saturated at %zu of %zu points: shorten the exposure",
                   saturated, places.size());
  }
  if (samples.size() < kMinPlaces) {
    return failure(
        ErrorCode::kNotFound,
        "the border is bright enough at only %zu points; %zu are needed: check the camera model and the exposure",
        samples.size(), kMinPlaces);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    const Terms solution = fit(samples, c);
    cells[c].resize(grid.cells());
    for (std::size_t i = 0; i < grid.cells(); ++i) {
      const std::size_t column = i % grid.columns(), row = i / grid.columns();
      const double u = 0.5 * static_cast<double>(grid.left_px(column) + grid.left_px(column + 1));
      const double v = 0.5 * static_cast<double>(grid.top_px(row) + grid.top_px(row + 1));
      cells[c][i] = std::exp(solution.dot(terms_at(place_of(u, width_px), place_of(v, height_px))));
    }
  }
  return {};
}

}  // namespace touchline::calibrate
