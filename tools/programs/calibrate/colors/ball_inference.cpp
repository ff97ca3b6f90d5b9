#include "tools/programs/calibrate/colors/ball_inference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace touchline::calibrate {
namespace {

// Standard deviation of paints with one name, and the largest dissimilarity of a pixel to the name.
constexpr double kBallPaint = 14.0, kMaxBallDissimilarity = 50.0;
// Least part of the ball's disk that must look like the ball, and the largest elongation of this part.
constexpr double kMinPart = 0.18, kMaxBallElongation = 1.7;
// Quantile of brightness that stands for the ball's lit part, and the least brightness of the ball's pixels relative to
// it.
constexpr double kLitQuantile = 0.9, kMinLit = 0.5;
// Part of the disk that usually looks like the ball; cost if no part does; ring around the ball, in radii, and the cost
// if everything in it differs from the floor.
constexpr double kUsualPart = 0.5, kUncovered = 4.0, kRingBegin = 1.4, kRingEnd = 2.0, kSurrounded = 8.0;
// Search radius around a candidate, in radii of the ball; the candidate may be only the rim of one side.
constexpr double kSearchRadius = 1.5;
// Limits of a candidate's area relative to the ball: from a part of the ball to the ball together with a line.
constexpr double kMinRelativeBallArea = 0.2, kMaxRelativeBallArea = 2.2;
// Least cost difference to the next best candidate, in nats.
constexpr double kMinBallMargin = 3.0;

class BallInference {
 public:
  BallInference(AssignmentInput& input, const CameraModel& camera, const PatchSize& size, Assignment& assignment)
      : input_(input), camera_(camera), size_(size), assignment_(assignment), ball_(input.ball - std::size_t{1}) {
    const Rgb gain = light_gain(input_, assignment_);
    Rgb rgb = *input_.colors[ball_].look;
    for (std::size_t k = 0; k < 3; ++k) rgb[k] = std::min(255.0, rgb[k] * gain[k]);
    expected_ = lab_of(rgb);
  }

  // Removes patches of robots from the ball's candidates, except patches that a person has clicked on.
  void remove_from_robots() {
    AssignedColor& color = assignment_.colors[ball_];
    std::vector<std::size_t> kept;
    for (const std::size_t p : color.patches) {
      const bool on_robot = input_.named[p] != ball_ && is_on_robot(input_.picture[p], input_.patches[p]);
      (on_robot ? color.others : kept).push_back(p);
    }
    color.patches = std::move(kept);
  }

  // Searches among the patches.
  void search(const SearchedPicture& picture) {
    std::vector<FoundPatch> candidates;
    for (std::size_t p = 0; p < input_.patches.size(); ++p) {
      if (input_.picture[p] == picture.number && !input_.patches[p].sampled) candidates.push_back(input_.patches[p]);
    }
    choose(picture, candidates);
  }

  // Searches among all pixels, because a ball on a line has no clear edge where the line meets it, and so is no patch.
  void search_pixels(const SearchedPicture& picture) { choose(picture, regions_like_ball(picture.picture)); }

 private:
  void choose(const SearchedPicture& picture, const std::vector<FoundPatch>& candidates) {
    std::vector<std::pair<double, FoundPatch>> found;
    for (const FoundPatch& candidate : candidates) {
      if (is_on_robot(picture.number, candidate)) continue;
      const double relative = relative_area(candidate, camera_, size_);
      if (relative < kMinRelativeBallArea || relative > kMaxRelativeBallArea) continue;
      FoundPatch patch = like_ball(candidate, picture.picture);
      if (patch.pixels.empty()) continue;
      const double d = dissimilarity(patch.lab, expected_) / kBallPaint;
      const double cost = d * d / 2 + shape_cost(patch, candidate, picture);
      found.emplace_back(cost, std::move(patch));
    }
    if (found.empty()) return;
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    const PixelPoint at = found[0].second.center;
    double margin = 50;
    for (const auto& [cost, patch] : found) {
      const bool elsewhere =
          std::hypot(patch.center.u_px - at.u_px, patch.center.v_px - at.v_px) > static_cast<float>(patch.radius_px);
      if (elsewhere) margin = std::min(margin, cost - found[0].first);
    }
    if (margin < kMinBallMargin) return;
    AssignedColor& color = assignment_.colors[ball_];
    color.rgb = found[0].second.rgb;
    color.dissimilarity = dissimilarity(found[0].second.lab, expected_);
    color.margin = margin;
    color.patches.push_back(input_.patches.size());
    input_.patches.push_back(std::move(found[0].second));
    input_.picture.push_back(picture.number);
    input_.named.push_back(kNone);
  }

