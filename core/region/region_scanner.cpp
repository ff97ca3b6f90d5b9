#include "core/region/region_scanner.h"

#include <algorithm>

namespace touchline {

namespace {

// How far ahead pixels are fetched. A row takes longer to classify than memory takes to answer.
constexpr unsigned kRowsAhead = 2;

// Fetches bytes begin <= i < end, so that they are in the cache when they are read. A processor does that by itself for
// what follows in memory, but begins anew where a span ends.
void fetch(const std::uint8_t* bytes, std::size_t begin, std::size_t end) {
  constexpr std::size_t kLine = 64, kLinesAtOnce = 4;  // a cache line of x86 and ARM
  asm volatile("");  // gcc takes functions that only fetch for ones without effect, and drops the calls
  std::size_t i = begin;
  for (; i + kLinesAtOnce * kLine <= end; i += kLinesAtOnce * kLine) {
    __builtin_prefetch(bytes + i);
    __builtin_prefetch(bytes + i + kLine);
    __builtin_prefetch(bytes + i + 2 * kLine);
    __builtin_prefetch(bytes + i + 3 * kLine);
  }
  for (; i < end; i += kLine) __builtin_prefetch(bytes + i);
  __builtin_prefetch(bytes + end - 1);
}

}  // namespace

Status ScanTables::configure(const ScanParameters& parameters) {
  configured_ = false;
  if (Status s =
          classifier_.configure(parameters.format, parameters.width_px, parameters.height_px, parameters.boxes,
                                parameters.light, parameters.kernel, parameters.box_shift_limit, parameters.background);
      !s.ok()) {
    return s;
  }
  if (Status s = region_of_interest_.build(parameters.region_of_interest, parameters.width_px, parameters.height_px);
      !s.ok()) {
    return s;
  }
  min_area_px_ = parameters.min_area_px;
  for (std::size_t plane = 0; plane < kMaxPlanes; ++plane) {
    bytes_of_eight_px_[plane] = row_bytes(parameters.format, plane, 8);
  }
  find_masks_ = row_mask_kernel(classifier_.kernel());
  run_writer_.configure(classifier_.kernel(), (std::size_t{parameters.width_px} + kPixelsOfWord - 1) / kPixelsOfWord);
  configured_ = true;
  return {};
}

Status RegionScanner::configure(const ScanParameters& parameters) {
  tables_ = &own_;
  colors_.fill({});
  masks_.fill({});
  return own_.configure(parameters);
}

Status RegionScanner::scan(const Frame& frame, Runs& runs, Regions& regions) {
  runs.clear();
  regions.clear();
  if (Status s = accepts(frame); !s.ok()) return s;

  labeling_.begin(tables_->min_area_px_);
  run_limiter_.begin(frame.height_px);
  const std::uint16_t last = static_cast<std::uint16_t>(frame.height_px - 1);
  colors_[1].clear();  // above the first row
  masks_[2] = {};
  classify(frame, 0);
  for (std::uint16_t v = 0; v < last; ++v) {
    classify(frame, static_cast<std::uint16_t>(v + 1));
    add_row(v, runs);
  }
  masks_[(last + 1u) % 3] = {};
  add_row(last, runs);
  labeling_.finish(runs, regions);
  return runs.overflow() + regions.overflow() > 0 ? Status(ErrorCode::kFull) : Status();
}

void RegionScanner::fetch_row(const Frame& frame, std::uint16_t v) const {
  const RowPixels row = row_pixels(frame, v);
  for (std::size_t plane = 0; plane < info_of(frame.format).planes; ++plane) {
    const std::size_t bytes = tables_->bytes_of_eight_px_[plane];
    for (const ColumnSpan& span : tables_->region_of_interest_.row(v)) {
      fetch(row.plane[plane], span.begin * bytes / 8, (span.end * bytes + 7) / 8);
    }
  }
}

void RegionScanner::classify(const Frame& frame, std::uint16_t v) {
  if (v + kRowsAhead < frame.height_px) fetch_row(frame, static_cast<std::uint16_t>(v + kRowsAhead));
  ColorRow& row = colors_[v % 2u];
  ColorId* colors = row.pixels();
  std::uint16_t done = 0;
  OccupiedWords occupied = 0;
  for (const ColumnSpan& span : tables_->region_of_interest_.row(v)) {
    std::fill(colors + done, colors + span.begin, kBackground);
    occupied |= tables_->classifier_.classify(frame, v, span.begin, span.end, colors);
    done = span.end;
  }
  std::fill(colors + done, colors + frame.width_px, kBackground);
  tables_->find_masks_(row, colors_[(v + 1u) % 2], occupied, masks_[v % 3u]);
}

void RegionScanner::add_row(std::uint16_t v, Runs& runs) {
  RowMasks& masks = masks_[v % 3u];
  if (masks.occupied == 0) {
    run_limiter_.spend(0);
    return;
  }
  if (tables_->min_area_px_ > 1) remove_isolated_pixels(masks_[(v + 1u) % 3], masks);
  const std::size_t first = runs.size();
  std::size_t count = tables_->run_writer_.count(masks);
  if (const std::size_t found = count, limit = run_limiter_.limit(found); found > limit) {
    count = tables_->run_writer_.cut(masks, limit);
    runs.add_overflow(found - count);
  }
  run_limiter_.spend(count);
  tables_->run_writer_.write(masks, colors_[v % 2u], v, runs.data() + first);
  runs.resize(first + count);
  labeling_.add_row(runs, first, tables_->run_writer_.find_contacts(masks_[(v + 2u) % 3], masks));
}

}  // namespace touchline
