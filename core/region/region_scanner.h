#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "core/color/color_tables.h"
#include "core/color/row_classifier.h"
#include "core/light/light_map.h"
#include "core/region/labeling.h"
#include "core/region/pixel_classifier.h"
#include "core/region/region_of_interest.h"
#include "core/region/row_masks.h"
#include "core/region/row_runs.h"
#include "core/region/run_limiter.h"
#include "core/types.h"

namespace touchline {

struct ScanParameters {
  PixelFormat format = PixelFormat::kRgb24;
  std::uint16_t width_px = 0, height_px = 0;
  ColorBoxes boxes;            // in the format's color space
  LightMap light;              // no light map if its number of columns is 0
  Polygon region_of_interest;  // pixel centers inside count; fewer than 3 points: the whole picture
  // Regions with a smaller area or fewer rows are dropped with their runs. If the smallest height is 2 or more, a row
  // between two others is read only beside colors in these two rows.
  std::uint32_t min_area_px = 1, min_height_px = 1;
  KernelChoice kernel = KernelChoice::kFastest;
  std::uint8_t box_shift_limit = 0;  // levels by which boxes may move after configuration
  TypicalBackground background;      // affects only the speed
};

/// Everything that a scan derives from its parameters. A new set can be built while another one is in use, and replaces
/// it between two frames. Large (fixed memory): do not put it on the stack.
class ScanTables {
 public:
  /// kOutOfRange: a size is 0 or above the capacity, or a box, the light map or the polygon is invalid. kInconsistent:
  /// the polygon contains no pixel. (Overlapping boxes of different colors are no error here; the loader reports them.)
  /// After an error no frame is accepted.
  Status configure(const ScanParameters& parameters);

 private:
  friend class RegionScanner;

  bool configured_ = false;
  std::uint32_t min_area_px_ = 1, min_height_px_ = 1;
  std::array<std::size_t, kMaxPlanes> bytes_of_eight_px_{};  // bytes of eight pixels in each plane
  RowClassifier classifier_;
  RegionOfInterest region_of_interest_;
  RunWriter run_writer_;
};

/// Classifies and labels a frame in one scan (paper, sections 3.2 and 4.1). It works on runs instead of pixels, and
/// union-find gives the regions of the paper without copying, in bounded time.
/// Large (fixed memory): do not put it on the stack.
class RegionScanner {
 public:
  RegionScanner() = default;
  RegionScanner(const RegionScanner&) = delete;
  RegionScanner& operator=(const RegionScanner&) = delete;
  ~RegionScanner() = default;

  /// Configures the scanner's own tables (as ScanTables::configure) and uses them.
  Status configure(const ScanParameters& parameters);

  /// Uses `tables` from the next scan on, and returns the previous ones. Call it between two scans. `tables` must be
  /// configured for the same picture size and stay valid while they are in use. The scanner's own tables live as long
  /// as the scanner.
  ScanTables& exchange(ScanTables& tables) { return *std::exchange(tables_, &tables); }

  /// As in RowClassifier. Call them between two scans, one part at a time.
  void apply_light_change(const LightChange& change, const FieldLight& field, std::uint16_t tile_row) {
    tables_->classifier_.apply_light_change(change, field, tile_row);
  }
  void rebuild_tables(const ColorBoxes& boxes, std::size_t channel, std::uint8_t level) {
    tables_->classifier_.rebuild_tables(boxes, channel, level);
  }
  /// Returns the status that scan() would return for this frame before it reads a pixel.
  [[nodiscard]] Status accepts(const Frame& frame) const {
    return tables_->configured_ ? tables_->classifier_.accepts(frame) : Status(ErrorCode::kUnsupported);
  }
  [[nodiscard]] const Shading& shading() const { return tables_->classifier_.shading(); }
  /// Copies the data that determine the classes of pixels. Call it between two scans.
  void copy_to(PixelClassifier& out) const { out.copy(tables_->classifier_, tables_->region_of_interest_); }

  /// Finds regions (4-neighborhood, exact sums) in raster order of their first pixel. `runs` holds exactly the runs of
  /// these regions in raster order; Run::next chains the runs of a region.
  /// kUnsupported: the format or size of the frame differs from the configured one. kShortFrame: a plane is missing or
  /// its stride is too small. Both leave `runs` and `regions` empty.
  ///
  /// kFull: a capacity was exceeded, one or both of these:
  /// - The runs that RunLimiter allows in a row; no realistic field has more. Such a row lost its shortest runs, and
  ///   the regions are those of the picture without the lost runs. A region without pixels in such a row is complete
  ///   and exact. runs.overflow() counts the lost runs, and Region::is_cut tells which regions lost some. (Two kinds of
  ///   pixels form no runs: pixels without a neighbor of their color if the smallest area is 2 or more, and pixels that
  ///   are not read if the smallest height is 2 or more.)
  /// - The number of regions. The largest are reported, and regions.overflow() counts the others.
  Status scan(const Frame& frame, Runs& runs, Regions& regions);

 private:
  std::uint16_t classify_next(const Frame& frame, std::uint16_t v);
  void fetch_row(const Frame& frame, std::uint16_t v) const;
  void clear(std::uint16_t v);
  void classify(const Frame& frame, std::uint16_t v);
  void classify_between(const Frame& frame, std::uint16_t v);
  OccupiedWords classify_words(const Frame& frame, std::uint16_t v, OccupiedWords words);
  void find_masks(std::uint16_t v);
  void add_row(std::uint16_t v, Runs& runs);

  ScanTables own_;
  ScanTables* tables_ = &own_;
  RunLimiter run_limiter_;
  Labeling labeling_;
  // Ring of three rows; row v has index v % 3. Its colors lie within its occupied words.
  std::array<ColorRow, 3> colors_;
  std::array<OccupiedWords, 3> occupied_{};
  std::array<RowMasks, 3> masks_;
};

}  // namespace touchline
