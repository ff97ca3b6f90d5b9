#pragma once

#include <limits>
#include <vector>

#include "tools/programs/calibrate/colors/color_names.h"

namespace touchline::calibrate {

struct AssignmentInput;

inline constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// Clusters with less difference() count as the same color.
inline constexpr double kSame = 9.0;

/// A cluster of patches that have one color.
struct Label {
  std::vector<std::size_t> patches;
  Rgb rgb{};  // median
  Lab lab;
  std::size_t named = kNone;  // the color that clicks give to it
  std::size_t shade = kNone;  // the color of which it is a further shade, besides the label that is assigned to it
};

/// The patches divided into clusters at one distance.
struct PatchLabels {
  std::vector<Label> labels;
  std::vector<std::size_t> label_of;  // per patch; kNone: the patch is in no marker, not clicked, and no ball

  /// The label that clicks name as this color; kNone: no click does.
  [[nodiscard]] std::size_t named(std::size_t color) const;
};

/// Median of each channel, which tolerates patches that include some of their surroundings. `patches` must not be
/// empty.
Rgb median_rgb(const AssignmentInput& input, const std::vector<std::size_t>& patches);

/// Clusters the patches that markers, balls or clicks use, at several distances. Patches that clicks name with one
/// color are in one label, patches with different names never are: if a cluster contains several names, each of its
/// patches goes to the name of the most similar clicked patch.
std::vector<PatchLabels> label_patches(const AssignmentInput& input);

}  // namespace touchline::calibrate
