#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/cpu.h"
#include "core/fixed_vector.h"
#include "core/marker/marker_layout.h"
#include "core/subpixel/bayer_detector.h"
#include "core/subpixel/blurred_outline.h"
#include "core/types.h"

// The functions of the fits (top_fit.h, ball_center_fit.h) that process pixels, eight at a time.
namespace touchline {

/// Number of pixels that are processed together.
constexpr int kLanes = 8;

/// Eight values in memory.
struct alignas(32) StoredFloat8 {
  std::array<float, kLanes> value;
};
struct alignas(32) StoredInteger8 {
  std::array<std::int32_t, kLanes> value;
};

/// A robot in one picture.
struct MarkerView {
  const MarkerLayout* layout = nullptr;
  const FixedVector<BlurredOutline, kMaxPatches>* outlines = nullptr;
  float half_m = 0, ramp_m = 0, scale_px_per_m = 0;
  PixelPoint middle;                                     // center of the robot
  float u_by_x = 0, u_by_y = 0, v_by_x = 0, v_by_y = 0;  // pixels per meter of the robot's frame
  std::array<float, 3> top{};                            // light of its top
  float beside_px = 0;  // distance from its edge of the second sample of the surroundings
  BayerPattern bayer;
};

/// A patch of this robot.
struct PatchView {
  std::size_t number = 0;  // index in the layout
  PixelPoint center;
};

/// Sums over the pixels of one surface.
struct ColorSums {
  std::array<float, 3> count{};  // of pixels that measured the color
  std::array<float, 3> light{}, squares{};
  std::array<float, 3> foreign{};  // squared light of the surroundings that was subtracted from edge pixels
};

/// Eight pixels of a row at a patch's edge.
struct EdgePixels {
  StoredFloat8 x, y;                  // meters from the center, along the outline's axes
  std::array<StoredFloat8, 3> light;  // light of top and surroundings is subtracted
  StoredFloat8 doubt;                 // squared light of the surroundings that was subtracted
  // 0: not on the patch's edge, or outside the picture. Without a Bayer pattern, 1. Behind a pattern, 1, 2 or 3 for the
  // measured color; the light of the other colors is 0 then.
  StoredFloat8 measured;
};
// The largest square that is sampled completely has 32 x 32 pixels. A row crosses its outline twice, in two groups
// each.
using PatchEdge = FixedVector<EdgePixels, 144>;

/// Light that another patch of the robot adds to a patch's pixels, relative to the patch's own contrast. Behind a Bayer
/// pattern by color; otherwise of all colors together, in light[0].
struct NeighborPatch {
  const BlurredOutline* outline = nullptr;
  float cos = 1, sin = 0, x_m = 0, y_m = 0;  // from the patch's axes to those of the neighbor
  FieldPoint half_box;
  std::array<float, 3> light{};
};

/// A patch's edge and the model to fit to it.
struct EdgeFitTask {
  const PatchEdge* edge = nullptr;
  const BlurredOutline* outline = nullptr;
  // Projects light to a covered fraction: the scalar product with the light of a covered pixel is 1. Behind a Bayer
  // pattern, each product of a single color is 1.
  std::array<float, 3> along{};
  bool is_bayer = false;
  std::array<float, 3> weight{};  // of a pixel by its measured color; only behind a Bayer pattern
  // Factor from EdgePixels::doubt to the reduction of a pixel's weight. By color as in NeighborPatch::light.
  std::array<float, 3> doubted{};
  float ramp_m = 0;
  FixedVector<NeighborPatch, kMaxPatches> neighbors;
};

/// Normal equations of least squares for an outline's center: derivatives s along x and y, error r, weight w.
struct CenterEquations {
  float xx = 0, xy = 0, yy = 0;  // w s s
  float rx = 0, ry = 0;          // w r s
  // Only for patches: sums of w r r, w, w d d and w r d, where d is the derivative by the logarithm of the ramp's
  // width.
  float squares = 0, weights = 0, widening = 0, wider = 0;
  // Only for patches: the same sums with the derivative t by the outline's turn about its center.
  float xt = 0, yt = 0, tt = 0, rt = 0;
};

constexpr std::size_t kShadeTerms = 4, kLightChannels = 3;
/// Robots that touch one ball in a picture.
constexpr std::size_t kMaxHidingTops = 4;

/// A robot that may hide a part of the ball: with its top, or with a side that the camera sees.
struct HidingTop {
  PixelPoint center;
  std::array<float, 4> inverse{};        // from pixels to half sides
  float reach_x = 0, reach_y = 0;        // half size of the area that may show the top, in half sides
  float per_fall_x = 0, per_fall_y = 0;  // 1 / motion of a viewing ray in half sides from the top down to the ball
};

/// A ball's outline in one picture.
struct BallView {
  PixelPoint center;
  std::array<PixelPoint, 2> axis{};  // projections of two radii perpendicular to the line of sight
  std::array<float, 4> inverse{};    // from pixels to radii
  float radius_px = 0;
  float ramp_px = 0;  // width of the outline, over which the covered fraction changes from 0 to 1
  std::array<std::array<float, 2>, 2> lines{};  // directions of the field's axes, unit vectors in the ball's axes
  FixedVector<HidingTop, kMaxHidingTops> tops;
};

/// Eight pixels of a row on the ball, or so near that the ball may cover them after a small step.
struct BallPixels {
  // Read from the picture.
  StoredFloat8 u, v;
  std::array<StoredFloat8, kLightChannels> light;
  StoredFloat8 counts;  // 1, or 0 for a pixel that is not used
  StoredFloat8 apart2;  // squared error of O
  // Derived from the ball's center.
  StoredFloat8 coverage;                             // w; 0 if the pixel is not used
  std::array<StoredFloat8, kShadeTerms - 1> slopes;  // w n
  std::array<StoredFloat8, kLightChannels> rest;     // measured light - (1 - w) O
  std::array<StoredFloat8, kLightChannels>
      up_to;  // upper bound of the light of a saturated channel; negative if it is not saturated
  std::array<StoredFloat8, kLightChannels> outside;  // O; zero if the ball covers the pixel completely
  StoredFloat8 out_x, out_y;                         // outward unit vector in the ball's axes; zero except on the edge
  StoredFloat8 doubt;                                // squared error of the pixel's light from the error of O
  bool on_edge = false;
};
// The largest square that is sampled completely has 36 x 36 pixels.
using BallDisk = FixedVector<BallPixels, 185>;

/// Light of the ball: four coefficients (b0, b) per channel.
struct BallShading {
  std::array<std::array<float, kShadeTerms>, kLightChannels> of{};
  float allowed = 1e30f;  // squared residual at which the weight is one half
};
struct ShadingEquations {
  std::array<std::array<float, kShadeTerms>, kShadeTerms> normal{};  // lower triangle only
  std::array<std::array<float, kShadeTerms>, kLightChannels> right{};
  // Sums of the covered fractions: weighted by the previous residuals, weighted by residuals and doubtful surroundings,
  // and without weights.
  float fitting = 0, weighted = 0, covered = 0;
};
struct BallOutlineEquations {
  CenterEquations edge;                                                               // for the center, in radii
  std::array<std::array<float, kShadeTerms>, kLightChannels> shared_x{}, shared_y{};  // derivatives times shading terms
  float pull_xx = 0, pull_xy = 0, pull_yy = 0;  // (w r s)^2: the squared contributions to rx and ry
  float ramp_power = 0, ramp_pull = 0;          // w s s and w r s for the ramp's width, in radii
};

/// Functions on the pixels of a frame. The scan must have accepted the frame, and it must be wider than one pixel.
struct FitKernel {
  /// Sums the light of the robot's top away from patches.
  ColorSums (*sample_top)(const Frame& frame, const MarkerView& robot);
  /// Collects the patch's pixels: completely covered ones and those on the edge. False if there are too many.
  bool (*sample_patch)(const Frame& frame, const MarkerView& robot, const PatchView& patch, ColorSums& inside,
                       PatchEdge& edge);
  CenterEquations (*accumulate_edge)(const EdgeFitTask& task);
  /// Collects the pixels of the ball. False if there are too many.
  bool (*sample_ball)(const Frame& frame, const BallView& ball, BallDisk& disk);
  /// Moves the outline over the collected pixels. Within kKeptSamplesPx of the outline in sample_ball(), no pixel is
  /// missing, and it is known which pixels lie on the outline.
  void (*move_ball)(const BallView& ball, BallDisk& disk);
  ShadingEquations (*accumulate_shading)(const BallDisk& disk, const BallShading& before);
  BallOutlineEquations (*accumulate_outline)(const BallDisk& disk, const BallShading& shading, const BallView& ball);
};

/// The kernel of the chosen instruction set; the portable one if this processor lacks the set. All kernels give
/// identical results.
const FitKernel& fit_kernel(KernelChoice choice);

/// The kernel of each instruction set; core/cpu.h lists them. The AVX2 kernel is only defined on x86-64 and must only
/// run on processors with AVX2.
const FitKernel& portable_fit_kernel();
const FitKernel& avx2_fit_kernel();

// Largest motion of the ball's outline for which the sampled pixels and surroundings stay valid.
constexpr float kKeptSamplesPx = 0.25f;

/// Sampling stride for a square with half side `reach_px`: 1 (every pixel) if `reach_px` is below `all_px`, then 2, 3,
/// ...
int sampling_stride(float reach_px, float all_px);

}  // namespace touchline
