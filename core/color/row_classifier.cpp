#include "core/color/row_classifier.h"

#include <algorithm>

namespace touchline {

Status RowClassifier::configure(PixelFormat format, std::uint16_t width_px, std::uint16_t height_px,
                                const ColorBoxes& boxes, const LightMap& light, KernelChoice kernel,
                                std::uint8_t box_shift_limit, const TypicalBackground& background) {
  kernel_ = nullptr;
  if (Status s = tables_.build(boxes, color_space(format)); !s.ok()) return s;
  if (Status s = shading_.build(light, width_px, height_px, color_space(format)); !s.ok()) return s;
  format_ = format;
  width_px_ = width_px;
  height_px_ = height_px;
  background_.build(format, boxes, box_shift_limit, background);
  boxes_ = boxes;
  is_pale_valid_ = true;
  tiles_[0] = background_.of({kNeutralLevel, kNeutralLevel, kNeutralLevel});
  has_pale_[0] = background_.find_pale({tiles_.data(), 1}, pale_[0]);
  for (std::uint16_t row = 0; shading_.active() && row < shading_.rows(); ++row) update_tiles(row, nullptr, nullptr);
  nibbles_.build(tables_, boxes.size());
  choice_ = kernel;
  kernel_ = find_span_kernel(format, choice_);
  return kernel_ == nullptr ? ErrorCode::kUnsupported : Status();
}

void RowClassifier::update_tiles(std::uint16_t tile_row, const LightChange* change, const FieldLight* field) {
  TileParameters* tiles = &tiles_[std::size_t{tile_row} * shading_.columns()];
  for (std::uint16_t column = 0; column < shading_.columns(); ++column) {
    std::array<std::uint8_t, 3> level{};
    if (change != nullptr) {
      level = shading_.levels(*change, column, tile_row, field->at(column, tile_row));
    } else {
      for (std::size_t c = 0; c < 3; ++c) level[c] = shading_.level(c, column, tile_row);
    }
    tiles[column] = background_.of(level);
  }
  has_one_light_[tile_row] =
      std::all_of(tiles, tiles + shading_.columns(), [&](const TileParameters& tile) { return tile == *tiles; });
  has_pale_[tile_row] = background_.find_pale({tiles, shading_.columns()}, pale_[tile_row]);
}

void RowClassifier::apply_light_change(const LightChange& change, const FieldLight& field, std::uint16_t tile_row) {
  if (!shading_.active()) return;
  update_tiles(tile_row, &change, &field);
}

void RowClassifier::rebuild_tables(const ColorBoxes& boxes, std::size_t channel, std::uint8_t level) {
  // Tables of other levels may keep such a box after this one has moved back.
  if (!is_pale_box_valid(boxes, boxes_)) is_pale_valid_ = false;
  tables_.rebuild(boxes, channel, level);
  nibbles_.rebuild(tables_, boxes.size(), channel, level);
}

Status RowClassifier::accepts(const Frame& frame) const {
  if (kernel_ == nullptr || frame.format != format_ || frame.width_px != width_px_ || frame.height_px != height_px_) {
    return ErrorCode::kUnsupported;
  }
  for (std::size_t plane = 0; plane < frame.plane.size(); ++plane) {
    const std::size_t needed = row_bytes(format_, plane, width_px_);
    if (needed > 0 && (frame.plane[plane] == nullptr || frame.stride_bytes[plane] < needed)) {
      return ErrorCode::kShortFrame;
    }
  }
  return {};
}

OccupiedWords RowClassifier::classify(const Frame& frame, std::uint16_t v, std::uint16_t begin, std::uint16_t end,
                                      ColorId* colors) const {
  const RowPixels row = row_pixels(frame, v);

  const std::size_t tile_row = shading_.active() ? v / kTileHeight : 0, first_tile = tile_row * shading_.columns();
  const bool has_one_light = shading_.active() && has_one_light_[tile_row];
  const SpanTables tables = {&tables_,
                             &nibbles_,
                             &tiles_[first_tile],
                             !shading_.active(),
                             background_.exist(),
                             background_.begin_at_zero(),
                             has_one_light,
                             is_pale_valid_ && has_pale_[tile_row] ? &pale_[tile_row] : nullptr};
  return kernel_(tables, row, begin, end, colors);
}

}  // namespace touchline
