#pragma once

#include "core/geometry/camera_model.h"
#include "core/marker/ball_finder.h"
#include "core/marker/robot_top.h"
#include "core/subpixel/fit_kernel.h"
#include "core/types.h"

namespace touchline {

/// Finds the ball's center from its outline. The centroid of the ball's color is biased towards the lamps, because the
/// shaded side is too dark for this color.
///
/// The ball's radius and the camera are known, so the shape of the outline is known. The light of a matt ball depends
/// on the surface normal n. Under any number of lamps it is b0 + b . n per channel (Lambert's law; Basri and Jacobs
/// 2003 give the error on the side that a lamp does not reach). If the ball covers the fraction w of a pixel, the pixel
/// shows
///   w (b0 + b . n) + (1 - w) O,
/// where O is the light of the surroundings just outside the ball. For a given center, the best b solves a linear
/// problem. Gauss-Newton finds the center, with the linear part projected out (variable projection, Kaufman 1975). The
/// width of the edge, over which w changes from 0 to 1, is fitted too. Pixels with a large residual have a lower
/// weight. Outline pixels also have a lower weight where O differs from the floor around the rest of the ball, because
/// a line, a wall or a robot begins somewhere under the ball. Lines and walls are parallel to the field's axes: if O is
/// equal on both sides of the ball along an axis, it is interpolated between them. Pixels do not count where a robot
/// hides the ball. If little of the ball remains, priors on shading and center dominate.
///
/// The covariance of the center follows from the residuals of the pixels (sandwich estimator, White 1980). It does not
/// assume equal errors, because most errors come from the surroundings and the shading.
///
/// If the picture does not fit this model, the ball keeps its center. The work is bounded: on a large ball, only every
/// second, third, ... pixel and row is sampled.
class BallCenterFit {
 public:
  void configure(const BallParameters& ball, const CameraModel& camera, KernelChoice kernel = KernelChoice::kFastest);

  /// Sizes of the robots that may hide the ball, by Team; none before the first call.
  void set_robots(const std::array<RobotSize, 2>& sizes) { robots_ = sizes; }

  /// Improves center, position and noise of the ball, if one was seen. The scan must have accepted the frame.
  void refine(const Frame& frame, Sightings& sightings);

 private:
  class Solver;

  // At first, the width of one pixel and a Gaussian blur of 0.4 pixels.
  static constexpr float kFirstRampPx = 2.0f;

  const FitKernel* kernel_ = nullptr;
  BallParameters ball_;
  CameraModel camera_;
  std::array<RobotSize, 2> robots_{};
  float ramp_px_ = kFirstRampPx;  // width of the last ball's outline
  BallDisk disk_;
};

}  // namespace touchline
