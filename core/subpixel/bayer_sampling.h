#pragma once

#include <array>

#include "core/subpixel/blurred_outline.h"
#include "core/types.h"

namespace touchline {

/// The bias of a fitted patch center that a camera's color filters cause, and the weights of the colors that keep it
/// small.
///
/// Behind a Bayer pattern, red and blue are measured at every second pixel of every second row, green at every second
/// pixel of each row. Interpolated values add no information. Sampling adds copies of the picture's spectrum at the
/// vectors g of the reciprocal lattice (Bracewell, "The Fourier Transform and Its Applications", chapter 10). Along the
/// edge's normal n, the copy at g moves an edge of length L by up to
///   H(g n) sinc(L g t) / (pi g n),
/// where H is the difference between the blur of picture and fit, t is the edge's direction, and sinc(x) = sin(pi x) /
/// (pi x). The error depends on the edge's position between the filters. On an edge along the pixel grid (g t = 0), it
/// is a bias: constant along the edge, and constant over the pictures of a standing robot. On a slanted edge it
/// averages out.
///
/// Red's lattice has g = (1/2, 0), (0, 1/2) and (1/2, +-1/2). Blue's lattice is displaced by one row and one column:
/// its errors have the opposite sign at the first two g, and equal sign at the diagonal g. Green has only the diagonal
/// g, with the opposite sign. If the weights w of the colors sum to 1, the errors therefore have the factors
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

/// `direction`: the outline's x axis in the picture, of any length. The y axis is assumed to be perpendicular.
BayerSampling bayer_sampling(const BlurredOutline& outline, PixelPoint direction, float scale_px_per_m);

/// Returns the weights of red, green and blue, with the sum 1, that minimize the variance of the center. `noise_px2`:
/// variance of the center from each color's other errors alone, above 0.
std::array<float, 3> channel_weights(const BayerSampling& sampling, const std::array<float, 3>& noise_px2);

/// Returns the variance that sampling causes with these weights, in pixels^2.
BayerSampling::Axes sampling_variance(const BayerSampling& sampling, const std::array<float, 3>& weights);

}  // namespace touchline
