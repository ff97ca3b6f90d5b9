#include "tools/programs/relight/same_color.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/programs/calibrate/colors/color_clusters.h"
#include "tools/programs/calibrate/colors/initial_boxes.h"
#include "tools/programs/calibrate/colors/region_growing.h"

namespace touchline::relight {
namespace {

using calibrate::ChannelImage;
using calibrate::FoundPatch;

// In a corrected picture, patches of one paint differ by less than this, and patches of two paints by more.
constexpr double kOneColor = 15.0;
// Share of a patch's pixels that is cut off at each end of each channel, because they may be edge pixels.
constexpr double kEdgeShare = 0.05;

double distance_px(const FoundPatch& patch, double u, double v) {
  return std::hypot(static_cast<double>(patch.center.u_px) - u, static_cast<double>(patch.center.v_px) - v);
}

// Returns the index of the patch nearest to this position among the patches that `wanted` accepts.
template <class Wanted>
std::size_t nearest(const std::vector<FoundPatch>& patches, double u, double v, Wanted&& wanted) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (!wanted(i) || distance_px(patches[i], u, v) >= least) continue;
    least = distance_px(patches[i], u, v);
    best = i;
  }
  return best;
}

}  // namespace

Result<SameColor> find_same_color(const ChannelImage& corrected, const calibrate::VenueDraft& venue,
                                  const std::array<double, 2>* at_px) {
  CameraModel camera;
  if (Status s = camera.configure(venue.file.camera_model); !s.ok()) {
    return failure(s.code(), "the venue has no camera model; run touchline-calibrate field");
  }
  const MarkerLayout layout = paper_layout();
  const auto inside = calibrate::inside_mask(venue.region_of_interest, corrected.width_px, corrected.height_px);
  std::vector<FoundPatch> found = find_patches(corrected, inside, calibrate::LocalBackground(corrected, inside), camera,
                                               venue.file.field, {calibrate::size_of(layout.patches[0], layout)});
  if (found.empty()) {
    return Error{ErrorCode::kNotFound, "no patch was found"};
  }
  std::size_t representative = 0;
  if (at_px != nullptr) {
    const auto [u, v] = *at_px;
    representative = nearest(found, u, v, [](std::size_t) { return true; });
    if (distance_px(found[representative], u, v) > found[representative].radius_px) {
      return failure(ErrorCode::kNotFound, "no patch at %.0f,%.0f", u, v);
    }
  } else {
    std::vector<calibrate::Lab> colors;
    colors.reserve(found.size());
    for (const FoundPatch& patch : found) colors.push_back(patch.lab);
    std::size_t count = 0;
    const auto label = calibrate::ColorClusters(colors).cut(kOneColor, count);
    // Counts only patches with a saturated color, because lines are white and may look like patches.
    constexpr double kMinChroma = 20.0;
    std::vector<double> members(count, 0.0);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (std::hypot(found[i].lab.a, found[i].lab.b) > kMinChroma) members[label[i]] += 1;
    }
    const auto most = static_cast<std::size_t>(std::max_element(members.begin(), members.end()) - members.begin());
    representative = nearest(found, corrected.width_px / 2.0, corrected.height_px / 2.0,
                             [&](std::size_t i) { return label[i] == most; });
  }
  SameColor out;
  const calibrate::Lab color = found[representative].lab;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i != representative && difference(found[i].lab, color) > kOneColor) continue;
    if (i == representative) out.representative = out.patches.size();
    out.patches.push_back(std::move(found[i]));
  }
  return out;
}

ColorBox thresholds_of(const ChannelImage& image, const FoundPatch& patch, int margin) {
  std::vector<calibrate::Channels> pixels;
  for (const std::size_t pixel : patch.pixels) pixels.push_back(image.pixels[pixel]);
  ColorBox box = calibrate::core_of(calibrate::count_colors(pixels), 1, kEdgeShare);
  for (std::size_t side = 0; side < calibrate::kSides; ++side) {
    calibrate::set_side(box, side, calibrate::side_value(box, side) + (side % 2 == 0 ? -margin : margin));
  }
  return box;
}

std::vector<std::uint8_t> classify(const ChannelImage& image, const ColorBox& thresholds) {
  std::vector<std::uint8_t> out;
  out.reserve(image.pixels.size());
  for (const calibrate::Channels& value : image.pixels) out.push_back(calibrate::contains(thresholds, value) ? 1 : 0);
  return out;
}

std::size_t recognized(const SameColor& color, const std::vector<std::uint8_t>& classified) {
  return static_cast<std::size_t>(
      std::count_if(color.patches.begin(), color.patches.end(), [&](const FoundPatch& patch) {
        const auto hits = std::count_if(patch.pixels.begin(), patch.pixels.end(),
                                        [&](std::size_t pixel) { return classified[pixel] != 0; });
        return 2 * static_cast<std::size_t>(hits) >= patch.pixels.size();
      }));
}

}  // namespace touchline::relight