  // Returns the 4-connected regions of pixels that look like the ball. Each pixel is looked at once.
  [[nodiscard]] std::vector<FoundPatch> regions_like_ball(const SampledPicture& picture) const {
    const ChannelImage& image = picture.image;
    std::vector<std::uint8_t> left(image.pixels.size(), 0);
    for (int v = 0; v < image.height_px; ++v) {
      for (int u = 0; u < image.width_px; ++u) {
        const std::size_t pixel = image.index(u, v);
        left[pixel] = picture.inside[pixel] != 0 && looks_like_ball(picture, u, v) ? 1 : 0;
      }
    }
    std::vector<FoundPatch> out;
    const auto width = static_cast<std::size_t>(image.width_px);
    for (std::size_t seed = 0; seed < left.size(); ++seed) {
      if (left[seed] == 0) continue;
      GrownPatch region;
      region.pixels = {seed};
      left[seed] = 0;
      for (std::size_t i = 0; i < region.pixels.size(); ++i) {  // grows in this loop
        const int u = static_cast<int>(region.pixels[i] % width), v = static_cast<int>(region.pixels[i] / width);
        constexpr std::array<std::array<int, 2>, 4> kSteps = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
        for (const auto& step : kSteps) {
          if (!image.contains(u + step[0], v + step[1])) continue;
          const std::size_t next = image.index(u + step[0], v + step[1]);
          if (left[next] == 0) continue;
          left[next] = 0;
          region.pixels.push_back(next);
        }
      }
      const auto column = seed % width, row = seed / width;
      const PixelPoint at{static_cast<float>(column), static_cast<float>(row)};
      FoundPatch patch = patch_of(image, at, growth_radius_px(at, camera_, {size_}), std::move(region));
      if (relative_area(patch, camera_, size_) >= kMinRelativeBallArea) out.push_back(std::move(patch));
    }
    return out;
  }

