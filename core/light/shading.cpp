#include "core/light/shading.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchline {
namespace {

// Values of 2^(k / 64) for k = 0..63. Even k are gains, odd k the borders between neighboring levels. The values are
// constants, because libraries differ in the last bit of exp2 and the tables must be the same on every board.
constexpr std::array<float, 64> kOctave = {
    1.0f,        1.01088929f, 1.0218972f,  1.03302491f, 1.04427373f, 1.05564523f, 1.06714046f, 1.07876074f,
    1.09050775f, 1.10238254f, 1.1143868f,  1.12652159f, 1.13878858f, 1.15118921f, 1.1637249f,  1.17639697f,
    1.18920708f, 1.20215678f, 1.21524739f, 1.22848058f, 1.24185777f, 1.25538075f, 1.26905096f, 1.28287005f,
    1.29683959f, 1.31096125f, 1.32523668f, 1.33966756f, 1.35425556f, 1.36900246f, 1.38390994f, 1.39897966f,
    1.41421354f, 1.42961335f, 1.44518077f, 1.46091783f, 1.47682619f, 1.49290776f, 1.50916445f, 1.52559817f,
    1.54221082f, 1.55900443f, 1.5759809f,  1.59314215f, 1.61049032f, 1.62802744f, 1.64575553f, 1.66367662f,
    1.68179286f, 1.70010638f, 1.71861935f, 1.73733389f, 1.75625217f, 1.77537644f, 1.79470909f, 1.81425214f,
    1.8340081f,  1.85397911f, 1.87416768f, 1.89457595f, 1.91520655f, 1.93606174f, 1.95714414f, 1.97845602f,
};

// Returns 2^(step / 64) / 4: an entry of kOctave times a power of two, which is exact.
constexpr float power(int step) {
  const float octave[] = {0.25f, 0.5f, 1.0f, 2.0f};
  return octave[step / 64] * kOctave[static_cast<std::size_t>(step % 64)];
}

constexpr auto kGains = [] {
  std::array<float, kLightLevels> gains{};
  for (int level = 0; level < kLightLevels; ++level) gains[static_cast<std::size_t>(level)] = power(2 * level);
  return gains;
}();

// Border k lies between levels k and k + 1.
constexpr auto kBorders = [] {
  std::array<float, kLightLevels - 1> borders{};
  for (int k = 0; k + 1 < kLightLevels; ++k) borders[static_cast<std::size_t>(k)] = power(2 * k + 1);
  return borders;
}();

std::uint8_t scaled_about(int black, int value, float gain) {
  const float scaled = static_cast<float>(value - black) * gain;
  const int rounded = static_cast<int>(scaled + (scaled < 0.0f ? -0.5f : 0.5f));
  return static_cast<std::uint8_t>(std::clamp(black + rounded, 0, 255));
}

// Position of a tile's center between the cells of one axis of the map.
struct Blend {
  std::size_t low = 0, high = 0;
  float weight_of_high = 0.0f;
};

Blend blend_at(std::size_t tile, std::uint16_t tile_size, std::uint16_t picture_size, std::uint16_t cells) {
  const float center_px = (static_cast<float>(tile) + 0.5f) * static_cast<float>(tile_size);
  const float cell = center_px * static_cast<float>(cells) / static_cast<float>(picture_size) - 0.5f;
  const float bounded = std::clamp(cell, 0.0f, static_cast<float>(cells - 1));
  Blend blend;
  blend.low = static_cast<std::size_t>(bounded);
  blend.high = std::min<std::size_t>(blend.low + 1, cells - 1u);
  blend.weight_of_high = bounded - static_cast<float>(blend.low);
  return blend;
}

bool usable(const LightMap& map) {
  const std::size_t cells = std::size_t{map.columns} * map.rows;
  if (cells == 0 || cells > kMaxLightCells) return false;
  for (const auto& plane : map.illumination) {
    // Written so that NaN is rejected.
    const auto good = [](float value) { return value > 0.0f && value <= std::numeric_limits<float>::max(); };
    if (!std::all_of(plane.begin(), plane.begin() + static_cast<std::ptrdiff_t>(cells), good)) return false;
  }
  return true;
}

}  // namespace

float gain_of_level(std::uint8_t level) { return kGains[level]; }

std::uint8_t level_of_gain(float gain) {
  return static_cast<std::uint8_t>(std::upper_bound(kBorders.begin(), kBorders.end(), gain) - kBorders.begin());
}

std::uint8_t corrected(std::uint8_t value, std::uint8_t level, std::uint8_t black) {
  return scaled_about(black, value, gain_of_level(level));
}

std::array<std::uint8_t, 256> corrected_values(std::uint8_t level, std::uint8_t black) {
  const float gain = gain_of_level(level);
  std::array<std::uint8_t, 256> values{};
  for (int value = 0; value < 256; ++value) values[static_cast<std::size_t>(value)] = scaled_about(black, value, gain);
  return values;
}

Status Shading::build(const LightMap& map, std::uint16_t width_px, std::uint16_t height_px, ColorSpace space) {
  active_ = false;
  if (width_px == 0 || width_px > kMaxFrameWidth || height_px == 0 || height_px > kMaxFrameHeight) {
    return ErrorCode::kOutOfRange;
  }
  if (map.columns == 0) return {};
  if (!usable(map)) return ErrorCode::kOutOfRange;

  space_ = space;
  columns_ = (width_px + kTileWidth - 1u) / kTileWidth;
  rows_ = (height_px + kTileHeight - 1u) / kTileHeight;
  for (std::size_t row = 0; row < rows_; ++row) {
    const Blend v = blend_at(row, kTileHeight, height_px, map.rows);
    for (std::size_t column = 0; column < columns_; ++column) {
      const Blend u = blend_at(column, kTileWidth, width_px, map.columns);
      const std::size_t tile = row * columns_ + column;
      std::array<float, 3> light{};
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const auto& plane = map.illumination[channel];
        const auto along_u = [&](std::size_t map_row) {
          const float* cells = &plane[map_row * map.columns];
          return cells[u.low] + (cells[u.high] - cells[u.low]) * u.weight_of_high;
        };
        const float low = along_u(v.low);
        light[channel] = low + (along_u(v.high) - low) * v.weight_of_high;
      }
      if (is_yuv(space)) light.fill(0.299f * light[0] + 0.587f * light[1] + 0.114f * light[2]);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        level_[channel][tile] = level_of_gain(1.0f / light[channel]);
      }
    }
  }
  active_ = true;
  return {};
}

std::array<std::uint8_t, 3> Shading::levels(const LightChange& change, std::uint16_t column, std::uint16_t row,
                                            const std::array<float, 3>& brighter) const {
  const PixelPoint center = {(static_cast<float>(column) + 0.5f) * static_cast<float>(kTileWidth),
                             (static_cast<float>(row) + 0.5f) * static_cast<float>(kTileHeight)};
  const std::array<float, 3> since_map = change.at(center);
  std::array<std::uint8_t, 3> out{};
  for (std::size_t c = 0; c < 3; ++c) {
    const float all = brighter[c] + since_map[is_yuv(space_) ? 0 : c];
    const int changed = static_cast<int>(level(c, column, row)) - static_cast<int>(std::lround(all));
    out[c] = static_cast<std::uint8_t>(std::clamp(changed, 0, int{kLightLevels} - 1));
  }
  return out;
}

}  // namespace touchline
