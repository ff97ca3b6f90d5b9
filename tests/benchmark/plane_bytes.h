#pragma once

#include <cstddef>

#include "core/color/row_classifier.h"
#include "core/types.h"

namespace touchline::testing {

/// From a plane's first byte to its last; 0: the format has no such plane.
inline std::size_t plane_bytes(const Frame& frame, std::size_t plane) {
  const std::size_t rows = plane == 0 ? frame.height_px : (frame.height_px + 1u) / 2u;
  const std::size_t row = row_bytes(frame.format, plane, frame.width_px);
  return row == 0 ? 0 : (rows - 1) * frame.stride_bytes[plane] + row;
}

}  // namespace touchline::testing
