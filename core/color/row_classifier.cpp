#include "core/color/row_classifier.h"

#include <algorithm>

namespace touchline {
namespace {

constexpr std::array<std::uint8_t, 3> kNeutral = {kNeutralLevel, kNeutralLevel, kNeutralLevel};

}  // namespace

std::size_t row_bytes(PixelFormat format, std::size_t plane, std::uint16_t width_px) {
  const std::size_t whole_pairs = (std::size_t{width_px} + 1) / 2 * 2;
  if (plane > 0) return plane == 1 && format == PixelFormat::kNv12 ? whole_pairs : 0;
  if (color_space(format) == ColorSpace::kRgb) return std::size_t{width_px} * 3;
  return format == PixelFormat::kNv12 ? width_px : whole_pairs * 2;
}

Status RowClassifier::configure(PixelFormat format, std::uint16_t width_px, std::uint16_t height_px,
                                const ColorBoxes& boxes, const LightMap& light, KernelChoice kernel,
                                std::uint8_t box_room) {
  kernel_ = nullptr;
  if (Status s = tables_.build(boxes, color_space(format)); !s.ok()) return s;
  if (Status s = shading_.build(light, width_px, height_px, color_space(format)); !s.ok()) return s;
  format_ = format;
  width_px_ = width_px;
  height_px_ = height_px;
  find_floors(boxes, box_room);
  digits_.build(tables_, boxes.size());
  kernel_ = kernel == KernelChoice::kFastest ? avx2_kernel(format) : nullptr;
  if (kernel_ == nullptr) kernel_ = scalar_kernel(format);
  return {};
}

void RowClassifier::find_floors(const ColorBoxes& boxes, std::uint8_t box_room) {
  ColorBoxes lowest = boxes;
  for (ColorBox& box : lowest) {
    for (std::uint8_t& low : box.low)
      low = low > box_room ? static_cast<std::uint8_t>(low - box_room) : std::uint8_t{0};
  }
  const ChannelFloors floors = floors_of(lowest);
  if (!shading_.active()) {
    floors_.fill(BackgroundFloor(format_, floors));
    return;
  }
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const std::uint8_t unlit = unlit_value(color_space(format_), channel);
    for (std::uint8_t level = 0; level < kLightLevels; ++level) {
      floor_before_[channel][level] = floor_before_correction(floors[channel], level, unlit);
    }
  }
  for (std::size_t row = 0; row < shading_.rows(); ++row) find_floor(row);
}

void RowClassifier::find_floor(std::size_t tile_row) {
  ChannelFloors lowest = {256, 256, 256};
  for (std::uint16_t column = 0; column < shading_.columns(); ++column) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const std::uint8_t level = shading_.level(channel, column, static_cast<std::uint16_t>(tile_row));
      lowest[channel] = std::min(lowest[channel], floor_before_[channel][level]);
    }
  }
  floors_[tile_row] = BackgroundFloor(format_, lowest);
}

void RowClassifier::follow_light(const LightChange& change, std::uint16_t tile_row) {
  if (!shading_.active()) return;
  shading_.follow(change, tile_row);
  find_floor(tile_row);
}

void RowClassifier::move_boxes(const ColorBoxes& boxes, std::size_t channel, std::uint8_t level) {
  tables_.rebuild(boxes, channel, level);
  digits_.rebuild(tables_, boxes.size(), channel, level);
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

SpanTables RowClassifier::tables_at(const std::array<std::uint8_t, 3>& level, std::size_t tile_row) const {
  return {{&tables_.table(0, level[0]), &tables_.table(1, level[1]), &tables_.table(2, level[2])},
          &tables_.color_of_bit(),
          &floors_[tile_row],
          {&digits_.channel(0, level[0]), &digits_.channel(1, level[1]), &digits_.channel(2, level[2])},
          &digits_.colors(),
          digits_.groups()};
}

void RowClassifier::classify(const Frame& frame, std::uint16_t v, std::uint16_t begin, std::uint16_t end,
                             ColorId* colors) const {
  RowPixels row;
  row.samples = frame.plane[0] + std::size_t{v} * frame.stride_bytes[0];
  if (format_ == PixelFormat::kNv12) row.chroma = frame.plane[1] + std::size_t{v / 2u} * frame.stride_bytes[1];

  const std::uint16_t tile_row = v / kTileHeight;
  if (!shading_.active()) {
    kernel_(tables_at(kNeutral, tile_row), row, begin, end, colors);
    return;
  }
  const auto level_of_tile = [&](std::uint16_t tile) {
    return std::array{shading_.level(0, tile, tile_row), shading_.level(1, tile, tile_row),
                      shading_.level(2, tile, tile_row)};
  };
  // Neighboring tiles of one level are one span.
  for (std::uint32_t u = begin; u < end;) {
    const auto tile = static_cast<std::uint16_t>(u / kTileWidth);
    const std::uint32_t span_end =
        std::min<std::uint32_t>(end, std::uint32_t{shading_.span_end(tile, tile_row)} * kTileWidth);
    kernel_(tables_at(level_of_tile(tile), tile_row), row, u, span_end, colors);
    u = span_end;
  }
}

}  // namespace touchline
