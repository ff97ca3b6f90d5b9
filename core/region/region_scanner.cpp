#include "core/region/region_scanner.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

namespace touchline {
namespace {

// Number of rows by which fetching is ahead of classification. Classifying a row takes longer than a fetch from memory.
constexpr unsigned kRowsAhead = 2;

// Fetches bytes begin <= i < end into the cache before they are read. A processor prefetches consecutive bytes by
// itself, but must detect the pattern again after the end of a span.
void fetch(const std::uint8_t* bytes, std::size_t begin, std::size_t end) {
  constexpr std::size_t kLine = 64, kLinesAtOnce = 4;  // bytes of a cache line on x86 and ARM
  asm volatile("");  // without this statement, gcc drops calls of functions that only prefetch
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

// Returns the words of `among` that contain a color. Kernels may also list words without one.
OccupiedWords colored_words(const ColorRow& row, OccupiedWords among) {
  OccupiedWords colored = 0;
  for (; among != 0; among &= among - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(among));
    std::array<WordPair, kPixelsOfWord / sizeof(WordPair)> pixels;
    std::memcpy(pixels.data(), row.pixels() + i * kPixelsOfWord, sizeof pixels);
    const WordPair any = (pixels[0] | pixels[1]) | (pixels[2] | pixels[3]);
    colored |= OccupiedWords{(any[0] | any[1]) != 0} << i;
  }
  return colored;
}

void clear_words(OccupiedWords words, ColorRow& row) {
  for (; words != 0; words &= words - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(words));
    std::fill_n(row.pixels() + i * kPixelsOfWord, kPixelsOfWord, kBackground);
  }
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
  min_height_px_ = parameters.min_height_px;
  for (std::size_t plane = 0; plane < kMaxPlanes; ++plane) {
    bytes_of_eight_px_[plane] = row_bytes(parameters.format, plane, 8);
  }
  run_writer_.configure((std::size_t{parameters.width_px} + kPixelsOfWord - 1) / kPixelsOfWord);
  configured_ = true;
  return {};
}

Status RegionScanner::configure(const ScanParameters& parameters) {
  tables_ = &own_;
  colors_.fill({});
  occupied_.fill(0);
  masks_.fill({});
  return own_.configure(parameters);
}

Status RegionScanner::scan(const Frame& frame, Runs& runs, Regions& regions) {
  runs.clear();
  regions.clear();
  if (Status s = accepts(frame); !s.ok()) return s;

  labeling_.begin(tables_->min_area_px_, tables_->min_height_px_);
  run_limiter_.begin(frame.height_px);
  const std::uint16_t last = static_cast<std::uint16_t>(frame.height_px - 1);
  clear(2);  // Row 2 of the ring stands for the row above the first one.
  masks_[2] = {};
  classify(frame, 0);
  find_masks(0);
  std::uint16_t classified = 0;
  for (std::uint16_t v = 0; v < last; ++v) {
    if (v == classified) classified = classify_next(frame, v);
    find_masks(static_cast<std::uint16_t>(v + 1));
    add_row(v, runs);
  }
  masks_[(last + 1u) % 3] = {};
  add_row(last, runs);
  labeling_.finish(runs, regions);
  return runs.overflow() + regions.overflow() > 0 ? Status(ErrorCode::kFull) : Status();
}

// Classifies one or two more rows after row v. Returns the last of them.
std::uint16_t RegionScanner::classify_next(const Frame& frame, std::uint16_t v) {
  const auto below = static_cast<std::uint16_t>(v + 1);
  if (tables_->min_height_px_ < 2 || below + 1u >= frame.height_px) {
    classify(frame, below);
    return below;
  }
  const auto next = static_cast<std::uint16_t>(v + 2);
  classify(frame, next);
  classify_between(frame, below);
  return next;
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

// Makes row v background and erases an earlier row's colors.
void RegionScanner::clear(std::uint16_t v) { clear_words(std::exchange(occupied_[v % 3u], 0), colors_[v % 3u]); }

void RegionScanner::classify(const Frame& frame, std::uint16_t v) {
  if (v + kRowsAhead < frame.height_px) fetch_row(frame, static_cast<std::uint16_t>(v + kRowsAhead));
  clear(v);
  ColorRow& colors = colors_[v % 3u];
  OccupiedWords occupied = 0;
  for (const ColumnSpan& span : tables_->region_of_interest_.row(v)) {
    occupied |= tables_->classifier_.classify(frame, v, span.begin, span.end, colors.pixels());
  }
  // Without words that contain no color, classify_between() reads as little of the neighboring rows as possible.
  occupied_[v % 3u] = tables_->min_height_px_ > 1 ? colored_words(colors, occupied) : occupied;
}

// Classifies the words of row v in which the row above or below has a color, and the next words as long as colors reach
// into them. Pixels that are left out could only form regions one row high.
void RegionScanner::classify_between(const Frame& frame, std::uint16_t v) {
  clear(v);
  OccupiedWords added = occupied_[(v + 2u) % 3] | occupied_[(v + 1u) % 3], words = added;
  while (added != 0) {
    added = classify_words(frame, v, added) & ~words;
    words |= added;
  }
}

// Classifies `words` of row v. Returns the neighboring words in which a color may continue: the pixel at the common
// border has a color.
OccupiedWords RegionScanner::classify_words(const Frame& frame, std::uint16_t v, OccupiedWords words) {
  constexpr std::uint32_t kPixels = kPixelsOfWord;
  ColorId* colors = colors_[v % 3u].pixels();
  OccupiedWords beside = 0;
  while (words != 0) {
    const auto first = static_cast<std::uint32_t>(std::countr_zero(words));
    const std::uint32_t end = first + static_cast<std::uint32_t>(std::countr_one(words >> first));
    words &= words + (OccupiedWords{1} << first);  // without the lowest group of ones
    const std::uint32_t left = first * kPixels, right = std::min<std::uint32_t>(end * kPixels, frame.width_px);
    for (const ColumnSpan& span : tables_->region_of_interest_.row(v)) {
      const auto span_begin = static_cast<std::uint16_t>(std::max<std::uint32_t>(left, span.begin));
      const auto span_end = static_cast<std::uint16_t>(std::min<std::uint32_t>(right, span.end));
      if (span_begin >= span_end) continue;
      occupied_[v % 3u] |= tables_->classifier_.classify(frame, v, span_begin, span_end, colors);
    }
    if (first > 0) beside |= OccupiedWords{colors[left] != kBackground} << (first - 1);
    if (right < frame.width_px) beside |= OccupiedWords{colors[right - 1] != kBackground} << end;
  }
  return beside;
}

void RegionScanner::find_masks(std::uint16_t v) {
  const std::size_t here = v % 3u;
  fill_masks(colors_[here], colors_[(v + 2u) % 3], occupied_[here], masks_[here]);
}

void RegionScanner::add_row(std::uint16_t v, Runs& runs) {
  RowMasks& masks = masks_[v % 3u];
  if (masks.occupied == 0) {
    run_limiter_.spend(0);
    return;
  }
  if (tables_->min_area_px_ > 1) remove_isolated_pixels(masks_[(v + 1u) % 3], masks);
  const std::size_t first = runs.size();
  const RowMasks& above = masks_[(v + 2u) % 3];
  std::size_t count = tables_->run_writer_.count(masks);
  if (const std::size_t found = count, limit = run_limiter_.limit(found); found > limit) {
    count = tables_->run_writer_.cut(masks, limit);
    runs.add_overflow(found - count);
  }
  run_limiter_.spend(count);
  tables_->run_writer_.write(masks, colors_[v % 3u], v, runs.data() + first);
  runs.resize(first + count);
  if (masks.is_cut || above.is_cut) {
    const std::size_t first_above = labeling_.last_row();
    tables_->run_writer_.find_cut_runs(
        above, masks, {runs.data() + first_above, first - first_above}, {runs.data() + first, count},
        [&](std::size_t k) { labeling_.mark_cut(first_above + k); },
        [&](std::size_t k) { labeling_.mark_cut(first + k); });
  }
  labeling_.add_row(runs, first, tables_->run_writer_.find_contacts(above, masks));
}

}  // namespace touchline
