#include "tests/benchmark/paper_scan.h"

#include <algorithm>

namespace touchline::testing {
namespace {

// A channel's samples in a row: that of pixel u is first[(u >> shared) * step].
struct ChannelRow {
  const std::uint8_t* first = nullptr;
  std::uint8_t shared = 0, step = 1;
  [[nodiscard]] std::uint8_t at(std::size_t u) const { return first[(u >> shared) * step]; }
};

std::array<ChannelRow, 3> channel_rows(const Frame& frame, std::size_t v) {
  const RowPixels row = row_pixels(frame, v);
  std::array<ChannelRow, 3> rows;
  for (std::size_t c = 0; c < rows.size(); ++c) {
    const ChannelLayout& channel = info_of(frame.format).channel[c];
    rows[c] = {row.plane[channel.plane] + channel.offset, channel.shift_u, channel.step};
  }
  return rows;
}

PaperScan::Found describe_list(const PixelList& list) {
  PaperScan::Found found;
  found.color = list.color;
  found.area_px = static_cast<std::uint32_t>(list.pixels.size());
  std::int64_t sum_u = 0, sum_v = 0;
  Pixel low = list.pixels.front(), high = low;
  for (const Pixel& pixel : list.pixels) {
    sum_u += pixel.u;
    sum_v += pixel.v;
    low = {std::min(low.u, pixel.u), std::min(low.v, pixel.v)};
    high = {std::max(high.u, pixel.u), std::max(high.v, pixel.v)};
  }
  found.centroid = {static_cast<float>(static_cast<double>(sum_u) / found.area_px),
                    static_cast<float>(static_cast<double>(sum_v) / found.area_px)};
  found.box = {static_cast<std::uint16_t>(low.u), static_cast<std::uint16_t>(low.v), static_cast<std::uint16_t>(high.u),
               static_cast<std::uint16_t>(high.v)};
  return found;
}

}  // namespace

Status PaperScan::configure(const ScanParameters& parameters) {
  if (parameters.light.columns > 0 || !parameters.region_of_interest.empty()) return ErrorCode::kUnsupported;
  grid_ = make_grid(parameters.width_px, parameters.height_px);
  return tables_.build(parameters.boxes, color_space(parameters.format));
}

void PaperScan::classify_row(const Frame& frame, int v) {
  const std::array<ChannelRow, 3> rows = channel_rows(frame, static_cast<std::size_t>(v));
  const ColorTables::Table& first = tables_.table(0, kNeutralLevel);
  const ColorTables::Table& second = tables_.table(1, kNeutralLevel);
  const ColorTables::Table& third = tables_.table(2, kNeutralLevel);
  ColorId* colors = &grid_.at(0, v);
  for (std::size_t u = 0; u < frame.width_px; ++u) {
    colors[u] = tables_.color_of(first[rows[0].at(u)] & second[rows[1].at(u)] & third[rows[2].at(u)]);
  }
}

const std::vector<PaperScan::Found>& PaperScan::scan(const Frame& frame) {
  for (int v = 0; v < grid_.height; ++v) classify_row(frame, v);
  found_.clear();
  for (const PixelList& list : labeling_.label(grid_)) {
    if (!list.pixels.empty()) found_.push_back(describe_list(list));
  }
  return found_;
}

}  // namespace touchline::testing
