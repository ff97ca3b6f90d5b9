#pragma once

#include <array>
#include <cstdint>

#include "core/types.h"

namespace touchline {

/// Runs of a picture, row after row -> regions. Union-find over components instead of the paper's copying of pixel
/// lists (section 4.1): the same regions, in a time that the number of runs bounds.
///
/// While rows are added, Run::next holds the label of the run's component; finish() replaces it by the chain. A label
/// is given at a component's first run, and the lower one survives a union: labels are in raster order of first pixels.
class Labeling {
 public:
  /// A frame begins. Regions of a smaller area are dropped.
  void begin(std::uint32_t min_area_px);

  /// Joins runs[first, runs.size()), the next row that has any, to what is there.
  void add_row(Runs& runs, std::size_t first);

  /// When there is no room for `wanted` more runs, forgets the runs of finished components that are too small, or too
  /// many to be reported. `next_row` is the row that will be added next. False: the room gained is too little to go on.
  bool make_room(Runs& runs, std::size_t wanted, std::uint16_t next_row);

  /// Leaves only the runs of the reported regions, chained. When more regions were found than fit, the largest are
  /// reported (among equals the first ones), and the others are counted by regions.overflow().
  void finish(Runs& runs, Regions& regions);

  /// The same when row `next_row` cannot be added: components that it might have continued are not reported, because
  /// the rest of them is unknown, but counted as well.
  void finish_before(std::uint16_t next_row, Runs& runs, Regions& regions);

 private:
  struct Component {
    std::uint64_t sum_u = 0, sum_v = 0;
    std::uint32_t area_px = 0;
    std::uint32_t parent = 0;
    PixelBox box;
  };
  // What becomes of components that the next row may continue.
  enum class Open : std::uint8_t { kStay, kDrop };
  // The least area with which a finished component stays, and how many of just that area do.
  struct Quota {
    std::uint32_t area_px = 0;
    std::size_t of_that_area = 0;
  };

  std::uint32_t root(std::uint32_t label);
  std::uint32_t unite(std::uint32_t a, std::uint32_t b);
  std::uint32_t add_component(const Run& run);
  void extend(Component& component, const Run& run);
  [[nodiscard]] bool is_root(std::uint32_t label) const { return component_[label].parent == label; }
  [[nodiscard]] bool is_open(std::uint32_t label, std::uint32_t next_row) const {
    return component_[label].box.bottom + 1u == next_row;
  }
  Quota quota(std::uint32_t next_row);
  void compact(Runs& runs, std::uint32_t next_row, Open open);
  void report(Runs& runs, Regions& regions);

  // Every component has a run, so that there are never more of them than runs.
  std::array<Component, kMaxRuns> component_{};
  std::array<std::uint32_t, kMaxRuns> new_label_{};
  // When more finished components compete than fit, the last one that does has at most an equal share of the picture.
  static constexpr std::size_t kAreaBins = kMaxFrameWidth * kMaxFrameHeight / kMaxRegions + 2;
  std::array<std::uint32_t, kAreaBins> of_area_{};
  std::uint32_t components_ = 0;
  std::size_t above_begin_ = 0, above_end_ = 0;  // runs of the last row added
  std::uint32_t min_area_px_ = 1;
  std::size_t dropped_ = 0;
};

}  // namespace touchline
