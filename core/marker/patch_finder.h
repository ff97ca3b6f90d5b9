#pragma once

#include <array>
#include <span>

#include "core/geometry/camera_model.h"
#include "core/geometry/field_area.h"
#include "core/geometry/sight_table.h"
#include "core/marker/marker_layout.h"
#include "core/marker/region_shape.h"
#include "core/types.h"

namespace touchline {

/// Common properties of all patches of one color, over all robots that have this color.
struct PatchKind {
  float least_area_m2 = 0, largest_area_m2 = 0;  // areas of the outlines
  float side_m = 0;                              // d1: smaller side of the smallest patch
  float length_m = 0;                            // longest side of the largest patch
  PrincipalVariances variances;                  // variances of the largest patch
  float largest_ratio = 0;                       // limit of (area / expected area); a larger region is several patches
  bool may_touch = true;                         // two patches may form one region in the picture
  bool may_be_partly_hidden = false;             // a partly visible patch is useful
  std::array<float, 2> height_m{};               // for each Team: height of the patches
  std::size_t plane = 0;                         // index in height_m that areas and distances refer to
};

PatchKind kind_of(const PatchPlace& place, float height_m);
void widen(PatchKind& kind, const PatchPlace& place);

/// A possible patch: a region, several fragments, or a part of a region.
struct PatchCandidate {
  PixelPoint center;
  std::array<FieldPoint, 2> at{};  // for each Team: projection to the plane of this team's patches
  float area_px = 0;
  float ratio = 0;  // area / expected area
  float scale_px_per_m = 0;
  float axis_rad = 0;           // direction of the longer side on the field, modulo pi
  bool has_axis = false;        // the shape is that of one complete patch
  bool has_rough_axis = false;  // axis_rad is valid, but the patch may be partly hidden
  bool is_split_part = false;
  bool is_partly_visible = false;  // too small for a complete patch, but possibly the visible part of one
  bool is_merged = false;          // the patch consists of several fragments
  std::uint16_t region = 0;
  ColorId color = kBackground;
};

// 22 robots with two patches of the same color have 44 patches; the rest is for fragments and noise. This is the
// paper's "proper number of regions with the biggest area".
constexpr std::size_t kMaxPatchesPerColor = 64;
using ColorPatches = FixedVector<PatchCandidate, kMaxPatchesPerColor>;

/// Work for splitting touching patches. The unit is a pair of patches that takes kUsualPasses.
struct SplitBudget {
  float pairs = 0;        // number of pairs that may still be split
  bool exceeded = false;  // a region was not split
};

/// Finds the patch candidates among the regions of one color: compares their areas with the area expected at their
/// positions, splits touching patches, and applies eq. (1) and the weighted refinement of the paper.
class PatchFinder {
 public:
  // Smallest area ratio of a complete patch. Blur and thresholds remove a third to a half of a small patch.
  static constexpr float kMinRatio = 0.35f;
  // Smallest area ratio of a partly visible patch. Noise has one or two pixels (section 5), and the smallest usable
  // patches have 5 by 5.
  static constexpr float kMinVisibleRatio = 0.08f;

  void configure(const CameraModel& camera, const FieldParameters& field);

  /// `candidates`: numbers of the regions of this color, at most kMaxPatchesPerColor. `out` is sorted by area, the
  /// largest first, with partly visible ones last. Writes the verdicts of regions that are not in `out`, that were
  /// merged, or that are partly visible. Splits touching patches, the largest first, as long as `budget` lasts.
  void find(const PatchKind& kind, const Runs& runs, const Regions& regions, std::span<const std::uint16_t> candidates,
            Sightings& verdicts, SplitBudget& budget, ColorPatches& out) const;

  [[nodiscard]] const CameraModel& camera() const { return camera_; }
  [[nodiscard]] const FieldParameters& field() const { return field_; }

 private:
  class RegionsOfColor;

  void examine(const PatchKind& kind, const Runs& runs, const Region& region, std::uint16_t number,
               const RegionsOfColor& same_color, Sightings& verdicts, SplitBudget& budget, ColorPatches& out) const;
  // Returns false if the budget does not suffice.
  bool split_touching(const PatchKind& kind, const Runs& runs, const Region& region, const RegionShape& shape,
                      const PatchCandidate& whole, float ratio_to_largest, SplitBudget& budget,
                      ColorPatches& out) const;
  // Computes `at` and the scale.
  void place(const PatchKind& kind, PatchCandidate& patch) const;
  [[nodiscard]] float least_visible_px(const PatchKind& kind) const;
  [[nodiscard]] bool is_noise(const PatchKind& kind, const Region& region, const RegionsOfColor& same_color,
                              const ColorPatches& larger) const;
  void merge_close(const PatchKind& kind, Sightings& verdicts, ColorPatches& out) const;
  void merge_small(const PatchKind& kind, Sightings& verdicts, ColorPatches& out) const;
  bool merge(const PatchKind& kind, const PatchCandidate& from, PatchCandidate& into, float largest_ratio) const;
  float field_axis(const PatchKind& kind, const PatchCandidate& patch, const RegionShape& shape) const;

  CameraModel camera_;
  SightTable lines_;
  FieldParameters field_;
  float least_scale_px_per_m_ = 0, largest_scale_px_per_m_ = 0;  // extremes over the field, on the floor
};

}  // namespace touchline
