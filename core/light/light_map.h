#pragma once

#include <array>
#include <cstdint>

#include "core/types.h"

namespace touchline {

// 64 x 48 cells: a cell is 10 pixels wide at 640 x 480, far smaller than any lamp's cone.
constexpr std::size_t kMaxLightCells = std::size_t{64} * 48;

/// Illumination plane N_BCK / C of Klancar eq. (17): relative brightness per channel (R, G, B), 1 at the place where
/// the colors were learned. A coarse grid covers the whole picture; cell centers are at (i + 1/2) * width / columns.
struct LightMap {
  std::uint16_t columns = 0, rows = 0;  // 0: no correction
  std::array<std::array<float, kMaxLightCells>, 3> illumination{};
};

}  // namespace touchline
