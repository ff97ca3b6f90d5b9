#include "firmware/config/light_map_file.h"

#include "hal/replay/picture.h"

namespace touchline::config {

Status read_light_map(const std::string& path, LightMap& out, std::string& reason) {
  hal::Picture picture;
  // Larger files are refused before memory is allocated for their pixels, smaller ones below with their size.
  constexpr std::int64_t kMaxPixels = 1 << 20;
  if (const Status status = hal::read_picture(path, picture, reason, kMaxPixels); !status.ok()) return status;
  if (!picture.is_16_bit()) {
    reason = path + ": an illumination map has 16 bits per channel, this picture has 8";
    return ErrorCode::kUnsupported;
  }
  const std::size_t cells = std::size_t{picture.width_px} * picture.height_px;
  if (cells > kMaxLightCells) {
    reason = path + ": " + std::to_string(picture.width_px) + " x " + std::to_string(picture.height_px) +
             " cells are more than the " + std::to_string(kMaxLightCells) + " that an illumination map can have";
    return ErrorCode::kOutOfRange;
  }
  for (std::size_t cell = 0; cell < cells; ++cell) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const std::uint16_t value = picture.rgb16[3 * cell + channel];
      if (value == 0) {
        reason = path + ": the cell in column " + std::to_string(cell % picture.width_px) + ", row " +
                 std::to_string(cell / picture.width_px) + " has no light; make the map again";
        return ErrorCode::kOutOfRange;
      }
      out.illumination[channel][cell] = static_cast<float>(value / kUnitIllumination);
    }
  }
  out.columns = static_cast<std::uint16_t>(picture.width_px);
  out.rows = static_cast<std::uint16_t>(picture.height_px);
  return {};
}

}  // namespace touchline::config