  // Returns whether the pixel is neither floor nor more similar to the color of a patch.
  [[nodiscard]] bool looks_like_ball(const SampledPicture& picture, int u, int v) const {
    const ChannelImage& image = picture.image;
    if (!differs_from_floor(image.at(u, v), picture.floor.at(u, v), image.space)) return false;
    const Channels rgb = to_rgb8(image.at(u, v), image.space);
    const Lab lab = lab_of({static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])});
    const double own = dissimilarity(lab, expected_);
    return own < kMaxBallDissimilarity &&
           std::none_of(assignment_.colors.begin(), assignment_.colors.end(), [&](const AssignedColor& c) {
             return !c.patches.empty() && dissimilarity(lab, lab_of(c.rgb)) < own;
           });
  }

  // Returns whether the patch lies in the square of a recognized robot.
  [[nodiscard]] bool is_on_robot(std::size_t picture, const FoundPatch& patch) const {
    return std::any_of(assignment_.named.begin(), assignment_.named.end(), [&](const AssignedRobot& robot) {
      if (robot.picture != picture) return false;
      const MarkerLayout& layout = input_.teams[robot.team].layout;
      const auto on_top = [&](const FoundPatch& one) {
        const FieldPoint at = camera_.to_field(one.center, layout.height_m);
        return std::complex<double>(static_cast<double>(at.x_m), static_cast<double>(at.y_m));
      };
      std::vector<std::complex<double>> places;
      for (const std::size_t p : robot.patches) places.push_back(on_top(input_.patches[p]));
      const LayoutFit fit = fit_layout(layout, places);
      const std::complex<double> own = (on_top(patch) - fit.center) / fit.turn;
      const double half = static_cast<double>(layout.robot_side_m) / 2;
      return std::abs(own.real()) < half && std::abs(own.imag()) < half;
    });
  }

  // Returns the pixels of the ball's disk that look like the ball; empty if they are too few.
  [[nodiscard]] FoundPatch like_ball(const FoundPatch& candidate, const SampledPicture& picture) const {
    const ChannelImage& image = picture.image;
    const double area = static_cast<double>(candidate.pixels.size()) / relative_area(candidate, camera_, size_);
    const int reach = std::max(1, static_cast<int>(std::lround(kSearchRadius * std::sqrt(area / std::numbers::pi))));
    const int u0 = static_cast<int>(std::lround(candidate.center.u_px)),
              v0 = static_cast<int>(std::lround(candidate.center.v_px));
    GrownPatch ball;
    std::vector<int> brightness;  // for each pixel
    for (int v = v0 - reach; v <= v0 + reach; ++v) {
      for (int u = u0 - reach; u <= u0 + reach; ++u) {
        if (!image.contains(u, v) || (u - u0) * (u - u0) + (v - v0) * (v - v0) > reach * reach ||
            !looks_like_ball(picture, u, v))
          continue;
        const Channels rgb = to_rgb8(image.at(u, v), image.space);
        ball.pixels.push_back(image.index(u, v));
        brightness.push_back(*std::max_element(rgb.begin(), rgb.end()));
      }
    }
    keep_lit(ball.pixels, brightness);
    keep_disk(ball.pixels, image, std::sqrt(area / std::numbers::pi));
    if (static_cast<double>(ball.pixels.size()) < kMinPart * area) return {};
    FoundPatch out = patch_of(image, candidate.center, candidate.radius_px, std::move(ball));
    out.sampled = true;
    return out.elongation < kMaxBallElongation ? out : FoundPatch{};
  }

  // If a part of the ball is lit, keeps only the lit pixels: the rim is removed, and so is the ball's glow on the floor
  // in its shadow, which has the ball's hue.
  static void keep_lit(std::vector<std::size_t>& pixels, const std::vector<int>& brightness) {
    if (pixels.empty()) return;
    std::vector<int> sorted = brightness;
    const auto lit =
        sorted.begin() + static_cast<std::ptrdiff_t>(kLitQuantile * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), lit, sorted.end());
    const double least = kMinLit * *lit;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if (brightness[i] >= least) pixels[kept++] = pixels[i];
    }
    pixels.resize(kept);
  }

  // Removes pixels outside a disk of this radius around the mean of the pixels, such as the edge of a line beside the
  // ball.
  static void keep_disk(std::vector<std::size_t>& pixels, const ChannelImage& image, double radius) {
    if (pixels.empty()) return;
    const auto width = static_cast<std::size_t>(image.width_px);
    const auto at = [width](std::size_t pixel) {
      const std::size_t row = pixel / width, column = pixel % width;
      return std::complex<double>(static_cast<double>(column), static_cast<double>(row));
    };
    std::complex<double> mean = 0;
    for (const std::size_t pixel : pixels) mean += at(pixel) / static_cast<double>(pixels.size());
    const auto outside = [&](std::size_t pixel) { return std::abs(at(pixel) - mean) > radius; };
    pixels.erase(std::remove_if(pixels.begin(), pixels.end(), outside), pixels.end());
  }

  // Returns how unlike a ball the shape is: a ball fills its disk and is surrounded by floor; a patch of a robot is
  // surrounded by other patches.
  [[nodiscard]] double shape_cost(const FoundPatch& patch, const FoundPatch& candidate,
                                  const SearchedPicture& picture) const {
    const ChannelImage& image = picture.picture.image;
    const double area = static_cast<double>(candidate.pixels.size()) / relative_area(candidate, camera_, size_);
    const double covered = std::min(1.0, static_cast<double>(patch.pixels.size()) / (kUsualPart * area));
    const double radius = std::sqrt(area / std::numbers::pi);
    const int reach = static_cast<int>(std::ceil(kRingEnd * radius));
    const int u0 = static_cast<int>(std::lround(patch.center.u_px)),
              v0 = static_cast<int>(std::lround(patch.center.v_px));
    double all = 0, other = 0;
    for (int v = v0 - reach; v <= v0 + reach; ++v) {
      for (int u = u0 - reach; u <= u0 + reach; ++u) {
        const double distance = std::hypot(u - u0, v - v0) / radius;
        if (!image.contains(u, v) || distance < kRingBegin || distance > kRingEnd) continue;
        all += 1;
        other += differs_from_floor(image.at(u, v), picture.picture.floor.at(u, v), image.space) ? 1 : 0;
      }
    }
    return kUncovered * (1 - covered) + kSurrounded * other / std::max(1.0, all);
  }

  AssignmentInput& input_;
  const CameraModel& camera_;
  const PatchSize& size_;
  Assignment& assignment_;
  std::size_t ball_;
  Lab expected_;
};

}  // namespace

void infer_ball(AssignmentInput& input, const CameraModel& camera, const PatchSize& size,
                const std::vector<SearchedPicture>& pictures, Assignment& assignment) {
  if (input.ball == kBackground || assignment.named.empty()) return;
  const std::size_t color = input.ball - std::size_t{1};
  if (!input.colors[color].look) return;
  BallInference inference(input, camera, size, assignment);
  inference.remove_from_robots();
  if (!assignment.colors[color].patches.empty()) return;
  for (const SearchedPicture& picture : pictures) inference.search(picture);
  if (!assignment.colors[color].patches.empty()) return;
  for (const SearchedPicture& picture : pictures) inference.search_pixels(picture);
}

}  // namespace touchline::calibrate
