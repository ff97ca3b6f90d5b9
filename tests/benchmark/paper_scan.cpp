#include "tests/benchmark/paper_scan.h"

#include <algorithm>
#include <utility>

namespace touchline::testing {
namespace {

// Classifies a row. The format is a template constant, as in a program written for one camera.
template <PixelFormat kFormat>
void classify_row(const ColorTables& tables, const Frame& frame, std::size_t v, ColorId* colors) {
  static constexpr std::array kChannel = info_of(kFormat).channel;
  const RowPixels row = row_pixels(frame, v);
  const std::uint8_t* const first_row = row.plane[kChannel[0].plane];
  const std::uint8_t* const second_row = row.plane[kChannel[1].plane];
  const std::uint8_t* const third_row = row.plane[kChannel[2].plane];
  const ColorTables::Table& first = tables.table(0, kNeutralLevel);
  const ColorTables::Table& second = tables.table(1, kNeutralLevel);
  const ColorTables::Table& third = tables.table(2, kNeutralLevel);
  for (std::size_t u = 0; u < frame.width_px; ++u) {
    colors[u] = tables.color_of(first[first_row[kChannel[0].byte(u)]] & second[second_row[kChannel[1].byte(u)]] &
                                third[third_row[kChannel[2].byte(u)]]);
  }
}

template <std::size_t... kIndex>
void classify_row(std::index_sequence<kIndex...> /*formats*/, const ColorTables& tables, const Frame& frame,
                  std::size_t v, ColorId* colors) {
  static_cast<void>(((frame.format == kPixelFormatTable[kIndex].format &&
                      (classify_row<kPixelFormatTable[kIndex].format>(tables, frame, v, colors), true)) ||
                     ...));
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

const std::vector<PaperScan::Found>& PaperScan::scan(const Frame& frame) {
  for (int v = 0; v < grid_.height; ++v) {
    classify_row(std::make_index_sequence<kPixelFormatTable.size()>(), tables_, frame, static_cast<std::size_t>(v),
                 &grid_.at(0, v));
  }
  found_.clear();
  for (const PixelList& list : labeling_.label(grid_)) {
    if (!list.pixels.empty()) found_.push_back(describe_list(list));
  }
  return found_;
}

}  // namespace touchline::testing
