#pragma once

#include "core/geometry/camera_model.h"
#include "core/marker/ball_finder.h"
#include "core/subpixel/fit_kernel.h"
#include "core/types.h"

namespace touchline {

/// Center of the ball from its outline. The centroid of the pixels that have the ball's color lies towards the lamps,
/// because the other side is too dark to have it.
///
/// The ball's radius and the camera are known, and with them its outline. A matt ball of one color is shaded by the
/// direction n of its surface: under any number of lamps, b0 + b . n per channel (Lambert's law; Basri and Jacobs 2003
/// give the error for the side that a lamp does not reach). A pixel of which the ball covers the part w shows
///   w (b0 + b . n) + (1 - w) O,
/// O being what is seen just outside there. For a center the best b is a linear problem; the center is where the
/// pixels on the outline fit best (Gauss-Newton with the linear part projected out: Kaufman 1975). Pixels that do not
/// fit, as those of a robot in front, count less.
///
/// A ball keeps the center it has when the picture does not look like that. The work is bounded: of a large one every
/// second, third ... pixel of a row and every such row is looked at.
class BallCenterFit {
 public:
  void configure(const BallParameters& ball, const CameraModel& camera, KernelChoice kernel = KernelChoice::kFastest);

  /// Moves center and position of the ball, if one was seen. The frame has been accepted by the scan.
  void refine(const Frame& frame, Sightings& sightings);

 private:
  class Solver;

  const FitKernel* kernel_ = nullptr;
  BallParameters ball_;
  CameraModel camera_;
  BallDisk disk_;
};

}  // namespace touchline
