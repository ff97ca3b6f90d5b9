#pragma once

namespace touchline {

/// Normal equation of least squares for the logarithm of the width of edges: derivative d, error r, weight w.
struct EdgeWidening {
  float power = 0, pull = 0;  // sums of w d d and w r d
};

/// Width of the edges in a camera's pictures, over which a pixel's covered fraction changes from 0 to 1. It depends on
/// the lens, its focus and color filters. Edges on opposite sides of a patch need no exact width. Where one side is
/// hidden or lies against a white line, and where colors are measured at every second pixel, a wrong one moves the
/// center.
class EdgeWidth {
 public:
  [[nodiscard]] float px() const { return px_; }
  /// Follows what the patches of a picture show with the present width.
  void follow(const EdgeWidening& picture);
  void reset() { *this = EdgeWidth(); }

 private:
  // At first the width of one pixel and a Gaussian blur of 0.4 pixels, which counts like that of one robot.
  float px_ = 2.25f, known_ = 3.0f;
};

}  // namespace touchline
