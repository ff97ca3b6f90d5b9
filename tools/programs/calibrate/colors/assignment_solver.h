#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "tools/programs/calibrate/colors/color_assignment.h"
#include "tools/programs/calibrate/colors/patch_labels.h"

namespace touchline::calibrate {

/// An assignment of labels to colors and its cost.
struct Solution {
  double cost = std::numeric_limits<double>::infinity();  // in nats
  std::vector<std::size_t> label_of;  // label of each color, in addition to labels that clicks name; kNone: not found
  std::vector<Label> labels;
  std::vector<std::optional<Lab>> expected;  // expected appearance of each color in this light
  std::vector<const MarkerCandidate*> markers;
  std::size_t robots = 0, unknown_robots = 0;
  std::vector<AssignedRobot> named, unlisted;
};

/// A cluster that a color must not take, and the clusters similar to it. Clusters that clicks name are never excluded.
struct Exclusion {
  std::size_t color = kNone;
  Lab lab;
};

/// Finds the assignment with the lowest cost over all divisions into clusters and all pairs of team colors; see
/// assign_colors(). `cuts`: as label_patches() returns them. `with_shades`: a color may have several clusters.
Solution solve_assignment(const AssignmentInput& input, const std::vector<PatchLabels>& cuts,
                          const Exclusion& exclusion, bool with_shades);

}  // namespace touchline::calibrate
