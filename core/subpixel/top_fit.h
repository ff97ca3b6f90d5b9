#pragma once

#include <array>

#include "core/geometry/camera_model.h"
#include "core/marker/marker_layout.h"
#include "core/subpixel/bayer_detector.h"
#include "core/subpixel/blurred_outline.h"
#include "core/subpixel/edge_width.h"
#include "core/subpixel/fit_kernel.h"
#include "core/types.h"

namespace touchline {

/// What a picture shows of a robot's top.
struct SeenTop {
  Pose pose;
  PoseCovariance noise;
  float trust = 0;                       // weight of `pose` against the start, 0 to 1
  float team_patch_error = 0;            // RMS error of its covered fractions
  float unevenness = 0;                  // largest variation of light within a patch, as in PatchLight
  float residual_m = 0;                  // RMS distance of the patches, each alone, from their positions in the layout
  bool is_precise = false;               // whether this residual allows an id
  float lasting_share = 0, lasts_m = 0;  // as in RobotSighting
  std::array<float, 3> top{};            // its light
  FixedVector<PixelPoint, kMaxPatches> patches;  // centers in the layout's order
};

/// Improves the pose of a recognized robot to a fraction of a pixel: one fit of three parameters to the edges of all
/// its patches. A pixel counts by the fraction of it that a patch covers. In a region's centroid (Klancar,
/// section 4.2), a pixel counts completely or not at all, and a region that is torn or bleeds into a neighbor misplaces
/// the robot.
///
/// The model of the picture has patches of known outline (patch k covers the fraction w_k of a pixel) on a top of one
/// color T. Beyond the robot's edge (the robot covers the fraction r) there are surroundings O. Light is additive, so a
/// pixel shows
///   r T + (1 - r) O + sum of w_k (P_k - T).
/// P_k is the mean of the completely covered pixels, T the mean of the free parts of the top, and O the light just
/// beyond the robot's edge. The pose minimizes the squared error of this model on the edge pixels of all patches
/// (Gauss-Newton; README.md derives the equations), in a weighted mean of the colors. Behind a Bayer pattern, a pixel
/// counts only in the color that it measured, with the weights of bayer_sampling.h. A pixel has a lower weight if it
/// depends on an O that differs much from T (a line, a wall, another robot's patch).
///
/// Regions only give the start: a robot whose regions are torn, or one of which is missing, is fitted as well. If its
/// start is too far away for the edges' blur, a second fit begins with wider edges. A robot keeps its pose if the
/// picture does not fit the model: no free top, patches of a few pixels, large residuals. The light is uniform over one
/// robot, so the light map is not needed. The work per robot is bounded: on large patches, only every second, third,
/// ... pixel and row is sampled.
class TopFit {
 public:
  /// `layouts`: valid layouts indexed by Team. A team without a marker has no patches.
  void configure(const std::array<MarkerLayout, 2>& layouts, const CameraModel& camera,
                 KernelChoice kernel = KernelChoice::kFastest);

  /// Changes the heights of the markers, by Team, between two frames.
  void set_heights(const std::array<float, 2>& height_m);

  /// Improves pose, residual, noise and patch centers of each robot with a heading and at least two patches in its
  /// layout. Changes the confidence of robots without an id, with or without a heading, by how well their tops fit.
  /// The scan must have accepted the frame.
  void refine(const Frame& frame, Sightings& sightings);

  /// Looks for a robot of a team near a pose in the frame that refine() has seen. False if the picture does not show
  /// it: then positions or light of the patches do not fit at all. Light may be uneven within a patch.
  bool look(const Frame& frame, Team team, const Pose& start, SeenTop& out);
  /// Light of the team's tops: the mean of the recent ones that were recognized and fit the model, so hardly any of
  /// them mirrors a lamp.
  [[nodiscard]] const std::array<float, 3>& usual_top(Team team) const { return markers_[index_of(team)].usual_top; }

 private:
  struct Marker {
    MarkerLayout layout;
    FixedVector<BlurredOutline, kMaxPatches> outlines;
    std::array<float, 3> usual_top{};  // mean over recent tops that fit
    float usual_error = 0;             // mean of SeenTop::team_patch_error over recent robots with an id
  };
  class Solver;
  bool look(const Frame& frame, Team team, const Pose& start, bool is_light_even, SeenTop& out, EdgeWidening& widening);

  const FitKernel* kernel_ = nullptr;
  std::array<Marker, 2> markers_;
  CameraModel camera_;
  BayerDetector bayer_;
  EdgeWidth edge_width_;
  std::array<PatchEdge, kMaxPatches> edges_;  // of the robot that is being fitted
};

}  // namespace touchline
