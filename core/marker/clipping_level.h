#pragma once

#include "core/types.h"

namespace touchline {

/// Returns the smallest value of R, G, B that counts as saturated in this frame. Where a digital gain below one, or a
/// program, darkened pixels that were clipped before, the channels end below 255: many colored pixels have exactly the
/// highest value of the frame in one channel. kSaturatedValue if the frame does not show that, and in YUV. The work is
/// bounded: one pixel in sixteen, and none behind the first that is saturated.
int saturated_from(const Frame& frame);

}  // namespace touchline
