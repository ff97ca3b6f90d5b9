#include "tools/programs/calibrate/colors/patch_search.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

#include "tools/programs/calibrate/colors/region_growing.h"
#include "tools/programs/calibrate/imaging/local_background.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

// Least color difference to the background. Pixel noise and shading of the floor stay below; even a dark patch on a
// dark floor exceeds it.
constexpr double kDiffersFromFloor = 16.0;
// More elongated regions are lines: the longest patches (2 : 1) reach 2.2 with blur.
constexpr double kMaxElongation = 3.0;
// Least distance between seeds: colors are mixed next to a patch, and neighboring seeds give the same region. In large
// pictures the distance is a fraction of the diameter of the smallest object, so that the effort per pixel of the
// picture is bounded. Small objects keep a seed every third pixel.
constexpr int kRim_px = 1;
constexpr double kRimOfDiameter = 0.0625;
// A region with a clearer edge is final, because no better region grows inside it.
constexpr double kClear = 0.25;
// A region that is smaller than a patch is replaced by a larger one around it, if this has a clear edge, at most this
// elongation, and at most this difference of color.
constexpr double kRound = 1.3, kSameShade = 14.0;

// Returns the largest difference to the eight neighbors, which is small inside a patch.
int unevenness(const ChannelImage& image, int u, int v) {
  int largest = 0;
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) {
      if (!image.contains(u + du, v + dv)) return 255;
      for (std::size_t c = 0; c < 3; ++c) {
        largest = std::max(largest, std::abs(image.at(u, v)[c] - image.at(u + du, v + dv)[c]));
      }
    }
  }
  return largest;
}

// Returns whether a color is a robot's body or a shadow: darker than the floor in every channel and not more saturated.
bool is_shadow(const Rgb& rgb, const Channels& floor) {
  bool darker = true;
  for (std::size_t c = 0; c < 3; ++c) darker &= rgb[c] < floor[c] + kDiffersFromFloor / 2;
  const auto [least, most] = std::minmax_element(rgb.begin(), rgb.end());
  const auto [floor_least, floor_most] = std::minmax_element(floor.begin(), floor.end());
  return darker && *most - *least < *floor_most - *floor_least + kDiffersFromFloor;
}

// Keeps the region with the clearest edge among regions that overlap, and keeps of `others` the regions that overlap
// none of these.
std::vector<FoundPatch> clearest(std::vector<FoundPatch> patches, std::vector<FoundPatch> others, std::size_t pixels) {
  const auto is_clearer = [](const FoundPatch& a, const FoundPatch& b) { return a.instability < b.instability; };
  std::sort(patches.begin(), patches.end(), is_clearer);
  std::sort(others.begin(), others.end(), is_clearer);
  std::move(others.begin(), others.end(), std::back_inserter(patches));
  std::vector<std::uint8_t> owned(pixels, 0);
  std::vector<FoundPatch> out;
  for (FoundPatch& patch : patches) {
    const auto shared = static_cast<std::size_t>(
        std::count_if(patch.pixels.begin(), patch.pixels.end(), [&](std::size_t pixel) { return owned[pixel] != 0; }));
    if (4 * shared > patch.pixels.size()) continue;
    for (const std::size_t pixel : patch.pixels) owned[pixel] = 1;
    out.push_back(std::move(patch));
  }
  return out;
}

// If there are more patches than any two teams can have, keeps those that differ most from the floor and have a rare
// color: on a textured floor every spot is a patch, and the texture repeats. The order of the patches stays the same.
void keep_rarest(std::vector<FoundPatch>& patches, const ChannelImage& image, const LocalBackground& floor) {
  if (patches.size() <= kMaxFoundPatches) return;
  // Number of patches by color; a cell and its neighbors count as one color.
  std::map<std::array<int, 3>, double> count;
  constexpr double kColorCell = 7.0;  // shades of a paint are up to 9 apart (kSame): within a cell or to the next one
  const auto cell_of = [](const Lab& lab) {
    return std::array{static_cast<int>(std::floor(lab.l / 2 / kColorCell)),
                      static_cast<int>(std::floor(lab.a / kColorCell)),
                      static_cast<int>(std::floor(lab.b / kColorCell))};
  };
  for (const FoundPatch& patch : patches) count[cell_of(patch.lab)] += 1;
  std::vector<std::pair<double, std::size_t>> rank;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const FoundPatch& patch = patches[p];
    const std::array<int, 3> cell = cell_of(patch.lab);
    double alike = 0;
    for (int i = 0; i < 27; ++i) {
      const auto near = count.find({cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1});
      if (near != count.end()) alike += near->second;
    }
    const int u = static_cast<int>(std::lround(patch.center.u_px)),
              v = static_cast<int>(std::lround(patch.center.v_px));
    const double contrast = color_distance(channels_of(patch.rgb, image.space), floor.at(u, v), image.space);
    rank.emplace_back(alike / std::max(1.0, contrast), p);
  }
  std::nth_element(rank.begin(), rank.begin() + static_cast<std::ptrdiff_t>(kMaxFoundPatches), rank.end());
  rank.resize(kMaxFoundPatches);
  std::vector<std::size_t> kept;
  kept.reserve(rank.size());
  for (const auto& one : rank) kept.push_back(one.second);
  std::sort(kept.begin(), kept.end());
  std::vector<FoundPatch> out;
  out.reserve(kept.size());
  for (const std::size_t p : kept) out.push_back(std::move(patches[p]));
  patches = std::move(out);
}

