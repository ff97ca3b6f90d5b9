#include "core/region/region_scanner.h"

#include <algorithm>

namespace touchline {

Status ScanTables::configure(const ScanParameters& parameters) {
  configured_ = false;
  if (Status s = classifier_.configure(parameters.format, parameters.width_px, parameters.height_px, parameters.boxes,
                                       parameters.light, parameters.kernel, parameters.box_room, parameters.background);
      !s.ok()) {
    return s;
  }
  if (Status s = region_of_interest_.build(parameters.region_of_interest, parameters.width_px, parameters.height_px);
      !s.ok()) {
    return s;
  }
  min_area_px_ = parameters.min_area_px;
  find_masks_ = row_masker(classifier_.kernel());
  run_writer_.configure(classifier_.kernel(), (std::size_t{parameters.width_px} + kPixelsOfWord - 1) / kPixelsOfWord);
  configured_ = true;
  return {};
}

Status RegionScanner::configure(const ScanParameters& parameters) {
  tables_ = &own_;
  rows_.fill({});
  return own_.configure(parameters);
}

Status RegionScanner::scan(const Frame& frame, Runs& runs, Regions& regions) {
  runs.clear();
  regions.clear();
  if (!tables_->configured_) return ErrorCode::kUnsupported;
  if (Status s = tables_->classifier_.accepts(frame); !s.ok()) return s;

  labeling_.begin(tables_->min_area_px_);
  budget_.begin(frame.height_px);
  rows_[1].colors.clear();  // above the first row
  for (std::uint16_t v = 0; v < frame.height_px; ++v) {
    classify(frame, v);
    if (v > 0) add_row(static_cast<std::uint16_t>(v - 1), rows_[v % 2u].masks, runs);
  }
  add_row(static_cast<std::uint16_t>(frame.height_px - 1), nothing_, runs);
  labeling_.finish(runs, regions);
  return runs.overflow() + regions.overflow() > 0 ? Status(ErrorCode::kFull) : Status();
}

void RegionScanner::classify(const Frame& frame, std::uint16_t v) {
  Row& row = rows_[v % 2u];
  ColorId* colors = row.colors.pixels();
  std::uint16_t done = 0;
  OccupiedWords occupied = 0;
  for (const ColumnSpan& span : tables_->region_of_interest_.row(v)) {
    std::fill(colors + done, colors + span.begin, kBackground);
    occupied |= tables_->classifier_.classify(frame, v, span.begin, span.end, colors);
    done = span.end;
  }
  std::fill(colors + done, colors + frame.width_px, kBackground);
  tables_->find_masks_(row.colors, rows_[(v + 1u) % 2].colors, occupied, row.masks);
}

void RegionScanner::add_row(std::uint16_t v, const RowMasks& below, Runs& runs) {
  Row& row = rows_[v % 2u];
  if (row.masks.occupied == 0) {
    budget_.spend(0);
    return;
  }
  if (tables_->min_area_px_ > 1) forget_specks(below, row.masks);
  const std::size_t first = runs.size();
  const std::size_t count = tables_->run_writer_.count(row.masks), limit = budget_.limit(count);
  std::size_t written = 0;
  if (count <= limit) {
    written = tables_->run_writer_.write_all(row.masks, row.colors, v, runs.data() + first);
  } else {
    written = tables_->run_writer_.write_longest(row.masks, row.colors, v, limit, runs.data() + first);
    runs.refuse(count - written);
  }
  budget_.spend(written);
  runs.resize(first + written);
  labeling_.add_row(runs, first);
}

}  // namespace touchline
