#include "core/subpixel/patch_light.h"

#include <algorithm>
#include <cmath>

#include "core/subpixel/pose_equations.h"

namespace touchline {
namespace {

constexpr float kMinInsidePixels = 4;
// Least contrast between patch and top, in linear light. A smaller one is noise.
constexpr float kMinContrast = 0.01f;
// Prior of the noise: standard deviation of the light from rounding to 8 bits in dark areas, and its weight in pixels.
// A few covered pixels alone would underestimate the noise.
constexpr float kMinNoise = 0.001f, kPriorPixels = 4.0f;
// The ramp's width times the integral of its squared slope. Then the noise variance of an edge pixel relative to a
// covered one: the variance is proportional to the light, and an edge pixel has half of it.
constexpr float kSquaredSlope = 1.2f, kEdgeNoise = 0.5f;
// Behind a Bayer pattern: pixels per measured sample of red, green and blue.
constexpr std::array<float, 3> kPixelsPerMeasured{4.0f, 2.0f, 4.0f};
// Crosstalk: squared error that the other colors cause in one color, relative to their squared light. Where pixels
// share chroma (YUV, JPEG), a color with little contrast shows the edges of the others. The second value holds if a
// Bayer pattern was found, because that picture shares no chroma.
constexpr float kSharedLeak = 0.01f, kMeasuredLeak = 0.0002f;
// Variance of the surroundings' light after subtraction, relative to its square.
constexpr float kSurroundingsError = 0.1f;
constexpr float kNegligible = 1e-8f;  // squared light
// Light of the surroundings in a pixel, relative to the patch's light, at which the pixel's weight is one half. Beside
// lines, walls and the sides of robots, the error of this light is as large as the light itself. All other errors are
// 0.1 of the patch's light.
constexpr float kHalfWeightSurroundings = 0.1f;
// Standard deviation of a center along each axis if the surroundings make most edge pixels doubtful: the fit does not
// know exactly where a line beside the robot begins. Measured with robots beside the arena's goals.
constexpr float kDoubtedPx = 0.03f;

// What the colors say about the center: `variance` is that of each color's light in covered pixels.
void weigh_colors(const MarkerView& robot, const BlurredOutline& outline, const ColorSums& inside,
                  std::size_t edge_pixels, const std::array<float, 3>& variance, PatchLight& out) {
  const bool is_bayer = robot.bayer.found;
  const float c = outline.cos(), s = outline.sin();
  const float edge = static_cast<float>(edge_pixels + 1);
  // Sum of the squared slopes on two opposite edges.
  const float slopes = 2.0f * kSquaredSlope * (outline.half_length_m() + outline.half_width_m()) / robot.ramp_m;
  BayerSampling sampling;
  if (is_bayer) {
    sampling = bayer_sampling(outline, {c * robot.u_by_x + s * robot.u_by_y, c * robot.v_by_x + s * robot.v_by_y},
                              robot.scale_px_per_m);
  }
  std::array<float, 3> noise_px2, all_px2;  // of the center by color: noise alone; with crosstalk and surroundings
  std::array<float, 3> foreign;             // mean squared light of the surroundings, relative to the patch's
  for (std::size_t i = 0; i < 3; ++i) {
    const float light = out.excess[i] * out.excess[i] + kNegligible;
    const float count = inside.count[i];
    const float own = (count * variance[i] + kPriorPixels * kMinNoise * kMinNoise) / (count + kPriorPixels);
    const float repeated = is_bayer ? kPixelsPerMeasured[i] : 1.0f;
    noise_px2[i] = repeated * kEdgeNoise * own / (light * slopes);
    const float shared = (is_bayer ? kMeasuredLeak : kSharedLeak) * dot(out.excess, out.excess);
    foreign[i] = inside.foreign[i] / (edge * light);
    all_px2[i] = noise_px2[i] + (repeated * kSurroundingsError * foreign[i] + shared / light) / slopes;
  }
  const std::array<float, 3> weights = channel_weights(sampling, all_px2);
  const BayerSampling::Axes by_sampling = sampling_variance(sampling, weights);
  float by_noise = 0, by_surroundings = 0;
  out.repeated = is_bayer ? 0.0f : 1.0f;
  for (std::size_t i = 0; i < 3; ++i) {
    out.along[i] = out.excess[i] / (out.excess[i] * out.excess[i] + kNegligible);
    by_noise += weights[i] * weights[i] * noise_px2[i];
    constexpr float kHalf = kHalfWeightSurroundings * kHalfWeightSurroundings;
    by_surroundings += weights[i] * kDoubtedPx * kDoubtedPx * foreign[i] / (foreign[i] + kHalf);
    if (is_bayer) {
      out.weight[i] = weights[i] * kPixelsPerMeasured[i];
      out.repeated += weights[i] * out.weight[i];
    } else {
      out.along[i] *= weights[i];
    }
  }
  constexpr float kDoubt = 1.0f / (kHalfWeightSurroundings * kHalfWeightSurroundings);
  out.doubted = {kDoubt * dot(out.along, out.along), 0, 0};
  if (is_bayer) {
    for (std::size_t i = 0; i < 3; ++i) out.doubted[i] = kDoubt * out.along[i] * out.along[i];
  }
  const float m2_per_px2 = 1.0f / (robot.scale_px_per_m * robot.scale_px_per_m);
  out.camera_noise = m2_per_px2 * by_noise;
  const float others = by_noise + by_surroundings;
  out.sampling = {m2_per_px2 * (by_sampling.x + others), m2_per_px2 * (by_sampling.y + others)};
}

}  // namespace

bool measure_patch(const MarkerView& robot, std::size_t number, const ColorSums& inside, std::size_t edge_pixels,
                   PatchLight& out) {
  const std::array<float, 3>& count = inside.count;
  if ((robot.bayer.found ? count[0] + count[1] + count[2] : count[0]) < kMinInsidePixels) return false;
  std::array<float, 3> variance;
  for (std::size_t c = 0; c < 3; ++c) {
    const float pixels = std::max(count[c], 1.0f);  // a small patch may lack pixels of a color
    out.excess[c] = inside.light[c] / pixels;
    variance[c] = std::max(0.0f, inside.squares[c] / pixels - out.excess[c] * out.excess[c]);
  }
  const float power = dot(out.excess, out.excess);
  if (!(power > kMinContrast * kMinContrast)) return false;
  out.unevenness = std::sqrt((variance[0] + variance[1] + variance[2]) / power);
  weigh_colors(robot, (*robot.outlines)[number], inside, edge_pixels, variance, out);
  return true;
}

}  // namespace touchline
