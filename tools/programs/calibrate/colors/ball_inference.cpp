#include "tools/programs/calibrate/colors/ball_inference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchline::calibrate {
namespace {

// Standard deviation of paints of one name, and the greatest dissimilarity of a pixel to the name.
constexpr double kBallPaint = 14.0, kMostUnlikeBall = 50.0;
// Least part of the ball's disk that must look like it, and greatest elongation of that part.
constexpr double kLeastPart = 0.18, kMostElongated = 1.7;
// Radius of the search around a candidate, which may be only the rim of one side, in radii of the ball.
constexpr double kSearchRadius = 1.5;
// Relative areas of the candidates: part of the ball, or the ball with a line.
constexpr double kLeastRelative = 0.2, kMostRelative = 2.2;
// Least difference to the next best candidate in nats.
constexpr double kLeastBallMargin = 3.0;

class BallInference {
 public:
  BallInference(AssignmentInput& input, const CameraModel& camera, const PatchSize& size, Assignment& assignment)
      : input_(input), camera_(camera), size_(size), assignment_(assignment), ball_(input.ball - std::size_t{1}) {
    const Rgb gain = light_gain(input_, assignment_);
    Rgb rgb = *input_.colors[ball_].look;
    for (std::size_t k = 0; k < 3; ++k) rgb[k] = std::min(255.0, rgb[k] * gain[k]);
    expected_ = lab_of(rgb);
  }

  void search(const SearchedPicture& picture) {
    std::vector<std::pair<double, FoundPatch>> found;
    const std::size_t count = input_.patches.size();
    for (std::size_t p = 0; p < count; ++p) {
      const FoundPatch& candidate = input_.patches[p];
      if (input_.picture[p] != picture.number || candidate.sampled || is_on_robot(picture.number, p)) continue;
      const double relative = relative_area(candidate, camera_, size_);
      if (relative < kLeastRelative || relative > kMostRelative) continue;
      FoundPatch patch = like_ball(candidate, picture.picture.image);
      if (patch.pixels.empty()) continue;
      const double d = dissimilarity(patch.lab, expected_) / kBallPaint;
      found.emplace_back(d * d / 2, std::move(patch));
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
    if (margin < kLeastBallMargin) return;
    AssignedColor& color = assignment_.colors[ball_];
    color.rgb = found[0].second.rgb;
    color.dissimilarity = dissimilarity(found[0].second.lab, expected_);
    color.margin = margin;
    color.patches.push_back(input_.patches.size());
    input_.patches.push_back(std::move(found[0].second));
    input_.picture.push_back(picture.number);
    input_.named.push_back(kNone);
  }

 private:
  // Closer to a team patch than the ball can be.
  [[nodiscard]] bool is_on_robot(std::size_t picture, std::size_t patch) const {
    return std::any_of(assignment_.named.begin(), assignment_.named.end(), [&](const AssignedRobot& robot) {
      if (robot.picture != picture) return false;
      const MarkerLayout& layout = input_.teams[robot.team].layout;
      const FieldPoint a = camera_.to_field(input_.patches[robot.team_patch].center, layout.height_m);
      const FieldPoint b = camera_.to_field(input_.patches[patch].center, layout.height_m);
      return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m) < 0.6F * layout.robot_side_m;
    });
  }

  // The pixels of the ball's disk that look like it; none: too few.
  [[nodiscard]] FoundPatch like_ball(const FoundPatch& candidate, const ChannelImage& image) const {
    const double area = static_cast<double>(candidate.pixels.size()) / relative_area(candidate, camera_, size_);
    const int reach = std::max(1, static_cast<int>(std::lround(kSearchRadius * std::sqrt(area / std::numbers::pi))));
    const int u0 = static_cast<int>(std::lround(candidate.center.u_px)),
              v0 = static_cast<int>(std::lround(candidate.center.v_px));
    GrownPatch ball;
    for (int v = v0 - reach; v <= v0 + reach; ++v) {
      for (int u = u0 - reach; u <= u0 + reach; ++u) {
        if (!image.contains(u, v) || (u - u0) * (u - u0) + (v - v0) * (v - v0) > reach * reach) continue;
        const Channels rgb = to_rgb8(image.at(u, v), image.space);
        const Lab lab = lab_of({static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])});
        const double own = dissimilarity(lab, expected_);
        const bool nearest = std::none_of(
            assignment_.colors.begin(), assignment_.colors.end(),
            [&](const AssignedColor& c) { return !c.patches.empty() && dissimilarity(lab, lab_of(c.rgb)) < own; });
        if (nearest && own < kMostUnlikeBall) ball.pixels.push_back(image.index(u, v));
      }
    }
    if (static_cast<double>(ball.pixels.size()) < kLeastPart * area) return {};
    FoundPatch out = patch_of(image, candidate.center, candidate.radius_px, std::move(ball));
    out.sampled = true;
    return out.elongation < kMostElongated ? out : FoundPatch{};
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
  if (!assignment.colors[color].patches.empty() || !input.colors[color].look) return;
  BallInference inference(input, camera, size, assignment);
  for (const SearchedPicture& picture : pictures) inference.search(picture);
}

}  // namespace touchline::calibrate
