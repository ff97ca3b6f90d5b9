#pragma once

#include <limits>
#include <vector>

#include "tools/programs/calibrate/colors/color_names.h"

namespace touchline::calibrate {

struct AssignmentInput;

inline constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// Two clusters count as the same color if their difference() is below this value.
inline constexpr double kSame = 9.0;

/// A cluster of patches that have one color.
struct Label {
  std::vector<std::size_t> patches;
  Rgb rgb{};  // median of the patches
  Lab lab;
  std::size_t named = kNone;  // color that clicks give to this label
  // Color of which this label is a further shade, in addition to the label that the color is assigned.
  std::size_t shade = kNone;
};

/// Patches divided into clusters by cutting the dendrogram at one distance.
struct PatchLabels {
  std::vector<Label> labels;
  // Label of each patch; kNone: the patch is in no marker, not clicked, and no ball.
  std::vector<std::size_t> label_of;

  /// Returns the label that clicks name as this color; kNone if no click does.
  [[nodiscard]] std::size_t named(std::size_t color) const;
};

/// Returns the median of each channel, which tolerates patches that include some of their surroundings. `patches` must
/// not be empty.
Rgb median_rgb(const AssignmentInput& input, const std::vector<std::size_t>& patches);

/// Clusters the patches that markers, balls or clicks use, at several distances. Patches that clicks name with the same
/// color get the same label, patches with different names different labels: if a cluster contains several names, each
/// of its patches gets the name of the most similar clicked patch.
std::vector<PatchLabels> label_patches(const AssignmentInput& input);

}  // namespace touchline::calibrate
