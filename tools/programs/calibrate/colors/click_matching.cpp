#include "tools/programs/calibrate/colors/click_matching.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/programs/calibrate/colors/patch_selection.h"
#include "tools/programs/command_line/formatted.h"

namespace touchline::calibrate {
namespace {

// Tolerance of a click, because a person's hand is not exact and the pixels of an edge belong to no patch.
constexpr double kNear_px = 2.0;

}  // namespace

std::size_t patch_under(const Click& click, const ChannelImage& image, const std::vector<FoundPatch>& patches) {
  const auto width = static_cast<std::size_t>(image.width_px);
  std::size_t best = patches.size();
  double nearest = kNear_px + 0.5, covered = 0.5;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    std::size_t in_box = 0;
    for (const std::size_t pixel : patches[p].pixels) {
      const std::size_t row = pixel / width, column = pixel % width;
      const auto u = static_cast<double>(column), v = static_cast<double>(row);
      if (click.box) {
        const std::array<double, 4>& box = *click.box;
        in_box += u >= box[0] && v >= box[1] && u <= box[2] && v <= box[3] ? 1U : 0U;
      } else if (const double distance = std::hypot(u - click.u_px, v - click.v_px); distance < nearest) {
        nearest = distance;
        best = p;
      }
    }
    const double share = static_cast<double>(in_box) / static_cast<double>(patches[p].pixels.size());
    if (click.box && share > covered) {
      covered = share;
      best = p;
    }
  }
  return best;
}

Result<FoundPatch> patch_from(const Click& click, const ChannelImage& image, const std::vector<std::uint8_t>& inside,
                              const CameraModel& camera, const std::vector<PatchSize>& sizes) {
  const PixelPoint at{static_cast<float>(click.u_px), static_cast<float>(click.v_px)};
  GrowthLimits limits;
  limits.radius_px = click.radius_px > 0 ? click.radius_px : growth_radius_px(at, camera, sizes);
  TOUCHLINE_TRY_ASSIGN(GrownPatch grown, select_patch(image, inside, click, limits));
  FoundPatch patch = patch_of(image, at, limits.radius_px, std::move(grown));
  if (!has_size_of_a_patch(patch, camera, sizes)) {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (const PatchSize& size : sizes) {
      const double expected = static_cast<double>(patch.pixels.size()) / relative_area(patch, camera, size);
      least = std::min(least, kMinRelativeArea * expected);
      most = std::max(most, kMaxRelativeArea * expected);
    }
    return failure(ErrorCode::kNotFound,
                   "the region of one color around it has %zu pixels; patches of the team file have %.0f to %.0f there",
                   patch.pixels.size(), least, most);
  }
  return patch;
}

std::string describe_click(std::size_t number, const Click& click) {
  return formatted("%zu (%s, %s at %.0f,%.0f)", number, click.image.c_str(), click.color.c_str(), click.u_px,
                   click.v_px);
}

}  // namespace touchline::calibrate
