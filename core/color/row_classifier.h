#pragma once

#include <array>
#include <cstdint>

#include "core/color/background_box.h"
#include "core/color/color_tables.h"
#include "core/color/nibble_tables.h"
#include "core/color/span_kernel.h"
#include "core/light/shading.h"
#include "core/types.h"

namespace touchline {

/// Pixels -> colors, one row at a time, in the format in which they arrive; with or without shading correction.
class RowClassifier {
 public:
  /// Boxes may be moved later by up to `box_shift_limit` levels. The typical background decides nothing but the speed.
  /// kOutOfRange: as ColorTables::build and Shading::build; kUnsupported: this processor has no such kernel. After an
  /// error no frame is accepted.
  Status configure(PixelFormat format, std::uint16_t width_px, std::uint16_t height_px, const ColorBoxes& boxes,
                   const LightMap& light, KernelChoice kernel = KernelChoice::kFastest,
                   std::uint8_t box_shift_limit = 0, const TypicalBackground& background = {});

  /// Between two frames, a part at a time so that none takes long: the light of a row of tiles
  /// (Shading::level; no effect without a light map), and the boxes of one channel and light level
  /// (ColorTables::rebuild).
  void apply_light_change(const LightChange& change, std::uint16_t tile_row);
  void rebuild_tables(const ColorBoxes& boxes, std::size_t channel, std::uint8_t level);

  /// kUnsupported: another format or size than configured, or not configured. kShortFrame: a plane is missing, or its
  /// stride is smaller than a row.
  [[nodiscard]] Status accepts(const Frame& frame) const;

  /// Writes colors[u] for begin <= u < end, the columns of row v. The frame has been accepted, v and end are in it.
  /// Returns which words of 64 columns may hold a color: all of the others is background.
  OccupiedWords classify(const Frame& frame, std::uint16_t v, std::uint16_t begin, std::uint16_t end,
                         ColorId* colors) const;

  /// Never kFastest once configured.
  [[nodiscard]] KernelChoice kernel() const { return choice_; }
  [[nodiscard]] const ColorTables& tables() const { return tables_; }
  [[nodiscard]] const Shading& shading() const { return shading_; }

 private:
  void find_tiles(std::uint16_t tile_row, const LightChange* change);  // null: as the light map says

  SpanKernel kernel_ = nullptr;
  KernelChoice choice_ = KernelChoice::kFastest;
  PixelFormat format_ = PixelFormat::kRgb24;
  std::uint16_t width_px_ = 0, height_px_ = 0;
  ColorTables tables_;
  NibbleTables nibbles_;
  Shading shading_;
  BackgroundRanges background_;
  std::array<TileParameters, kMaxTiles> tiles_{};  // without a light map the first holds for all
};

}  // namespace touchline
