#include "core/subpixel/edge_width.h"

#include <algorithm>
#include <cmath>

namespace touchline {
namespace {

// Range of the width: sharp pixels, and a lens that is far out of focus.
constexpr float kSharpestPx = 1.3f, kBlurriestPx = 4.0f;
// Exponential mean over pictures: a weight falls to one half in 11 pictures.
constexpr float kKeptWeight = 0.94f;
constexpr float kLargestStep = 0.1f;

}  // namespace

void EdgeWidth::follow(const EdgeWidening& picture) {
  if (!(picture.power > 0.0f) || !std::isfinite(picture.pull)) return;
  known_ = kKeptWeight * known_ + picture.power;
  px_ *= 1.0f + std::clamp(picture.pull / known_, -kLargestStep, kLargestStep);
  px_ = std::clamp(px_, kSharpestPx, kBlurriestPx);
}

}  // namespace touchline
