#include "core/color/row_classifier.h"

#include <algorithm>

namespace touchline {

// Largest shift, in levels, at which a box counts as near its calibration. With much larger shifts, boxes on both sides
// of gray can leave no gap for the background.
static constexpr std::uint8_t kNearShift = 4;

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
  near_background_.build(format, boxes, std::min(box_shift_limit, kNearShift), background);
  boxes_ = boxes;
  are_boxes_near_ = true;
  tiles_[0].level = {kNeutralLevel, kNeutralLevel, kNeutralLevel};
  find_background(0);
  for (std::uint16_t row = 0; shading_.active() && row < shading_.rows(); ++row) update_tiles(row, nullptr, nullptr);
  nibbles_.build(tables_, boxes.size());
  kernel_ = find_span_kernel(format, kernel);
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
    tiles[column].level = {level[0], level[1], level[2]};
  }
  find_background(tile_row);
}

void RowClassifier::find_background(std::uint16_t tile_row) {
  const BackgroundRanges& ranges = are_boxes_near_ ? near_background_ : background_;
  const std::size_t columns = shading_.active() ? shading_.columns() : 1, first = tile_row * columns;
  const std::span<TileParameters> tiles(&tiles_[first], columns);
  for (std::size_t i = 0; i < columns; ++i) tiles[i] = ranges.of(levels_of_tile(first + i));
  has_one_light_[tile_row] =
      std::all_of(tiles.begin(), tiles.end(), [&](const TileParameters& tile) { return tile == tiles.front(); });
  has_pale_[tile_row] = ranges.find_pale(tiles, pale_[tile_row]);
}

void RowClassifier::apply_light_change(const LightChange& change, const FieldLight& field, std::uint16_t tile_row) {
  if (!shading_.active()) return;
  update_tiles(tile_row, &change, &field);
}

void RowClassifier::rebuild_tables(const ColorBoxes& boxes, std::size_t channel, std::uint8_t level) {
  // Boxes that move back do not count as near again, because tables of other levels may not have been rebuilt yet.
  if (are_boxes_near_ && !have_moved_within(kNearShift, boxes, boxes_)) {
    are_boxes_near_ = false;
    const std::uint16_t rows = shading_.active() ? shading_.rows() : 1;
    for (std::uint16_t row = 0; row < rows; ++row) find_background(row);
  }
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
  const BackgroundRanges& background = are_boxes_near_ ? near_background_ : background_;
  const SpanTables tables = {&tables_,
                             &nibbles_,
                             &tiles_[first_tile],
                             !shading_.active(),
                             background.exist(),
                             background.begin_at_zero(),
                             has_one_light,
                             has_pale_[tile_row] ? &pale_[tile_row] : nullptr};
  return kernel_(tables, row, begin, end, colors);
}

}  // namespace touchline
