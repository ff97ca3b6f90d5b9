#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/cpu.h"
#include "core/fixed_vector.h"
#include "core/marker/marker_layout.h"
#include "core/subpixel/blurred_outline.h"
#include "core/types.h"

// What of the centers' fits (patch_center.h, ball_center.h) touches pixels, eight at a time.
namespace touchline {

/// Pixels that are computed at once.
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
  const FixedVector<BlurredOutline, kMaxPatches>* covers = nullptr;
  float half_m = 0, ramp_m = 0, scale_px_per_m = 0;
  PixelPoint middle;                                     // of the robot
  float u_by_x = 0, u_by_y = 0, v_by_x = 0, v_by_y = 0;  // pixels by the robot's frame around it
  std::array<float, 3> top{};                            // light of its top
};

/// A patch of it.
struct PatchView {
  std::size_t number = 0;  // in the layout
  PixelPoint center;
  FieldPoint at;  // the same, from where the pose says that it is, along its outline's axes
};

/// Sums over pixels that show one surface.
struct ColorSums {
  int count = 0;
  std::array<float, 3> light{};
  float squares = 0;  // of all channels together
};

/// Eight pixels of a row at a patch's edge.
struct EdgePixels {
  StoredFloat8 x, y;                  // m from where the pose says that the patch is, along its outline's axes
  std::array<StoredFloat8, 3> light;  // beyond that of the top, without what surrounds the robot
  StoredFloat8 doubt;                 // squared light of the surroundings in it
  StoredFloat8 counts;                // 1: on the patch's edge, and on the picture; else 0
};
// The largest square of which all is looked at is 32 x 32 pixels; a row crosses its edge twice, each in two groups.
using PatchEdge = FixedVector<EdgePixels, 144>;

/// What another patch adds to the pixels of one, in units of that one's own excess of light.
struct NeighborPatch {
  const BlurredOutline* cover = nullptr;
  float cos = 1, sin = 0, x_m = 0, y_m = 0;  // from the one's axes to its own
  FieldPoint half_box;
  float light = 0;
};

/// An edge and what is to be fitted to it.
struct EdgeFitTask {
  const PatchEdge* edge = nullptr;
  const BlurredOutline* cover = nullptr;
  FieldPoint at;                 // the outline's center, along its axes
  std::array<float, 3> along{};  // takes light to parts of the patch's own
  float doubted = 0;             // by which squared light of the surroundings takes weight away
  float ramp_m = 0;
  FixedVector<NeighborPatch, kMaxPatches> neighbors;
};

/// Normal equations of an outline's center: slopes s along x and y, error r, weight w.
struct CenterEquations {
  float xx = 0, xy = 0, yy = 0;    // w s s
  float rx = 0, ry = 0;            // w r s
  float squares = 0, weights = 0;  // w r r, w; of a patch only
};

constexpr std::size_t kShadeTerms = 4, kLightChannels = 3;

/// A ball's outline in one picture.
struct BallView {
  PixelPoint center;
  std::array<PixelPoint, 2> axis{};  // radii across the line of sight, as the picture shows them
  std::array<float, 4> inverse{};    // from pixels to radii
  float radius_px = 0;
};

/// Eight pixels of a row on the ball.
struct BallPixels {
  StoredFloat8 cover;                                // w; 0: does not count
  std::array<StoredFloat8, kShadeTerms - 1> slopes;  // w n
  std::array<StoredFloat8, kLightChannels> rest;     // seen - (1 - w) O
  std::array<StoredFloat8, kLightChannels> up_to;    // may be as much more as this; below 0: no more than is seen
  std::array<StoredFloat8, kLightChannels> outside;  // O, zero where the ball covers all
  StoredFloat8 out_x, out_y;                         // unit vector outwards in the ball's axes, zero but on the edge
  bool on_edge = false;
};
// Of 36 x 36 pixels, the largest square of which all are looked at.
using BallDisk = FixedVector<BallPixels, 185>;

/// Light of the ball: by channel, sums of terms times the channel's four.
struct BallShading {
  std::array<std::array<float, kShadeTerms>, kLightChannels> of{};
  float allowed = 1e30f;  // squared error at which a pixel counts half
};
struct ShadingEquations {
  std::array<std::array<float, kShadeTerms>, kShadeTerms> normal{};  // its lower triangle
  std::array<std::array<float, kShadeTerms>, kLightChannels> right{};
};
struct BallOutlineEquations {
  CenterEquations edge;                                                               // by the center, in radii
  std::array<std::array<float, kShadeTerms>, kLightChannels> shared_x{}, shared_y{};  // slopes times terms
  float fitting = 0, covered = 0;  // what is covered, with its weight and without
};

/// Frames have been accepted by the scan and are more than one pixel.
struct FitKernel {
  /// Light of the robot's top, where no patch is near.
  ColorSums (*sample_top)(const Frame& frame, const MarkerView& robot);
  /// The patch's pixels: those wholly covered, and the edge. False: too many.
  bool (*sample_patch)(const Frame& frame, const MarkerView& robot, const PatchView& patch, ColorSums& inside,
                       PatchEdge& edge);
  CenterEquations (*accumulate_edge)(const EdgeFitTask& task);
  /// False: too many.
  bool (*sample_ball)(const Frame& frame, const BallView& ball, BallDisk& disk);
  ShadingEquations (*accumulate_shading)(const BallDisk& disk, const BallShading& before);
  BallOutlineEquations (*accumulate_outline)(const BallDisk& disk, const BallShading& shades, float radius_px);
};

/// The fastest that this processor has, or the portable one. They give the same bits.
const FitKernel& fit_kernel(KernelChoice choice);

const FitKernel& portable_fit_kernel();
/// Null where the processor lacks AVX2.
const FitKernel* avx2_fit_kernel();

// A pixel's own width, and once and a half as much of the lens and of Bayer's pattern together.
constexpr float kRampPx = 2.5f;

/// Of a square with half this side, `reach_px`, every pixel is looked at where it is at most `all_px`; of larger ones
/// every second, third ...
int sampling_stride(float reach_px, float all_px);

}  // namespace touchline
