#include "core/region/region_scanner.h"

#include <algorithm>

namespace touchline {

Status RegionScanner::configure(const ScanParameters& parameters) {
  configured_ = false;
  if (Status s = classifier_.configure(parameters.format, parameters.width_px, parameters.height_px, parameters.boxes,
                                       parameters.light, parameters.kernel, parameters.box_room);
      !s.ok()) {
    return s;
  }
  if (Status s = region_of_interest_.build(parameters.region_of_interest, parameters.width_px, parameters.height_px);
      !s.ok()) {
    return s;
  }
  min_area_px_ = parameters.min_area_px;
  configured_ = true;
  return {};
}

Status RegionScanner::scan(const Frame& frame, Runs& runs, Regions& regions) {
  runs.clear();
  regions.clear();
  if (!configured_) return ErrorCode::kUnsupported;
  if (Status s = classifier_.accepts(frame); !s.ok()) return s;

  labeling_.begin(min_area_px_);
  for (std::uint16_t v = 0; v < frame.height_px; ++v) {
    if (!labeling_.make_room(runs, frame.width_px, v)) {
      labeling_.finish_before(v, runs, regions);
      count_rows_from(frame, v, runs);
      return ErrorCode::kFull;
    }
    const std::size_t first = runs.size();
    runs.resize(first + extract_row(frame, v, runs.data() + first));
    labeling_.add_row(runs, first);
  }
  labeling_.finish(runs, regions);
  return regions.overflow() > 0 ? Status(ErrorCode::kFull) : Status();
}

std::size_t RegionScanner::extract_row(const Frame& frame, std::uint16_t v, Run* out) {
  std::size_t count = 0;
  for (const ColumnSpan& span : region_of_interest_.row(v)) {
    classifier_.classify(frame, v, span.begin, span.end, colors_.data());
    std::fill_n(colors_.begin() + span.end, kColorRowPadding, kBackground);
    count += extract_runs(colors_.data(), span.begin, span.end, v, out + count);
  }
  return count;
}

void RegionScanner::count_rows_from(const Frame& frame, std::uint16_t v, Runs& runs) {
  for (; v < frame.height_px; ++v) {
    for (const ColumnSpan& span : region_of_interest_.row(v)) {
      classifier_.classify(frame, v, span.begin, span.end, colors_.data());
      runs.refuse(count_runs(colors_.data(), span.begin, span.end));
    }
  }
}

}  // namespace touchline
