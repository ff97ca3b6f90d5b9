#pragma once

#include <array>
#include <cstdint>

#include "core/types.h"

namespace touchline {

/// R, G, B or Y, U, V of one pixel, for the few that are looked at one by one; u and v are in the frame.
inline std::array<std::uint8_t, 3> pixel_at(const Frame& frame, std::size_t u, std::size_t v) {
  const std::uint8_t* row = frame.plane[0] + v * frame.stride_bytes[0];
  const std::size_t pair = u / 2 * 4;
  switch (frame.format) {
    case PixelFormat::kRgb24:
      return {row[3 * u], row[3 * u + 1], row[3 * u + 2]};
    case PixelFormat::kBgr24:
      return {row[3 * u + 2], row[3 * u + 1], row[3 * u]};
    case PixelFormat::kYuyv:
      return {row[2 * u], row[pair + 1], row[pair + 3]};
    case PixelFormat::kUyvy:
      return {row[2 * u + 1], row[pair], row[pair + 2]};
    case PixelFormat::kNv12:
      break;
  }
  const std::uint8_t* chroma = frame.plane[1] + v / 2 * frame.stride_bytes[1];
  return {row[u], chroma[u / 2 * 2], chroma[u / 2 * 2 + 1]};
}

}  // namespace touchline
