#include "tools/programs/calibrate/colors/patch_selection.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/programs/calibrate/colors/patch_extent.h"

namespace touchline::calibrate {
namespace {

constexpr std::size_t kMinSeeds = 300;

struct Sample {
  std::size_t pixel = 0;
  double weight = 0;
};

// Returns the weighted number of pixels of this color, and their mean.
double support(const ChannelImage& image, const std::vector<Sample>& samples, const Channels& color, Channels& mean) {
  double sum = 0;
  std::array<double, 3> values{};
  for (const Sample& s : samples) {
    const Channels& value = image.pixels[s.pixel];
    if (color_distance(value, color, image.space) > kOneColor) continue;
    sum += s.weight;
    for (std::size_t c = 0; c < 3; ++c) values[c] += s.weight * value[c];
  }
  for (std::size_t c = 0; c < 3; ++c) mean[c] = static_cast<std::uint8_t>(std::lround(values[c] / std::max(sum, 1e-9)));
  return sum;
}

Result<GrownPatch> select_in_box(const ChannelImage& image, const std::vector<std::uint8_t>& inside,
                                 const std::array<double, 4>& box, std::size_t min_area_px) {
  const auto bounded = [](double x, int end) {
    return static_cast<int>(std::clamp(x, -1.0, static_cast<double>(end)));
  };
  const int left = std::max(0, bounded(std::ceil(box[0]), image.width_px));
  const int right = bounded(std::floor(box[2]), image.width_px - 1);
  const int top = std::max(0, bounded(std::ceil(box[1]), image.height_px));
  const int bottom = bounded(std::floor(box[3]), image.height_px - 1);
  std::vector<Sample> samples;
  for (int v = top; v <= bottom; ++v) {
    for (int u = left; u <= right; ++u) {
      if (inside[image.index(u, v)] == 0) continue;
      const double x = (2 * u - box[0] - box[2]) / (box[2] - box[0]), y = (2 * v - box[1] - box[3]) / (box[3] - box[1]);
      // Gaussian weight; sigma is a quarter of the side.
      samples.push_back({image.index(u, v), std::exp(-2 * (x * x + y * y))});
    }
  }
  if (samples.size() < min_area_px) {
    return failure(ErrorCode::kNotFound, "the rectangle has %zu pixels inside the picture and the region of interest",
                   samples.size());
  }
  double best = 0;
  Channels color{};
  const std::size_t step = std::max<std::size_t>(1, samples.size() / kMinSeeds);
  for (std::size_t i = 0; i < samples.size(); i += step) {
    Channels mean{};
    const double found = support(image, samples, image.pixels[samples[i].pixel], mean);
    if (found > best) {
      best = found;
      color = mean;
    }
  }
  // Mean shift (Comaniciu and Meer 2002); with a flat kernel it converges in a few steps.
  for (int i = 0; i < 5; ++i) {
    Channels mean{};
    support(image, samples, color, mean);
    color = mean;
  }
  GrownPatch patch;
  for (const Sample& s : samples) {
    if (color_distance(image.pixels[s.pixel], color, image.space) <= kOneColor) patch.pixels.push_back(s.pixel);
  }
  patch.tolerance = kOneColor;
  if (patch.pixels.size() < min_area_px) {
    return failure(ErrorCode::kNotFound, "fewer than %zu pixels of one color in the rectangle", min_area_px);
  }
  return patch;
}

}  // namespace

Result<GrownPatch> select_patch(const ChannelImage& image, const std::vector<std::uint8_t>& inside, const Click& click,
                                GrowthLimits limits) {
  if (!click.pixels.empty()) return GrownPatch{click.pixels, 0, 0};
  if (click.box) return select_in_box(image, inside, *click.box, limits.min_area_px);
  if (click.radius_px > 0) limits.radius_px = click.radius_px;
  return grow_region(image, inside, click.u_px, click.v_px, limits);
}

}  // namespace touchline::calibrate
