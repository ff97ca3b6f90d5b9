#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/region/row_bits.h"
#include "core/types.h"

namespace touchline {

/// Joins the runs of a picture, row by row, to regions. It uses union-find instead of copying pixel lists as in the
/// paper (section 4.1). The regions are the same as in the paper, and the number of runs bounds the time.
///
/// While rows are added, Run::next holds a label of the run's component; finish() replaces it by the chain. A component
/// gets its label at its first run, and a union keeps the lower label, so labels are in raster order of first pixels.
class Labeling {
 public:
  /// Begins a frame. finish() drops regions with a smaller area or fewer rows.
  void begin(std::uint32_t min_area_px, std::uint32_t min_height_px);

  /// Adds the next row, runs[first, runs.size()). Their `next` must be kNoRun.
  void add_row(Runs& runs, std::size_t first, std::span<const Contact> contacts);

  /// Returns the index of the first run of the row that was added last.
  [[nodiscard]] std::size_t last_row() const { return above_; }
  /// Marks the run's region as cut, because runs that touched this run were dropped.
  void mark_cut(std::size_t run) {
    cut_runs_[run / 64] |= std::uint64_t{1} << run % 64;
    has_cut_runs_ = true;
  }

  /// Writes the regions and keeps only their runs, chained. If there are more regions than fit, the largest are
  /// reported (of equal ones the first), and regions.overflow() counts the others.
  void finish(Runs& runs, Regions& regions);

 private:
  // Bounding box: left, right, top and bottom. Left and top are mirrored, so that all bounds grow from 0.
  using Extent [[gnu::vector_size(8)]] = std::int16_t;
  static constexpr std::int16_t kMirror = 0x7fff;
  static constexpr Extent kMirrored = {kMirror, 0, kMirror, 0};
  static_assert(kMaxFrameWidth < kMirror && kMaxFrameHeight < kMirror);

  // Sums over the runs of a component. After sum_up(), an area of 0 marks a component with too few rows.
  struct Sums {
    std::uint64_t u = 0, v = 0;
    Extent extent = {};
    std::uint32_t area_px = 0, color = kBackground;
  };
  // Smallest area of reported components, and how many components of exactly this area are reported.
  struct Quota {
    std::uint32_t area_px = 0;
    std::size_t of_that_area = 0;
  };

  std::uint32_t root(std::uint32_t label);
  static Extent extent_of(const Run& run);
  static PixelBox box_of(Extent extent);
  static std::uint32_t height_of(Extent extent);
  void number_components();
  std::size_t sum_up(const Runs& runs);
  Quota quota(std::size_t competing);
  void report(Quota quota, Regions& regions);
  void mark_cut_regions(const Runs& runs, Regions& regions) const;
  void chain(Runs& runs, Regions& regions);

  // Every label begins at a run, so there are at most as many labels as runs. `sums_` has one more entry, because an
  // entry is cleared before it is known whether another component follows.
  std::array<std::uint32_t, kMaxRuns> parent_{};  // a lower label of the same component, or the label itself
  std::array<Sums, kMaxRuns + 1> sums_{};
  std::array<std::uint16_t, kMaxRuns> region_of_{};
  static_assert(kMaxRegions < 1u << 16);
  // If there are more components than fit, the smallest one that is reported has at most an equal share of the picture.
  static constexpr std::size_t kAreaBins = kMaxFrameWidth * kMaxFrameHeight / kMaxRegions + 2;
  std::array<std::uint32_t, kAreaBins> of_area_{};
  // End of each region's chain of runs; the last entry is for dropped runs.
  std::array<std::uint32_t*, kMaxRegions + 1> end_of_chain_{};
  std::uint32_t unused_link_ = 0;                               // written by the last entry of end_of_chain_
  std::array<std::uint64_t, (kMaxRuns + 63) / 64> cut_runs_{};  // one bit per run
  bool has_cut_runs_ = false;
  std::uint32_t labels_ = 0, components_ = 0;
  std::size_t above_ = 0;  // first run of the last row added
  std::uint32_t min_area_px_ = 1, min_height_px_ = 1;
};

}  // namespace touchline
