#include "firmware/config/light_map_file.h"

#include <algorithm>
#include <cmath>

#include "hal/replay/picture.h"

namespace touchline::config {
namespace {

// Number of pixels above which a file is rejected before memory is allocated for it. Smaller files with a wrong size
// are rejected later, with their size in the message.
constexpr std::int64_t kMaxPixels = 1 << 20;
// Ratio of the value in the file to a sum of four pixels.
constexpr std::uint16_t kReferenceScale = 64;

}  // namespace

Result<void> read_light_map(const std::string& path, LightMap& out) {
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

Result<void> read_light_reference(const std::string& path, std::uint16_t width_px, std::uint16_t height_px,
                                  LightReference& out) {
  TOUCHLINE_TRY_ASSIGN(const hal::Picture picture, hal::read_picture(path, kMaxPixels));
  if (!picture.is_16_bit()) {
    return failure(ErrorCode::kUnsupported, "%s: a reference of the field has 16 bits per channel, this picture has 8",
                   path.c_str());
  }
  const ReferenceGrid grid = ReferenceGrid::of(width_px, height_px);
  if (picture.width_px != grid.columns || picture.height_px != grid.rows) {
    return failure(ErrorCode::kInconsistent,
                   "%s: has %u x %u cells, but pictures of %u x %u pixels have %u x %u; learn the colors again",
                   path.c_str(), picture.width_px, picture.height_px, unsigned{width_px}, unsigned{height_px},
                   unsigned{grid.columns}, unsigned{grid.rows});
  }
  for (std::size_t i = 0; i < picture.rgb16.size(); ++i) {
    out.colors.sum[i % 3][i / 3] =
        static_cast<std::uint16_t>((picture.rgb16[i] + kReferenceScale / 2) / kReferenceScale);
  }
  out.columns = grid.columns;
  out.rows = grid.rows;
  return {};
}

Result<std::string> encode_light_map(const LightMap& map) {
  hal::Picture picture;
  picture.width_px = map.columns;
  picture.height_px = map.rows;
  const std::size_t cells = std::size_t{map.columns} * map.rows;
  picture.rgb16.resize(3 * cells);
  for (std::size_t i = 0; i < picture.rgb16.size(); ++i) {
    const double value = std::round(kUnitIllumination * static_cast<double>(map.illumination[i % 3][i / 3]));
    picture.rgb16[i] = static_cast<std::uint16_t>(std::clamp(value, 1.0, 65535.0));
  }
  return hal::encode_png(picture);
}

Result<std::string> encode_light_reference(const LightReference& reference) {
  hal::Picture picture;
  picture.width_px = reference.columns;
  picture.height_px = reference.rows;
  picture.rgb16.resize(3 * std::size_t{reference.columns} * reference.rows);
  for (std::size_t i = 0; i < picture.rgb16.size(); ++i) {
    picture.rgb16[i] = static_cast<std::uint16_t>(kReferenceScale * reference.colors.sum[i % 3][i / 3]);
  }
  return hal::encode_png(picture);
}

}  // namespace touchline::config
