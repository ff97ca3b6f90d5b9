#pragma once

#include <array>
#include <cstdint>

#include "core/types.h"

namespace touchline {

/// Runs of a picture, row after row -> regions. Union-find over components instead of the paper's copying of pixel
/// lists (section 4.1): the same regions, in a time that the number of runs bounds.
///
/// While rows are added, Run::next holds a label of the run's component; finish() replaces it by the chain. A label
/// is given at a component's first run, and the lower one survives a union: labels are in raster order of first pixels.
class Labeling {
 public:
  /// A frame begins. Regions of a smaller area are dropped.
  void begin(std::uint32_t min_area_px);

  /// Joins runs[first, runs.size()), the next row that has any, to what is there. Their `next` is kNoRun.
  void add_row(Runs& runs, std::size_t first);

  /// Leaves only the runs of the reported regions, chained. When more regions were found than fit, the largest are
  /// reported (among equals the first ones), and the others are counted by regions.overflow().
  void finish(Runs& runs, Regions& regions);

 private:
  // Of the runs with one label; those of a component's other labels are added at the end.
  struct Sums {
    std::uint64_t u = 0, v = 0;
    std::uint32_t area_px = 0;
    ColorId color = kBackground;
    PixelBox box;
  };
  // Runs of neighboring rows that share a column and their color.
  struct Contact {
    const Run* above = nullptr;
    Run* below = nullptr;
  };
  // The least area with which a component stays, and how many of just that area do.
  struct Quota {
    std::uint32_t area_px = 0;
    std::size_t of_that_area = 0;
  };

  std::uint32_t root(std::uint32_t label);
  void join_row_above(Runs& runs, std::size_t first);
  void sum_row(Runs& runs, std::size_t first);
  std::size_t merge_components();
  Quota quota(std::size_t competing);
  void report(Quota quota, Regions& regions);
  void chain(Runs& runs, Regions& regions);

  // Every component has a run, so that there are never more of them than runs.
  std::array<Sums, kMaxRuns> sums_{};
  std::array<std::uint32_t, kMaxRuns> parent_{};  // a lower label of the same component, or the label itself
  std::array<Contact, 2 * kMaxFrameWidth> contacts_{};
  // When more components compete than fit, the last one that does has at most an equal share of the picture.
  static constexpr std::size_t kAreaBins = kMaxFrameWidth * kMaxFrameHeight / kMaxRegions + 2;
  std::array<std::uint32_t, kAreaBins> of_area_{};
  std::array<std::uint32_t*, kMaxRegions + 1> end_of_chain_{};  // the last one: of all that is dropped
  std::uint32_t components_ = 0;
  std::size_t above_begin_ = 0, above_end_ = 0;  // runs of the last row added
  std::uint32_t min_area_px_ = 1;
};

}  // namespace touchline
