#pragma once

#include <array>

#include "core/subpixel/bayer_sampling.h"
#include "core/subpixel/blurred_outline.h"
#include "core/subpixel/fit_kernel.h"

namespace touchline {

/// Light of a patch, and what the colors of its edge pixels say about its place.
struct PatchLight {
  std::array<float, 3> excess{};   // light of the patch minus light of the top
  float unevenness = 0;            // standard deviation of the light of the covered pixels, relative to `excess`
  std::array<float, 3> along{};    // as in EdgeFitTask
  std::array<float, 3> weight{};   // as in EdgeFitTask
  std::array<float, 3> doubted{};  // as in EdgeFitTask
  // Variance of the patch's center along its outline's axes in m^2: from sampling, noise and surroundings; relative to
  // equally weighted pixels; and from the camera's noise alone, for each axis.
  BayerSampling::Axes sampling{};
  float repeated = 1;
  float camera_noise = 0;
};

/// Measures the light of patch `number` of a robot from the sums over its completely covered pixels. `edge_pixels`: its
/// other pixels. False if too few pixels are covered, or the patch does not differ from the top.
bool measure_patch(const MarkerView& robot, std::size_t number, const ColorSums& inside, std::size_t edge_pixels,
                   PatchLight& out);

}  // namespace touchline
