#pragma once

#include <array>
#include <cstdint>

#include "core/color/background_box.h"
#include "core/color/color_tables.h"
#include "core/color/nibble_tables.h"
#include "core/color/span_kernel.h"
#include "core/light/field_light.h"
#include "core/light/shading.h"
#include "core/types.h"

namespace touchline {

/// Classifies pixels by color, one row at a time, in the camera's format, with or without shading correction.
class RowClassifier {
 public:
  /// `box_shift_limit`: levels by which boxes may move later. The typical background affects only the speed.
  /// kOutOfRange: as ColorTables::build and Shading::build. kUnsupported: this processor lacks the kernel's
  /// instructions. After an error no frame is accepted.
  Status configure(PixelFormat format, std::uint16_t width_px, std::uint16_t height_px, const ColorBoxes& boxes,
                   const LightMap& light, KernelChoice kernel = KernelChoice::kFastest,
                   std::uint8_t box_shift_limit = 0, const TypicalBackground& background = {});

  /// apply_light_change() sets one row of tiles to the sum of both changes of light (no effect without a light map).
  /// rebuild_tables() rebuilds the tables of one channel and light level (ColorTables::rebuild). Call both between two
  /// frames, a part per frame to bound the time. When a box first moves by more than a few levels, all tiles are
  /// updated once.
  void apply_light_change(const LightChange& change, const FieldLight& field, std::uint16_t tile_row);
  void rebuild_tables(const ColorBoxes& boxes, std::size_t channel, std::uint8_t level);

  /// kUnsupported: the format or size differs from the configured one, or nothing is configured. kShortFrame: a plane
  /// is missing, or its stride is smaller than a row.
  [[nodiscard]] Status accepts(const Frame& frame) const;

  /// Writes colors[u] for the columns begin <= u < end of row v. The frame must have been accepted and contain v and
  /// end. Returns the words of 64 columns that may contain a color; the pixels in all other words are background.
  OccupiedWords classify(const Frame& frame, std::uint16_t v, std::uint16_t begin, std::uint16_t end,
                         ColorId* colors) const;

  [[nodiscard]] const ColorTables& tables() const { return tables_; }
  [[nodiscard]] const Shading& shading() const { return shading_; }
  /// Returns the light levels that a tile uses (tiles row by row), by channel. Without a light map, only tile 0 exists.
  [[nodiscard]] std::array<std::uint8_t, 3> levels_of_tile(std::size_t tile) const {
    const auto& level = tiles_[tile].level;
    return {level[0], level[1], level[2]};
  }

 private:
  // Updates a row of tiles. `change` null: the light has not changed since the light map was made.
  void update_tiles(std::uint16_t tile_row, const LightChange* change, const FieldLight* field);
  // Finds the background of a row's tiles at their light levels.
  void find_background(std::uint16_t tile_row);

  SpanKernel kernel_ = nullptr;
  PixelFormat format_ = PixelFormat::kRgb24;
  std::uint16_t width_px_ = 0, height_px_ = 0;
  ColorTables tables_;
  NibbleTables nibbles_;
  Shading shading_;
  // Background ranges for boxes at their largest shift, and for boxes near their calibration, which leave a larger
  // background.
  BackgroundRanges background_, near_background_;
  bool are_boxes_near_ = false;                     // all boxes have stayed near their calibration since configure()
  std::array<TileParameters, kMaxTiles> tiles_{};   // without a light map, entry 0 applies to all columns
  std::array<bool, kMaxTileRows> has_one_light_{};  // all tiles of the row are equal
  ColorBoxes boxes_;                                // calibrated boxes
  std::array<bool, kMaxTileRows> has_pale_{};       // without a light map, entry 0 applies to all rows
  std::array<TileParameters, kMaxTileRows> pale_{};
};

}  // namespace touchline
