#pragma once

#include <cstddef>
#include <vector>

#include "tools/programs/devices/judge/luma_picture.h"

namespace touchline::devices {

/// A region that differs from the background, described by its moments. Lengths are in squares of the luma picture.
struct MovingObject {
  double x = 0.0, y = 0.0;  // centroid
  double lean = 0.0;  // shear: change of x per row along the line through the middle of each row, cov(x, y) / var(y)
  double log_height = 0.0;  // logarithm of the standard deviation of y
  double area = 0.0;
  bool cut_at_side = false;  // touches the left or right edge of the picture
  bool cut_at_end = false;   // touches the first or last row
};

/// Finds moving objects in pictures of a camera at rest.
class MovingObjectFinder {
 public:
  /// `noise`: standard deviation of a value of the luma picture.
  MovingObjectFinder(LumaPicture background, double noise);
  /// Returns the objects that are large enough for their lean to be measured.
  const std::vector<MovingObject>& find(const LumaPicture& picture);

 private:
  MovingObject measure(std::size_t seed);

  LumaPicture background_;
  float threshold_;
  std::vector<float> weight_;  // 0: background; 1: object; between: edge
  std::vector<std::size_t> open_;
  std::vector<MovingObject> found_;
};

}  // namespace touchline::devices
