#include "core/marker/border_color.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/marker/surface_color.h"

namespace touchline {
namespace {

// Number of pairs of opposite rays. Where channels are sampled at different positions (Bayer mosaic, shared chroma),
// the errors at opposite borders cancel.
constexpr std::size_t kPairs = 8;
constexpr std::array<PixelPoint, kPairs> kRayDirections = {{{1.0f, 0.0f},
                                                            {0.9239f, 0.3827f},
                                                            {0.7071f, 0.7071f},
                                                            {0.3827f, 0.9239f},
                                                            {0.0f, 1.0f},
                                                            {-0.3827f, 0.9239f},
                                                            {-0.7071f, 0.7071f},
                                                            {-0.9239f, 0.3827f}}};
static_assert(kMinBorderRays == kPairs);
// Largest number of mixed pixels of a ray. The blur of an edge is narrower.
constexpr std::size_t kMaxMixed = 12;
// Tolerance below the value of saturation, because noise darkens pixels of a patch that is barely saturated.
constexpr float kPlateau_levels = 12.0f;
// A border ends where the sum of channels falls by less than this from one pixel to the next.
constexpr float kEndOfFall_levels = 6.0f;
// Largest brightness of the surroundings, relative to a saturated pixel. The top of a robot is black; neighbors may be
// brighter.
constexpr float kDarkSurroundings = 0.5f;
// Iterations of the fit; its color changes by less than a percent after them.
constexpr int kIterations = 6;

using Rgb = std::array<float, 3>;

float sum_of(const Rgb& rgb) { return rgb[0] + rgb[1] + rgb[2]; }

// A pixel that is a mixture of the patch and its surroundings.
struct MixedPixel {
  Rgb excess{};  // linear light
  std::array<bool, 3> saturated{};
  std::size_t pair = 0;  // number of the ray's pair
};
using MixedPixels = FixedVector<MixedPixel, 2 * kPairs * kMaxMixed>;

struct BorderRay {
  PixelPoint center, direction;
  float inner_px = 0, reach_px = 0;
  std::size_t pair = 0;
};

// Adds the mixed pixels of a ray, and the linear light of the surroundings. Returns false if no border with dark
// surroundings is found.
bool follow_ray(const Frame& frame, const BorderRay& ray, const SurfaceColor& surface, MixedPixels& out,
                Rgb& background) {
  const ColorSpace space = color_space(frame.format);
  const auto saturated_from = static_cast<float>(surface.saturated_from);
  FixedVector<Rgb, kMaxMixed> mixed;
  const int steps = static_cast<int>(ray.reach_px);
  for (int step = 1; step <= steps; ++step) {
    const auto at = static_cast<float>(step);
    const long u = std::lround(ray.center.u_px + at * ray.direction.u_px);
    const long v = std::lround(ray.center.v_px + at * ray.direction.v_px);
    if (u < 0 || v < 0 || u >= frame.width_px || v >= frame.height_px) return false;
    const auto pixel = pixel_at(frame, static_cast<std::size_t>(u), static_cast<std::size_t>(v));
    const Rgb rgb =
        to_rgb({static_cast<float>(pixel[0]), static_cast<float>(pixel[1]), static_cast<float>(pixel[2])}, space);
    bool whole = true;
    for (std::size_t c = 0; c < 3; ++c) {
      whole = whole && (!surface.saturated[c] || rgb[c] >= saturated_from - kPlateau_levels);
    }
    if (whole) {
      mixed.clear();
      continue;
    }
    if (at < ray.inner_px) return false;
    if (!mixed.empty() && sum_of(rgb) > sum_of(mixed.back()) - kEndOfFall_levels) break;
    if (!mixed.push_back(rgb)) return false;
  }
  if (mixed.size() < 2 || sum_of(mixed.back()) > kDarkSurroundings * 3.0f * saturated_from) return false;
  const Rgb behind = mixed.back();
  for (std::size_t c = 0; c < 3; ++c) background[c] += behind[c] * behind[c];
  mixed.pop_back();
  for (const Rgb& rgb : mixed) {
    MixedPixel one;
    one.pair = ray.pair;
    for (std::size_t c = 0; c < 3; ++c) {
      one.excess[c] = std::max(0.0f, rgb[c] * rgb[c] - behind[c] * behind[c]);
      one.saturated[c] = rgb[c] >= saturated_from;
    }
    out.push_back(one);
  }
  return true;
}

// Fits the patch's color by expectation maximization: a pixel's share of the patch follows from its channels that are
// not saturated. The other channels have at least the value at which they saturate, and more if color and share imply
// it. `of_pair`: sums over the pixels of a pair of rays.
Rgb fit_color(const MixedPixels& pixels, std::array<Rgb, kPairs>& of_pair) {
  Rgb color{1.0f, 1.0f, 1.0f};
  for (int i = 0; i < kIterations; ++i) {
    for (Rgb& sum : of_pair) sum = {};
    Rgb seen{}, expected{};
    for (const MixedPixel& pixel : pixels) {
      float unsaturated = 0, whole = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        if (pixel.saturated[c]) continue;
        unsaturated += pixel.excess[c];
        whole += color[c];
      }
      if (whole <= 0.0f) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        const float predicted = color[c] * unsaturated / whole;
        const float value = pixel.saturated[c] ? std::max(pixel.excess[c], predicted) : pixel.excess[c];
        of_pair[pixel.pair][c] += value;
        seen[c] += value;
        expected[c] += predicted;
      }
    }
    for (std::size_t c = 0; c < 3; ++c) color[c] *= seen[c] / std::max(expected[c], 1.0f);
    const float mean = sum_of(color) / 3.0f;
    if (mean <= 0.0f) return {};
    for (float& channel : color) channel /= mean;
  }
  return color;
}

}  // namespace

bool sample_border(const Frame& frame, PixelPoint center, const SurfaceColor& surface, float inner_px, float reach_px,
                   BorderColor& out, std::size_t least_rays) {
  MixedPixels pixels;
  Rgb background{};
  std::size_t rays = 0;
  for (std::size_t k = 0; k < 2 * kPairs; ++k) {
    const PixelPoint& half = kRayDirections[k % kPairs];
    const float sign = k < kPairs ? 1.0f : -1.0f;
    const BorderRay ray{center, {sign * half.u_px, sign * half.v_px}, inner_px, reach_px, k % kPairs};
    if (follow_ray(frame, ray, surface, pixels, background)) ++rays;
  }
  out.rays = rays;
  if (rays < least_rays) return false;
  std::array<Rgb, kPairs> of_pair{};
  out.excess = fit_color(pixels, of_pair);
  if (std::min({out.excess[0], out.excess[1], out.excess[2]}) <= 0.0f) return false;
  Rgb sum{}, squares{};
  for (const Rgb& pair : of_pair) {
    for (std::size_t c = 0; c < 3; ++c) sum[c] += pair[c];
  }
  for (const Rgb& pair : of_pair) {
    // A pair's share of the sums is the same in all channels if the pairs agree on the color.
    const Rgb share{pair[0] / sum[0], pair[1] / sum[1], pair[2] / sum[2]};
    const float common = sum_of(share) / 3.0f;
    for (std::size_t c = 0; c < 3; ++c) squares[c] += (share[c] - common) * (share[c] - common);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    out.error[c] = std::sqrt(squares[c]);
    out.background[c] = background[c] / static_cast<float>(rays);
  }
  return true;
}

}  // namespace touchline
