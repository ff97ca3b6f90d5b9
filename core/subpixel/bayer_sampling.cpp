#include "core/subpixel/bayer_sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/fixed_vector.h"

namespace touchline {
namespace {

constexpr float kPiSquare = std::numbers::pi_v<float> * std::numbers::pi_v<float>;
// Variance of an edge's position, in pixels^2, for edges along the pixel grid and along its diagonals. It is small if
// the fit uses the picture's edge width. Larger values give weight to colors with little contrast between patch and
// top. RMS error of the heading in games of the arena with a blur of 0.45 pixels: 0.57, 0.41, 0.33 and 0.29 degrees
// with 0.03, 0.01, 0.003 and 0.001; with 0, headings on the reference scenes are a tenth worse.
constexpr float kOnGrid = 0.001f, kOnDiagonal = 0.0002f;

struct Edge {
  float length_m, nx, ny;  // outward unit normal in the outline's axes
};
using Edges = FixedVector<Edge, 4>;

Edges edges_of(const BlurredOutline& outline) {
  const float length = 2.0f * outline.half_length_m(), width = 2.0f * outline.half_width_m();
  Edges edges;
  if (outline.outline() == PatchOutline::kTriangle) {
    const FieldPoint left = outline.across_left();
    const float side = std::hypot(length, 0.5f * width);
    edges.push_back({width, -1, 0});
    edges.push_back({side, left.x_m, left.y_m});
    edges.push_back({side, left.x_m, -left.y_m});
  } else {
    for (const float sign : {-1.0f, 1.0f}) {
      edges.push_back({width, sign, 0});
      edges.push_back({length, 0, sign});
    }
  }
  return edges;
}

// Returns sinc^2 without its zeros, because an edge's length is not exact enough for them.
float smooth_sinc2(float x) {
  const float square = x * x;
  return 1.0f / (1.0f + kPiSquare * square * (1.0f + 6.0f * square) / (3.0f + 3.0f * square));
}

}  // namespace

BayerSampling bayer_sampling(const BlurredOutline& outline, PixelPoint direction, float scale_px_per_m) {
  BayerSampling sum;
  if (outline.outline() == PatchOutline::kCircle) {
    // Method of stationary phase: only two opposite arcs of length sqrt(r / g) contribute. The squared derivatives of
    // the whole circle sum to pi r.
    const float radius_px = scale_px_per_m * std::min(outline.half_length_m(), outline.half_width_m());
    const float grid = 2.0f * kOnGrid * 2.0f / (kPiSquare * radius_px);
    const float diagonal = 2.0f * kOnDiagonal * std::numbers::sqrt2_v<float> / (kPiSquare * radius_px);
    return {{grid, grid}, {diagonal, diagonal}};
  }
  const float norm = std::hypot(direction.u_px, direction.v_px);
  const float c = direction.u_px / norm, s = direction.v_px / norm;
  float steep_x = 0, steep_y = 0;
  for (const Edge& edge : edges_of(outline)) {
    const float length_px = edge.length_m * scale_px_per_m;
    const float nu = std::abs(c * edge.nx - s * edge.ny), nv = std::abs(s * edge.nx + c * edge.ny);
    const float off_grid = 0.5f * std::min(nu, nv), off_diagonal = 0.5f * std::abs(nu - nv);
    const float squared = length_px * length_px, xx = squared * edge.nx * edge.nx, yy = squared * edge.ny * edge.ny;
    const float grid = kOnGrid * smooth_sinc2(length_px * off_grid);
    const float diagonal = kOnDiagonal * smooth_sinc2(length_px * off_diagonal);
    sum.grid.x += xx * grid;
    sum.grid.y += yy * grid;
    sum.diagonal.x += xx * diagonal;
    sum.diagonal.y += yy * diagonal;
    steep_x += length_px * edge.nx * edge.nx;
    steep_y += length_px * edge.ny * edge.ny;
  }
  // Least squares over all edges: an edge's error counts in proportion to its length.
  sum.grid.x /= steep_x * steep_x;
  sum.diagonal.x /= steep_x * steep_x;
  sum.grid.y /= steep_y * steep_y;
  sum.diagonal.y /= steep_y * steep_y;
  return sum;
}

std::array<float, 3> channel_weights(const BayerSampling& sampling, const std::array<float, 3>& noise_px2) {
  const auto& [red, green, blue] = noise_px2;
  const float grid = 0.5f * (sampling.grid.x + sampling.grid.y);
  const float diagonal = 0.5f * (sampling.diagonal.x + sampling.diagonal.y);
  // Minimizes grid d^2 + diagonal (2 s - 1)^2 + red w_red^2 + green w_green^2 + blue w_blue^2, where s and d are sum
  // and difference of w_red and w_blue, and w_green = 1 - s. For any s, the best d is -s times this ratio:
  const float ratio = (red - blue) / (4.0f * grid + red + blue);
  const float of_s = 0.5f * (red * (1.0f - ratio) + blue * (1.0f + ratio));
  const float s = (4.0f * diagonal + 2.0f * green) / (8.0f * diagonal + of_s + 2.0f * green);
  return {0.5f * s * (1.0f - ratio), 1.0f - s, 0.5f * s * (1.0f + ratio)};
}

BayerSampling::Axes sampling_variance(const BayerSampling& sampling, const std::array<float, 3>& weights) {
  const auto& [red, green, blue] = weights;
  const float grid = (red - blue) * (red - blue), diagonal = (red - green + blue) * (red - green + blue);
  return {grid * sampling.grid.x + diagonal * sampling.diagonal.x,
          grid * sampling.grid.y + diagonal * sampling.diagonal.y};
}

}  // namespace touchline
