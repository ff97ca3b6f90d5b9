#pragma once

#include "core/types.h"

namespace touchline {

/// Returns the smallest value of R, G, B that counts as saturated in this frame. If a digital gain below one, or a
/// program, has darkened pixels after they were clipped, the channels end below 255: many colored pixels have exactly
/// the highest value of the frame in one channel. Returns kSaturatedValue if no such highest value exists, and always
/// in YUV. The work is bounded: the function reads one pixel in sixteen, and stops at the first saturated pixel.
int saturated_from(const Frame& frame);

}  // namespace touchline
