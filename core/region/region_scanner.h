#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "core/color/color_tables.h"
#include "core/color/row_classifier.h"
#include "core/light/light_map.h"
#include "core/region/labeling.h"
#include "core/region/region_of_interest.h"
#include "core/region/row_masks.h"
#include "core/region/row_runs.h"
#include "core/region/run_budget.h"
#include "core/types.h"

namespace touchline {

struct ScanParameters {
  PixelFormat format = PixelFormat::kRgb24;
  std::uint16_t width_px = 0, height_px = 0;
  ColorBoxes boxes;               // in the format's color space
  LightMap light;                 // columns 0: none
  Polygon region_of_interest;     // pixel centers inside count; fewer than 3 points: the whole picture
  std::uint32_t min_area_px = 1;  // smaller regions are dropped with their runs
  KernelChoice kernel = KernelChoice::kFastest;
  std::uint8_t box_shift_limit = 0;  // levels by which boxes may be moved while frames come
  TypicalBackground background;      // for speed alone
};

/// All that the parameters decide of a scan: made while another set is in use, and exchanged for it between two frames.
/// Large (fixed memory): not on the stack.
class ScanTables {
 public:
  /// kOutOfRange: a size of 0 or above the capacity, a bad box, light map or polygon; kInconsistent: a polygon without
  /// a pixel. (Boxes of different colors that overlap are not an error here: the loader reports them.)
  /// After an error no frame is accepted.
  Status configure(const ScanParameters& parameters);

 private:
  friend class RegionScanner;

  bool configured_ = false;
  std::uint32_t min_area_px_ = 1;
  RowClassifier classifier_;
  RegionOfInterest region_of_interest_;
  RowMasker find_masks_ = nullptr;
  RunWriter run_writer_;
};

/// Classification and labeling in one scan of the frame (paper, sections 3.2 and 4.1), over runs instead of pixels:
/// union-find gives the paper's regions without copying, in a bounded time.
/// Large (fixed memory): make one, not on the stack.
class RegionScanner {
 public:
  RegionScanner() = default;
  RegionScanner(const RegionScanner&) = delete;
  RegionScanner& operator=(const RegionScanner&) = delete;
  ~RegionScanner() = default;

  /// As ScanTables::configure, of the set that is the scanner's own and in use from now on.
  Status configure(const ScanParameters& parameters);

  /// Between two scans: from the next one on `tables` are in use, which must be configured for pictures of the same
  /// size and live as long as they are. Returns those that were in use; the scanner's own live as long as it does.
  ScanTables& exchange(ScanTables& tables) { return *std::exchange(tables_, &tables); }

  /// Between two scans, a part at a time: see RowClassifier.
  void apply_light_change(const LightChange& change, std::uint16_t tile_row) {
    tables_->classifier_.apply_light_change(change, tile_row);
  }
  void rebuild_tables(const ColorBoxes& boxes, std::size_t channel, std::uint8_t level) {
    tables_->classifier_.rebuild_tables(boxes, channel, level);
  }
  [[nodiscard]] const Shading& shading() const { return tables_->classifier_.shading(); }

  /// Regions in raster order of their first pixel, 4-neighborhood, exact sums; `runs` holds the runs of these regions
  /// in raster order, those of one region chained by Run::next, and no others.
  /// kUnsupported: frame of another format or size than configured; kShortFrame: a plane is missing or its stride is
  /// too small. Both leave `runs` and `regions` empty.
  /// kFull: too much was found, one or both of
  /// - rows with more runs than RunBudget lets them have, which no realistic field has: such a row lost its shortest
  ///   runs, and the regions are those of the picture without these. A region that has no pixel in such a row is whole
  ///   and exact. runs.overflow() counts what was lost. (Where the least area is 2 or more, pixels without a neighbor
  ///   of their color are no runs.)
  /// - more regions than fit: the largest are there; regions.overflow() counts the others.
  Status scan(const Frame& frame, Runs& runs, Regions& regions);

 private:
  void classify(const Frame& frame, std::uint16_t v);
  void add_row(std::uint16_t v, Runs& runs);

  ScanTables own_;
  ScanTables* tables_ = &own_;
  RunBudget budget_;
  Labeling labeling_;
  std::array<ColorRow, 2> colors_;  // row v is number v % 2
  std::array<RowMasks, 3> masks_;   // row v is number v % 3
};

}  // namespace touchline