double expected_area_px(PixelPoint at, const CameraModel& camera, const PatchSize& size) {
  const auto height = static_cast<float>(size.height_m);
  const auto scale = static_cast<double>(camera.scale_px_per_m(camera.to_field(at, height), height));
  return size.area_m2 * scale * scale;
}

// Returns the area below which a region is no patch of the team file.
double least_area_px(PixelPoint at, const CameraModel& camera, const std::vector<PatchSize>& sizes) {
  double least = std::numeric_limits<double>::infinity();
  for (const PatchSize& size : sizes) {
    least = std::min(least, kMinRelativeArea * expected_area_px(at, camera, size));
  }
  return least;
}

}  // namespace

PatchSize size_of(const PatchPlace& place, const MarkerLayout& layout) {
  const double extent = std::hypot(static_cast<double>(place.length_m), static_cast<double>(place.width_m));
  return {static_cast<double>(area_m2(place)), static_cast<double>(layout.height_m), extent};
}

PatchSize size_of(const BallParameters& ball) {
  const PatchPlace disk = outline_of(ball);
  return {static_cast<double>(area_m2(disk)), static_cast<double>(ball.radius_m), static_cast<double>(disk.length_m)};
}

double relative_area(const FoundPatch& patch, const CameraModel& camera, const PatchSize& size) {
  return static_cast<double>(patch.pixels.size()) / std::max(1e-9, expected_area_px(patch.center, camera, size));
}

bool differs_from_floor(const Channels& color, const Channels& floor, ColorSpace space) {
  const Channels rgb = to_rgb8(color, space);
  return color_distance(color, floor, space) >= kDiffersFromFloor &&
         !is_shadow({static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])},
                    to_rgb8(floor, space));
}

FoundPatch patch_of(const ChannelImage& image, PixelPoint from, int radius_px, GrownPatch grown) {
  FoundPatch patch;
  patch.u_px = static_cast<double>(from.u_px);
  patch.v_px = static_cast<double>(from.v_px);
  patch.radius_px = radius_px;
  patch.instability = grown.instability;
  patch.pixels = std::move(grown.pixels);
  const auto width = static_cast<std::size_t>(image.width_px);
  const auto count = static_cast<double>(patch.pixels.size());
  double u = 0, v = 0, uu = 0, vv = 0, uv = 0;
  std::array<std::vector<std::uint8_t>, 3> values;
  for (const std::size_t pixel : patch.pixels) {
    const std::size_t column = pixel % width, row = pixel / width;
    const auto x = static_cast<double>(column), y = static_cast<double>(row);
    u += x;
    v += y;
    uu += x * x;
    vv += y * y;
    uv += x * y;
    const Channels rgb = to_rgb8(image.pixels[pixel], image.space);
    for (std::size_t c = 0; c < 3; ++c) values[c].push_back(rgb[c]);
  }
  u /= count;
  v /= count;
  const double a = uu / count - u * u, b = vv / count - v * v, c = uv / count - u * v;
  const double middle = (a + b) / 2, spread = std::sqrt((a - b) * (a - b) / 4 + c * c);
  patch.elongation = std::sqrt((middle + spread) / std::max(1e-9, middle - spread));
  patch.center = {static_cast<float>(u), static_cast<float>(v)};
  for (std::size_t channel = 0; channel < 3; ++channel) patch.rgb[channel] = statistics::median(values[channel]);
  patch.lab = lab_of(patch.rgb);
  return patch;
}

int growth_radius_px(PixelPoint at, const CameraModel& camera, const std::vector<PatchSize>& sizes) {
  double height = 0, extent = 0;
  for (const PatchSize& size : sizes) {
    height = std::max(height, size.height_m);
    extent = std::max(extent, size.extent_m);
  }
  const auto plane = static_cast<float>(height);
  const double scale = static_cast<double>(camera.scale_px_per_m(camera.to_field(at, plane), plane));
  return std::clamp(static_cast<int>(std::ceil(extent * scale)) + 3, 5, 120);
}

