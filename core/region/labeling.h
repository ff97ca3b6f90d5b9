#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/region/row_bits.h"
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

  /// Joins runs[first, runs.size()), the next row, to what is there. Their `next` is kNoRun.
  void add_row(Runs& runs, std::size_t first, std::span<const Contact> contacts);

  /// Leaves only the runs of the reported regions, chained. When more regions were found than fit, the largest are
  /// reported (among equals the first ones), and the others are counted by regions.overflow().
  void finish(Runs& runs, Regions& regions);

 private:
  // How far to the left, right, top and bottom: left and top mirrored, so that all grow from 0.
  using Extent [[gnu::vector_size(8)]] = std::int16_t;
  static constexpr std::int16_t kMirror = 0x7fff;
  static constexpr Extent kMirrored = {kMirror, 0, kMirror, 0};
  static_assert(kMaxFrameWidth < kMirror && kMaxFrameHeight < kMirror);

  // Of a component's runs.
  struct Sums {
    std::uint64_t u = 0, v = 0;
    Extent extent = {};
    std::uint32_t area_px = 0, color = kBackground;
  };
  // The least area with which a component stays, and how many of just that area do.
  struct Quota {
    std::uint32_t area_px = 0;
    std::size_t of_that_area = 0;
  };

  std::uint32_t root(std::uint32_t label);
  static Extent extent_of(const Run& run);
  static PixelBox box_of(Extent extent);
  void number_components();
  std::size_t sum_up(const Runs& runs);
  Quota quota(std::size_t competing);
  void report(Quota quota, Regions& regions);
  void chain(Runs& runs, Regions& regions);

  // Every label has a run that was first to have it, so that there are never more of them than runs. Sums have one to
  // spare, which is begun before it is known whether there is a component for it.
  std::array<std::uint32_t, kMaxRuns> parent_{};  // a lower label of the same component, or the label itself
  std::array<Sums, kMaxRuns + 1> sums_{};
  std::array<std::uint16_t, kMaxRuns> region_of_{};
  static_assert(kMaxRegions < 1u << 16);
  // When more components compete than fit, the last one that does has at most an equal share of the picture.
  static constexpr std::size_t kAreaBins = kMaxFrameWidth * kMaxFrameHeight / kMaxRegions + 2;
  std::array<std::uint32_t, kAreaBins> of_area_{};
  std::array<std::uint32_t*, kMaxRegions + 1> end_of_chain_{};  // the last one: of all that is dropped
  std::uint32_t nowhere_ = 0;                                   // where that leads
  std::uint32_t labels_ = 0, components_ = 0;
  std::size_t above_ = 0;  // the first run of the last row added
  std::uint32_t min_area_px_ = 1;
};

}  // namespace touchline
