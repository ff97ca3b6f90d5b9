#include "firmware/config/light_map_file.h"

#include "hal/replay/picture.h"

namespace touchline::config {

Result<void> read_light_map(const std::string& path, LightMap& out) {
  // Larger files are refused before memory is allocated for their pixels, smaller ones below with their size.
  constexpr std::int64_t kMaxPixels = 1 << 20;
  TOUCHLINE_TRY_ASSIGN(const hal::Picture picture, hal::read_picture(path, kMaxPixels));
  if (!picture.is_16_bit()) {
    return failure(ErrorCode::kUnsupported, "%s: an illumination map has 16 bits per channel, this picture has 8",
                   path.c_str());
  }
  const std::size_t cells = std::size_t{picture.width_px} * picture.height_px;
  if (cells > kMaxLightCells) {
    return failure(ErrorCode::kOutOfRange, "%s: %u x %u cells are more than the %zu that an illumination map can have",
                   path.c_str(), picture.width_px, picture.height_px, kMaxLightCells);
  }
  for (std::size_t cell = 0; cell < cells; ++cell) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const std::uint16_t value = picture.rgb16[3 * cell + channel];
      if (value == 0) {
        return failure(ErrorCode::kOutOfRange, "%s: the cell in column %zu, row %zu has no light; make the map again",
                       path.c_str(), cell % picture.width_px, cell / picture.width_px);
      }
      out.illumination[channel][cell] = static_cast<float>(value / kUnitIllumination);
    }
  }
  out.columns = static_cast<std::uint16_t>(picture.width_px);
  out.rows = static_cast<std::uint16_t>(picture.height_px);
  return {};
}

}  // namespace touchline::config
