#include "tools/programs/calibrate/colors/marker_completion.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <set>

#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

using Point = std::complex<double>;

// A long axis gives the heading if its variance exceeds that of the other axis by this factor.
constexpr double kLongAxis = 1.5;
// Part of an outline's length and width that is sampled: chroma bleeds over the rest.
constexpr double kInnerPart = 0.6;
constexpr std::size_t kLeastPixels = 4;
// Least share of the pixels within kSameColor levels of their median.
constexpr double kEven = 0.7, kSameColor = 30.0;
// A dark patch is not a shadow if it is at least this different and saturated.
constexpr double kLeastContrast = 8.0, kLeastSaturation = 0.25;
// Color difference to the floor at which a patch is certainly one.
constexpr double kClearlyDifferent = 100.0;

Point place_of(const PatchPlace& place) { return {static_cast<double>(place.x_m), static_cast<double>(place.y_m)}; }

// Whether a point in the patch's own frame lies in the inner part of the outline.
bool in_inner_part(const PatchPlace& place, Point at) {
  const double length = static_cast<double>(place.length_m) * kInnerPart;
  const double width = static_cast<double>(place.width_m) * kInnerPart;
  switch (place.outline) {
    case PatchOutline::kCircle:
      return std::abs(at) <= length / 2;
    case PatchOutline::kTriangle:  // the centroid is a third of the height above the base
      return at.real() >= -length / 3 && std::abs(at.imag()) <= width / 2 * (2 * length / 3 - at.real()) / length;
    case PatchOutline::kSquare:
    case PatchOutline::kBar:
      break;
  }
  return std::abs(at.real()) <= length / 2 && std::abs(at.imag()) <= width / 2;
}

class Completion {
 public:
  Completion(std::vector<FoundPatch>& patches, const std::vector<std::size_t>& numbers, const MarkerLayout& layout,
             const CameraModel& camera, const SampledPicture& picture)
      : patches_(patches), numbers_(numbers), layout_(layout), camera_(camera), picture_(picture) {}

  std::vector<MarkerCandidate> run() {
    for (const std::size_t team : numbers_) {
      if (!fits(team, 0)) continue;
      for (const double heading : headings(team)) complete(team, heading);
    }
    return std::move(found_);
  }

 private:
  [[nodiscard]] Point on_field(PixelPoint pixel) const {
    const FieldPoint at = camera_.to_field(pixel, layout_.height_m);
    return {static_cast<double>(at.x_m), static_cast<double>(at.y_m)};
  }
  [[nodiscard]] PixelPoint in_picture(Point at) const {
    return camera_.to_pixel({static_cast<float>(at.real()), static_cast<float>(at.imag())}, layout_.height_m);
  }
  [[nodiscard]] bool fits(std::size_t patch, std::size_t place) const {
    const double relative = relative_area(patches_[patch], camera_, size_of(layout_.patches[place], layout_));
    return relative >= kLeastRelativeArea && relative <= kMostRelativeArea;
  }
  [[nodiscard]] double tolerance_m(Point at) const {
    const FieldPoint point{static_cast<float>(at.real()), static_cast<float>(at.imag())};
    return kLayoutError_m + kCenterError_px / static_cast<double>(camera_.scale_px_per_m(point, layout_.height_m));
  }

  std::vector<double> headings(std::size_t team) const {
    std::vector<double> out;
    const PatchPlace& place = layout_.patches[0];
    const PrincipalVariances expected = principal_variances(place);
    const Point center = on_field(patches_[team].center);
    if (static_cast<double>(expected.major_m2) > kLongAxis * static_cast<double>(expected.minor_m2)) {
      Point sum = 0;  // twice the angle of the long axis
      const auto width = static_cast<std::size_t>(picture_.image.width_px);
      for (const std::size_t pixel : patches_[team].pixels) {
        const std::size_t row = pixel / width, column = pixel % width;
        const Point arm = on_field({static_cast<float>(column), static_cast<float>(row)}) - center;
        sum += arm * arm;
      }
      const double heading = std::arg(sum) / 2 - static_cast<double>(expected.axis_rad);
      out = {heading, heading + std::numbers::pi};
    }
    for (const std::size_t other : numbers_) {
      if (other == team) continue;
      const Point arm = on_field(patches_[other].center) - center;
      for (std::size_t k = 1; k < layout_.patches.size(); ++k) {
        const Point wanted = place_of(layout_.patches[k]) - place_of(place);
        if (fits(other, k) && std::abs(std::abs(arm) - std::abs(wanted)) <= tolerance_m(center))
          out.push_back(std::arg(arm / wanted));
      }
    }
    return out;
  }