bool has_size_of_a_patch(const FoundPatch& patch, const CameraModel& camera, const std::vector<PatchSize>& sizes) {
  return std::any_of(sizes.begin(), sizes.end(), [&](const PatchSize& size) {
    const double relative = relative_area(patch, camera, size);
    return relative >= kMinRelativeArea && relative <= kMaxRelativeArea;
  });
}

std::vector<FoundPatch> find_patches(const ChannelImage& image, const std::vector<std::uint8_t>& inside,
                                     const LocalBackground& floor, const CameraModel& camera,
                                     const FieldParameters& field, const std::vector<PatchSize>& sizes) {
  double height = 0, least = std::numeric_limits<double>::infinity(), largest = 0;
  for (const PatchSize& size : sizes) {
    height = std::max(height, size.height_m);
    least = std::min(least, size.extent_m);
    largest = std::max(largest, size.extent_m);
  }
  const double least_of_largest = sizes.empty() ? 0 : least / largest;
  // The most even seeds come first, so that growth begins in the middle of patches.
  std::vector<std::vector<std::pair<int, int>>> seeds(256);
  for (int v = 1; v + 1 < image.height_px; ++v) {
    for (int u = 1; u + 1 < image.width_px; ++u) {
      if (inside[image.index(u, v)] == 0 ||
          color_distance(image.at(u, v), floor.at(u, v), image.space) < kDiffersFromFloor) {
        continue;
      }
      seeds[static_cast<std::size_t>(unevenness(image, u, v))].emplace_back(u, v);
    }
  }
  std::vector<std::uint8_t> tried(image.pixels.size(), 0);
  const auto done = [&](int u, int v, int rim_px) {
    for (int dv = -rim_px; dv <= rim_px; ++dv) {
      for (int du = -rim_px; du <= rim_px; ++du) {
        if (image.contains(u + du, v + dv)) tried[image.index(u + du, v + dv)] = 1;
      }
    }
  };
  std::vector<FoundPatch> grown_patches, shaded_patches;
  for (const auto& even : seeds) {
    for (const auto& [u, v] : even) {
      if (tried[image.index(u, v)] != 0) continue;
      const PixelPoint at{static_cast<float>(u), static_cast<float>(v)};
      const FieldPoint place = camera.to_field(at, static_cast<float>(height));
      if (!inside_field(field, place)) {
        done(u, v, kRim_px);
        continue;
      }
      GrowthLimits limits;
      limits.radius_px = growth_radius_px(at, camera, sizes);
      done(u, v, std::max(kRim_px, static_cast<int>(least_of_largest * limits.radius_px * kRimOfDiameter)));
      Result<GrownPatch> grown = grow_region(image, inside, u, v, limits);
      if (!grown.ok()) continue;
      FoundPatch patch = patch_of(image, at, limits.radius_px, std::move(grown).value());
      // Grow again from the center, as from a person's click: a region that grew from an edge consists of the edge and
      // everything inside it.
      const PixelPoint middle{std::round(patch.center.u_px), std::round(patch.center.v_px)};
      grown = grow_region(image, inside, static_cast<double>(middle.u_px), static_cast<double>(middle.v_px), limits);
      if (grown.ok()) patch = patch_of(image, middle, limits.radius_px, std::move(grown).value());
      // The bright part of a shaded ball can be more even than the whole.
      limits.min_area_px = static_cast<std::size_t>(std::ceil(least_area_px(middle, camera, sizes)));
      const bool is_part = patch.pixels.size() < limits.min_area_px;
      if (is_part) {
        grown = grow_region(image, inside, static_cast<double>(middle.u_px), static_cast<double>(middle.v_px), limits);
        if (!grown.ok() || grown.value().instability >= kClear) continue;
        FoundPatch whole = patch_of(image, middle, limits.radius_px, std::move(grown).value());
        if (whole.elongation > kRound || difference(whole.lab, patch.lab) > kSameShade) continue;
        patch = std::move(whole);
      }
      if (!has_size_of_a_patch(patch, camera, sizes) || patch.elongation > kMaxElongation ||
          is_shadow(patch.rgb, to_rgb8(floor.at(u, v), image.space))) {
        continue;
      }
      // Another seed may find the same patch with a better edge.
      if (is_part) {
        shaded_patches.push_back(std::move(patch));
        continue;
      }
      if (patch.instability < kClear) {
        const auto width = static_cast<std::size_t>(image.width_px);
        for (const std::size_t pixel : patch.pixels)
          done(static_cast<int>(pixel % width), static_cast<int>(pixel / width), kRim_px);
      }
      grown_patches.push_back(std::move(patch));
    }
  }
  std::vector<FoundPatch> found = clearest(std::move(grown_patches), std::move(shaded_patches), image.pixels.size());
  keep_rarest(found, image, floor);
  return found;
}

}  // namespace touchline::calibrate
