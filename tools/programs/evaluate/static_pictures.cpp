#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tools/programs/evaluate/cramer_rao_bound.h"

namespace touchline::evaluate {
namespace {

// Variance of a rounded value without other noise.
constexpr double kRoundingVariance = 1.0 / 12.0;
// Least ratio of the variance of measured values to that of all values of their color: bilinear interpolation leaves
// less than half of the variance, plus the rounding. Without a Bayer pattern, the ratio is 1 within a few percent.
constexpr double kMeasuredNoise = 1.25;
// If a picture has more pixels, the noise is compared with the neighbors' only at every third pixel of every third row.
constexpr std::size_t kAllPixels = 100000;

}  // namespace

StaticPictures::StaticPictures(std::size_t width_px, std::size_t height_px)
    : width_(width_px), height_(height_px), mean_(3 * width_px * height_px), squares_(mean_.size()) {}

void StaticPictures::add(std::vector<std::uint8_t> rgb) {
  pictures_.push_back(std::move(rgb));
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    const double value = pictures_.back()[i], before = value - mean_[i];
    mean_[i] += before / static_cast<double>(count());
    squares_[i] += before * (value - mean_[i]);
  }
}

void StaticPictures::estimate_noise() {
  find_bayer_pattern();
  estimate_variance();
  estimate_correlation();
}

void StaticPictures::find_bayer_pattern() {
  std::array<std::array<double, 4>, 3> noise{};
  for (std::size_t v = 0; v + 1 < height_; v += 2) {
    for (std::size_t u = 0; u + 1 < width_; u += 2) {
      for (std::size_t place = 0; place < 4; ++place) {
        for (std::size_t c = 0; c < 3; ++c) {
          noise[c][place] += squares_[((v + place / 2) * width_ + u + place % 2) * 3 + c];
        }
      }
    }
  }
  const auto noisiest = [&](std::size_t c) {
    return static_cast<std::size_t>(std::max_element(noise[c].begin(), noise[c].end()) - noise[c].begin());
  };
  const std::size_t red = noisiest(0), blue = noisiest(2);
  const auto stands_out = [&](std::size_t c, std::size_t place) {
    return 4.0 * noise[c][place] > kMeasuredNoise * (noise[c][0] + noise[c][1] + noise[c][2] + noise[c][3]);
  };
  step_ = red + blue == 3 && stands_out(0, red) && stands_out(2, blue) ? 2 : 1;
  for (std::size_t place = 0; place < 4; ++place) {
    measured_[0][place] = step_ == 1 || place == red;
    measured_[1][place] = step_ == 1 || (place != red && place != blue);
    measured_[2][place] = step_ == 1 || place == blue;
  }
}

void StaticPictures::estimate_variance() {
  std::array<std::array<double, kLevels>, 3> values{};
  variance_ = {};
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    const std::size_t c = i % 3, level = level_of(mean_[i]);
    if (!is_measured(i / 3 % width_, i / 3 / width_, c)) continue;
    variance_[c][level] += squares_[i] / static_cast<double>(count() - 1);
    values[c][level] += 1.0;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t level = 0; level < kLevels; ++level) {
      variance_[c][level] = std::max(kRoundingVariance, variance_[c][level] / std::max(1.0, values[c][level]));
    }
  }
}

double StaticPictures::deviation(std::size_t u, std::size_t v, std::size_t channel) const {
  return std::sqrt(variance_[channel][level_of(mean(u, v, channel))]);
}

StaticPictures::Channels StaticPictures::correlation_at(std::ptrdiff_t du, std::ptrdiff_t dv) const {
  Channels products = Channels::Zero(), pairs = Channels::Zero();
  const std::size_t sampled = width_ * height_ > kAllPixels ? 3 : 1;
  const auto margin = static_cast<std::size_t>(std::max(std::abs(du), std::abs(dv)));
  for (std::size_t v = margin; v + margin < height_; v += sampled) {
    for (std::size_t u = margin; u + margin < width_; u += sampled) {
      const auto other_u = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(u) + du);
      const auto other_v = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(v) + dv);
      const std::size_t at = 3 * (v * width_ + u), other = 3 * (other_v * width_ + other_u);
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t d = 0; d < 3; ++d) {
          if (!is_measured(u, v, c) || !is_measured(other_u, other_v, d)) continue;
          double sum = 0.0;
          for (const std::vector<std::uint8_t>& rgb : pictures_) {
            sum += (rgb[at + c] - mean_[at + c]) * (rgb[other + d] - mean_[other + d]);
          }
          const auto row = static_cast<Eigen::Index>(c), column = static_cast<Eigen::Index>(d);
          products(row, column) += sum / (deviation(u, v, c) * deviation(other_u, other_v, d));
          pairs(row, column) += static_cast<double>(count() - 1);
        }
      }
    }
  }
  return products.cwiseQuotient(pairs.cwiseMax(1.0));
}

