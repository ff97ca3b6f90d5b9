#pragma once

#include <array>
#include <span>

#include "core/geometry/camera_model.h"
#include "core/geometry/field_area.h"
#include "core/marker/marker_layout.h"
#include "core/marker/region_shape.h"
#include "core/types.h"

namespace touchline {

/// What all patches of one color have in common, over every robot that wears them.
struct PatchKind {
  float least_area_m2 = 0, largest_area_m2 = 0;  // of the outlines
  float side_m = 0;                              // d1: smaller side of the smallest patch
  float length_m = 0;                            // longest side of the largest one
  PrincipalVariances variances;                  // of the largest one
  float largest_ratio = 0;                       // of the area to the expected one: more are several patches
  bool may_touch = true;                         // two of them may grow together in the picture
  bool may_be_hidden = false;                    // what is left of one is of use
  std::array<float, 2> height_m{};               // by Team, of whose robots it may be
  std::size_t plane = 0;                         // index in height_m by which areas and distances are judged
};

PatchKind kind_of(const PatchPlace& place, float height_m);
void widen(PatchKind& kind, const PatchPlace& place);

/// A region, its fragments, or a part of a region, that may be a patch.
struct PatchCandidate {
  PixelPoint center;
  std::array<FieldPoint, 2> at{};  // by Team: on the plane of that team's patches
  float area_px = 0;
  float ratio = 0;  // of the area to the expected one
  float scale_px_per_m = 0;
  float axis_rad = 0;  // field direction of the longer side, modulo pi
  bool has_axis = false;
  bool is_part = false;
  bool is_rest = false;  // too small for a patch, but perhaps the visible part of one
  std::uint16_t region = 0;
  ColorId color = kBackground;
};

// 22 robots that wear the same color twice are 44 patches, and half as many again for fragments and noise: the paper's
// "proper number of regions with the biggest area".
constexpr std::size_t kMaxPatchesPerColor = 64;
using ColorPatches = FixedVector<PatchCandidate, kMaxPatchesPerColor>;

/// Regions of one color -> patches: expected area at the place, touching ones divided, eq. (1), weighted refinement.
class PatchFinder {
 public:
  // Blur at the border and thresholds take a third to a half of a small patch.
  static constexpr float kLeastRatio = 0.35f;
  // Noise is a pixel or two (section 5); of the smallest patches of use, 5 by 5 pixels, that is so much.
  static constexpr float kLeastRest = 0.08f;

  void configure(const CameraModel& camera, const FieldParameters& field);

  /// `candidates`: numbers of regions of this color. `out` is filled from the largest to the smallest, rests last;
  /// verdicts are given to regions that are not (alone) in it, and to rests.
  void find(const PatchKind& kind, const Runs& runs, const Regions& regions, std::span<const std::uint16_t> candidates,
            Sightings& verdicts, ColorPatches& out) const;

  [[nodiscard]] const CameraModel& camera() const { return camera_; }
  [[nodiscard]] const FieldParameters& field() const { return field_; }

 private:
  void examine(const PatchKind& kind, const Runs& runs, const Regions& regions,
               std::span<const std::uint16_t> candidates, std::uint16_t number, Sightings& verdicts,
               ColorPatches& out) const;
  void place(const PatchKind& kind, PatchCandidate& patch) const;
  [[nodiscard]] bool is_lone_speck(const PatchKind& kind, const Regions& regions, std::uint16_t number,
                                   std::span<const std::uint16_t> candidates, const ColorPatches& larger) const;
  bool merge(const PatchKind& kind, const PatchCandidate& from, PatchCandidate& into, float largest_ratio) const;
  float field_axis(const PatchKind& kind, const PatchCandidate& patch, const RegionShape& shape) const;

  CameraModel camera_;
  FieldParameters field_;
  float least_scale_px_per_m_ = 0, largest_scale_px_per_m_ = 0;  // anywhere on the field, on the floor
};

}  // namespace touchline
