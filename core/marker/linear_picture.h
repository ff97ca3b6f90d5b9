#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/marker/lanes.h"
#include "core/types.h"

namespace touchline {

/// Red, green and blue in proportion to the light that fell on four pixels; 1 is what a camera shows as 255.
using LightLanes = std::array<Lanes, 3>;

/// A frame's pixels as light. A pixel that two surfaces share shows the mean of their light; what the camera delivers
/// is that mean bent by its gamma (2.2 here, within a tenth of ITU-R BT.709, BT.601 and sRGB), in which half a bright
/// patch on a dark robot looks like three quarters of one. YUV is BT.601 of limited range, as cameras deliver it.
class LinearPicture {
 public:
  /// The frame must have been accepted by the scan, and lives at least as long as this.
  explicit LinearPicture(const Frame& frame) : frame_(frame) {}

  [[nodiscard]] int width() const { return frame_.width_px; }
  [[nodiscard]] int height() const { return frame_.height_px; }
  /// Of pixel (u, v) of the picture and the three that follow `step` apart; those beyond the row's end are its last.
  [[nodiscard]] LightLanes along_row(int u, int v, int step) const;
  /// Of the pixels nearest to four points; `inside`: those that are on the picture. The light of others is any pixel's.
  [[nodiscard]] LightLanes nearest(Lanes u_px, Lanes v_px, LaneMask& inside) const;

 private:
  Frame frame_;
};

/// Light of a channel's value.
float linear_light(std::uint8_t value);

}  // namespace touchline