  // Adds the marker with this team patch and heading if all of its identification patches can be found or sampled.
  void complete(std::size_t team, double heading) {
    const Point turn = std::polar(1.0, heading);
    const Point center = on_field(patches_[team].center) - turn * place_of(layout_.patches[0]);
    MarkerCandidate marker;
    marker.patches = {team};
    marker.residual_m = 1.0;
    bool complete = true;
    for (std::size_t k = 1; k < layout_.patches.size(); ++k) {
      const Point at = center + turn * place_of(layout_.patches[k]);
      std::size_t patch = nearest(at, k, team);
      if (patch == kNoPatch) {
        complete = false;
        double contrast = 0;
        patch = sampled(at, turn, k, contrast);
        if (patch == kNoPatch) return;
        marker.residual_m += std::max(0.1, 1.0 - contrast / kClearlyDifferent);
      }
      marker.patches.push_back(patch);
    }
    if (!complete && known_.insert(marker.patches).second) found_.push_back(std::move(marker));
  }

  std::size_t nearest(Point at, std::size_t place, std::size_t team) const {
    std::size_t best = kNoPatch;
    double least = tolerance_m(at);
    for (const std::size_t number : numbers_) {
      const double distance = std::abs(on_field(patches_[number].center) - at);
      if (number == team || distance > least || !fits(number, place)) continue;
      least = distance;
      best = number;
    }
    return best;
  }

  std::size_t sampled(Point at, Point turn, std::size_t place, double& contrast) {
    const PatchPlace& shape = layout_.patches[place];
    const PixelPoint middle = in_picture(at);
    const FieldPoint point{static_cast<float>(at.real()), static_cast<float>(at.imag())};
    const double scale = static_cast<double>(camera_.scale_px_per_m(point, layout_.height_m));
    const double extent = std::hypot(static_cast<double>(shape.length_m), static_cast<double>(shape.width_m));
    const int radius = std::clamp(static_cast<int>(std::ceil(extent * scale / 2)), 1, 100);
    const int u0 = static_cast<int>(std::lround(middle.u_px)), v0 = static_cast<int>(std::lround(middle.v_px));
    const Point own_turn = turn * std::polar(1.0, static_cast<double>(shape.turn_rad));
    const ChannelImage& image = picture_.image;
    if (!image.contains(u0, v0) || picture_.inside[image.index(u0, v0)] == 0) return kNoPatch;
    GrownPatch region;
    std::array<std::vector<std::uint8_t>, 3> values;
    for (int v = v0 - radius; v <= v0 + radius; ++v) {
      for (int u = u0 - radius; u <= u0 + radius; ++u) {
        if (!image.contains(u, v)) continue;
        const Point arm = on_field({static_cast<float>(u), static_cast<float>(v)}) - at;
        if (!in_inner_part(shape, arm / own_turn)) continue;
        region.pixels.push_back(image.index(u, v));
        for (std::size_t c = 0; c < 3; ++c) values[c].push_back(image.at(u, v)[c]);
      }
    }
    if (region.pixels.size() < kLeastPixels) return kNoPatch;
    Channels color{};
    for (std::size_t c = 0; c < 3; ++c) color[c] = statistics::median(values[c]);
    const auto even = std::count_if(region.pixels.begin(), region.pixels.end(), [&](std::size_t pixel) {
      return color_distance(image.pixels[pixel], color, image.space) <= kSameColor;
    });
    if (static_cast<double>(even) < kEven * static_cast<double>(region.pixels.size())) return kNoPatch;
    const Channels& floor = picture_.floor.at(u0, v0);
    contrast = color_distance(color, floor, image.space);
    const Channels shown = to_rgb8(color, image.space);
    const bool colored =
        contrast >= kLeastContrast && saturation({static_cast<double>(shown[0]), static_cast<double>(shown[1]),
                                                  static_cast<double>(shown[2])}) >= kLeastSaturation;
    if (!colored && !differs_from_floor(color, floor, image.space)) return kNoPatch;
    const auto [entry, is_new] = sampled_.try_emplace({u0, v0, static_cast<int>(place)}, patches_.size());
    if (is_new) {
      patches_.push_back(patch_of(image, middle, radius, std::move(region)));
      patches_.back().sampled = true;
    }
    return entry->second;
  }

  static constexpr std::size_t kNoPatch = static_cast<std::size_t>(-1);

  std::vector<FoundPatch>& patches_;
  const std::vector<std::size_t>& numbers_;
  const MarkerLayout& layout_;
  const CameraModel& camera_;
  const SampledPicture& picture_;
  std::map<std::array<int, 3>, std::size_t> sampled_;  // by pixel and place
  std::set<std::vector<std::size_t>> known_;
  std::vector<MarkerCandidate> found_;
};

}  // namespace

std::vector<MarkerCandidate> complete_markers(std::vector<FoundPatch>& patches, const std::vector<std::size_t>& numbers,
                                              const MarkerLayout& layout, const CameraModel& camera,
                                              const SampledPicture& picture) {
  return Completion(patches, numbers, layout, camera, picture).run();
}

}  // namespace touchline::calibrate
