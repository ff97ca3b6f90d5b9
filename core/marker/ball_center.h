#pragma once

#include <array>

#include "core/geometry/camera_model.h"
#include "core/marker/ball_finder.h"
#include "core/marker/linear_picture.h"
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
class BallCenter {
 public:
  void configure(const BallParameters& ball, const CameraModel& camera);

  /// Moves center and position of the ball, if one was seen. The frame has been accepted by the scan.
  void refine(const Frame& frame, Sightings& sightings);

 private:
  static constexpr std::size_t kTerms = 4, kChannels = 3;

  // Four pixels of a row.
  struct DiskPixels {
    Lanes cover;                              // 0: does not count
    std::array<Lanes, kTerms> terms;          // w and w n
    LightLanes rest, outside;                 // seen - (1 - w) O; O, zero where the ball covers all
    std::array<LaneMask, kChannels> cut_off;  // so bright that the camera shows its largest value
    Lanes out_x, out_y;                       // unit vector outwards in the ball's axes, zero but on the edge
    bool on_edge;
  };
  // Of 36 x 36 pixels, the largest square of which all are looked at.
  using Disk = FixedVector<DiskPixels, 324>;
  class Fit;

  BallParameters ball_;
  CameraModel camera_;
  Disk disk_;
};

}  // namespace touchline
