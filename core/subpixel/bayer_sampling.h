#pragma once

#include <array>

#include "core/subpixel/blurred_outline.h"
#include "core/types.h"

namespace touchline {

/// Errors of a patch's fitted center that come from a camera's color filters, and how much each color should count.
///
/// Behind a Bayer pattern, red and blue are measured at every second pixel and column, green at every second pixel of
/// a row; what is missing is interpolated and tells nothing new. Sampling adds copies of the picture's spectrum at the
/// reciprocal lattice's vectors g (Bracewell, "The Fourier Transform and Its Applications", chapter 10); measured along
/// the edge's normal n, the copy at g moves an edge of length L by up to
///   H(g n) sinc(L g t) / (pi g n),
/// where H is the difference between the blur of picture and fit, t the edge's direction and sinc(x) = sin(pi x) /
/// (pi x). The error depends on where the edge lies between the filters. Along the pixel grid (g t = 0) it is the same
/// on the whole edge, and in every picture of a standing robot; on a slanted edge it averages out.
///
/// Red's lattice has g = (1/2, 0), (0, 1/2) and (1/2, +-1/2). Blue's is moved by one pixel and one column: its errors
/// have the opposite sign at the first two, and the same sign at the others. Green has only the others, with the
/// opposite sign. With the weights w of the colors, the sum of which is 1, the errors therefore have the factors
///   w_red - w_blue at (1/2, 0) and (0, 1/2), and w_red - w_green + w_blue at (1/2, +-1/2).
/// (This is why the brightness of a gray edge has no such error: 1/4, 1/2, 1/4.)
struct BayerSampling {
  /// Variance of the center along the outline's axes, in pixels^2, for a factor of 1.
  struct Axes {
    float x = 0, y = 0;
  };
  Axes grid;      // at (1/2, 0) and (0, 1/2)
  Axes diagonal;  // at (1/2, +-1/2)
};

/// `direction`: the outline's x axis in the picture, any length; the y axis is taken as perpendicular to it.
BayerSampling bayer_sampling(const BlurredOutline& outline, PixelPoint direction, float scale_px_per_m);

/// Weights of red, green and blue with the sum 1 that give the least variance of the center. `noise_px2`: its variance
/// from each color's other errors alone, above 0.
std::array<float, 3> channel_weights(const BayerSampling& sampling, const std::array<float, 3>& noise_px2);

/// The variance that sampling causes with these weights, in pixels^2.
BayerSampling::Axes sampling_variance(const BayerSampling& sampling, const std::array<float, 3>& weights);

}  // namespace touchline
