#include "tools/programs/calibrate/colors/patch_extent.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/programs/calibrate/colors/patch_search.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

// Limit of a patch's radius relative to its sampled inner part, which is 0.6 of its length (layout_sampling.cpp). A
// patch of three times that radius is 1.8 times as long as its layout says, which no mistake in cutting explains.
constexpr double kReach = 3.0;
// Smallest deviation that is reported; patches cut by hand differ by up to an eighth.
constexpr double kNotable = 0.15;
constexpr std::size_t kMinPatches = 3;
// Share of the pixels along a region's border that the patch covers on average. They are mixed with the surroundings,
// so growth stops before them. In pictures of the arena with patches of 6 to 10 pixels, the share is between 0.28 and
// 0.38.
constexpr double kCoveredBeside = 1.0 / 3;

// Returns the area of the patch in pixels, including its share of the pixels along its border.
double whole_area(const ChannelImage& image, std::vector<std::size_t> region) {
  std::sort(region.begin(), region.end());
  const auto width = static_cast<std::size_t>(image.width_px);
  std::vector<std::size_t> beside;
  for (const std::size_t pixel : region) {
    const int u = static_cast<int>(pixel % width), v = static_cast<int>(pixel / width);
    constexpr std::array<std::array<int, 2>, 4> kSteps = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    for (const auto& step : kSteps) {
      if (!image.contains(u + step[0], v + step[1])) continue;
      const std::size_t next = image.index(u + step[0], v + step[1]);
      if (!std::binary_search(region.begin(), region.end(), next)) beside.push_back(next);
    }
  }
  std::sort(beside.begin(), beside.end());
  const auto end = std::unique(beside.begin(), beside.end());
  return static_cast<double>(region.size()) + kCoveredBeside * static_cast<double>(end - beside.begin());
}

}  // namespace

std::vector<std::size_t> continue_patch(const ChannelImage& image, const std::vector<std::uint8_t>& inside,
                                        const std::vector<std::size_t>& pixels) {
  if (pixels.empty()) return {};
  const auto width = static_cast<std::size_t>(image.width_px);
  const auto column = [width](std::size_t pixel) { return static_cast<double>(pixel % width); };
  const auto row = [width](std::size_t pixel) {
    const std::size_t v = pixel / width;
    return static_cast<double>(v);
  };
  double u = 0, v = 0, radius = 0;
  std::array<std::vector<std::uint8_t>, 3> values;
  for (const std::size_t pixel : pixels) {
    u += column(pixel) / static_cast<double>(pixels.size());
    v += row(pixel) / static_cast<double>(pixels.size());
    for (std::size_t c = 0; c < 3; ++c) values[c].push_back(image.pixels[pixel][c]);
  }
  Channels color{};
  for (std::size_t c = 0; c < 3; ++c) color[c] = statistics::median(values[c]);
  for (const std::size_t pixel : pixels) radius = std::max(radius, std::hypot(column(pixel) - u, row(pixel) - v));
  const double reach = kReach * (radius + 1);
  std::vector<std::size_t> out = pixels;
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  // Works in a window of the picture, so that the effort depends only on the patch.
  const int left = static_cast<int>(std::floor(u - reach)) - 1, top = static_cast<int>(std::floor(v - reach)) - 1;
  const auto side = static_cast<std::size_t>(std::ceil(2 * reach)) + 4;
  std::vector<bool> seen(side * side, false);
  const auto cell = [&](int x, int y) {
    return static_cast<std::size_t>(y - top) * side + static_cast<std::size_t>(x - left);
  };
  for (const std::size_t pixel : out)
    seen[cell(static_cast<int>(pixel % width), static_cast<int>(pixel / width))] = true;
  for (std::size_t i = 0; i < out.size(); ++i) {  // grows in this loop
    const int x = static_cast<int>(out[i] % width), y = static_cast<int>(out[i] / width);
    constexpr std::array<std::array<int, 2>, 4> kSteps = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    for (const auto& step : kSteps) {
      const int nx = x + step[0], ny = y + step[1];
      if (!image.contains(nx, ny) || inside[image.index(nx, ny)] == 0 || seen[cell(nx, ny)]) continue;
      if (color_distance(image.at(nx, ny), color, image.space) > kOneColor) continue;
      if (std::hypot(nx - u, ny - v) > reach) return {};
      seen[cell(nx, ny)] = true;
      out.push_back(image.index(nx, ny));
    }
  }
  return out;
}

std::array<PatchScale, 2> patch_scales(const AssignmentInput& input, const Assignment& assignment,
                                       const std::vector<PatchPicture>& pictures, const CameraModel& camera) {
  std::array<PatchScale, 2> out;
  std::array<std::vector<double>, 2> ratios;
  for (const AssignedRobot& robot : assignment.named) {
    const MarkerLayout& layout = input.teams[robot.team].layout;
    for (std::size_t k = 0; k < robot.patches.size(); ++k) {
      const FoundPatch& patch = input.patches[robot.patches[k]];
      const PatchPicture& picture = pictures[robot.picture];
      const std::vector<std::size_t> whole =
          patch.sampled ? continue_patch(picture.image, picture.inside, patch.pixels) : patch.pixels;
      if (whole.empty()) continue;
      const double relative = relative_area(patch, camera, size_of(layout.patches[k], layout)) *
                              whole_area(picture.image, whole) / static_cast<double>(patch.pixels.size());
      ratios[robot.team].push_back(std::sqrt(relative));
    }
  }
  for (std::size_t team = 0; team < out.size(); ++team) {
    if (!ratios[team].empty()) out[team] = {statistics::median(ratios[team]), ratios[team].size()};
  }
  return out;
}

std::string describe_scales(const std::array<PatchScale, 2>& scales) {
  std::string text;
  for (std::size_t team = 0; team < scales.size(); ++team) {
    const PatchScale& scale = scales[team];
    if (scale.patches < kMinPatches || std::abs(scale.ratio - 1) < kNotable) continue;
    text += formatted(
        "%s%s: patches are %.0f %% %s than the layout says (median of %zu): measure them and correct length_m and "
        "width_m of [[layout.patch]] in the team file",
        text.empty() ? "" : "\n", team == 0 ? "own" : "opponent", 100 * std::abs(scale.ratio - 1),
        scale.ratio > 1 ? "longer" : "shorter", scale.patches);
  }
  return text;
}

}  // namespace touchline::calibrate
