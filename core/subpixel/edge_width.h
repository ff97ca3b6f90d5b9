#pragma once

namespace touchline {

/// Normal equation of least squares for the logarithm of the width of edges: derivative d, error r, weight w.
struct EdgeWidening {
  float power = 0, pull = 0;  // sums of w d d and w r d
};

/// Estimates the width of edges in a camera's pictures, in pixels: the distance over which a pixel's covered fraction
/// changes from 0 to 1. It depends on the lens, its focus and the color filters. A wrong width causes no bias if both
/// of two opposite edges are clear. It biases the center if one edge is hidden or lies against a white line, and behind
/// a Bayer pattern.
class EdgeWidth {
 public:
  [[nodiscard]] float px() const { return px_; }
  /// Updates the width from the normal equation of all patches of a picture, found with the present width.
  void follow(const EdgeWidening& picture);
  void reset() { *this = EdgeWidth(); }

 private:
  // Prior: the width of one pixel with a Gaussian blur of 0.4 pixels, with the weight of one robot.
  float px_ = 2.25f, known_ = 3.0f;
};

}  // namespace touchline