void StaticPictures::estimate_correlation() {
  const auto step = static_cast<std::ptrdiff_t>(step_), reach = static_cast<std::ptrdiff_t>(kReach);
  // The variance is by definition that of a single value; correlations between colors are taken at the same pixel.
  Channels sum = correlation_at(0, 0);
  sum.diagonal().setOnes();
  const Channels own = sum;
  for (std::ptrdiff_t dv = 0; dv <= reach; ++dv) {
    for (std::ptrdiff_t du = dv == 0 ? 1 : -reach; du <= reach; ++du) {
      const Channels between = correlation_at(step * du, step * dv);
      sum += between + between.transpose();
      if (dv == 0 || du == 0) neighbors_[static_cast<std::size_t>(du + dv - 1)][dv == 0 ? 0 : 1] = between;
    }
  }
  for (auto& distance : neighbors_) {
    for (Channels& between : distance) between = own - 0.5 * (between + between.transpose());
  }
  if (is_bayer()) sum = Channels(sum.diagonal().asDiagonal());
  density_ = sum.llt().info() == Eigen::Success ? sum : Channels::Identity();
}

StaticPictures::FisherInformation StaticPictures::information_at(Vector2 center_px, double radius_px,
                                                                 std::size_t distance) const {
  FisherInformation sum;
  const Channels precision = density_.inverse();
  const std::size_t h = distance * step_;
  const double per_px = 1.0 / static_cast<double>(h), n = static_cast<double>(count());
  for (std::size_t v = h; v + h < height_; ++v) {
    const double dv = static_cast<double>(v) - center_px.y;
    if (std::abs(dv) > radius_px) continue;
    for (std::size_t u = h; u + h < width_; ++u) {
      const double du = static_cast<double>(u) - center_px.x;
      if (du * du + dv * dv > radius_px * radius_px) continue;
      // Gradients in standard deviations per pixel; 0 for values that were not measured.
      Eigen::Vector3d right = Eigen::Vector3d::Zero(), left = right, below = right, above = right, counts = right;
      for (std::size_t c = 0; c < 3; ++c) {
        if (!is_measured(u, v, c)) continue;
        const auto i = static_cast<Eigen::Index>(c);
        const double here = mean(u, v, c), scale = per_px / deviation(u, v, c);
        right[i] = scale * (mean(u + h, v, c) - here);
        left[i] = scale * (here - mean(u - h, v, c));
        below[i] = scale * (mean(u, v + h, c) - here);
        above[i] = scale * (here - mean(u, v - h, c));
        counts[i] = 1.0;
      }
      // The mean of the two squared one-sided differences preserves the height of a steep edge. The expectation of each
      // square includes the noise of the difference of two means.
      const auto noise = [&](std::size_t axis) {
        const Channels of_difference = 2.0 / n * per_px * per_px * neighbors_[distance - 1][axis];
        return (precision * counts.asDiagonal() * of_difference * counts.asDiagonal()).trace();
      };
      sum.uu += 0.5 * (right.dot(precision * right) + left.dot(precision * left)) - noise(0);
      sum.vv += 0.5 * (below.dot(precision * below) + above.dot(precision * above)) - noise(1);
      sum.uv += 0.25 * (right + left).dot(precision * (below + above));
    }
  }
  return sum;
}

StaticPictures::FisherInformation StaticPictures::fisher_information(Vector2 center_px, double radius_px) const {
  const FisherInformation near = information_at(center_px, radius_px, 1);
  const FisherInformation far = information_at(center_px, radius_px, 2);
  const auto gain = [](double at_h, double at_2h) {
    if (!(at_2h > 0.0 && at_h > at_2h)) return 1.0;
    const double square = 1.0 - (at_h * at_h / (at_2h * at_2h) - 1.0) / 3.0;
    return 1.0 / std::sqrt(std::max(square, 0.1));
  };
  const double u = gain(near.uu, far.uu), v = gain(near.vv, far.vv);
  return {u * near.uu, std::sqrt(u * v) * near.uv, v * near.vv};
}

}  // namespace touchline::evaluate
