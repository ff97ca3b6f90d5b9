#include "tools/programs/calibrate/colors/patch_labels.h"

#include <algorithm>
#include <map>
#include <set>

#include "tools/programs/calibrate/colors/color_assignment.h"
#include "tools/programs/calibrate/colors/color_clusters.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

// Distances at which the dendrogram is cut, from the noise of one paint in even light to the differences between its
// shades in uneven light.
constexpr double kCuts[] = {8, 11, 15, 20, 26, 33};

// Gives every patch of a cluster with clicks the name of the most similar clicked patch in the cluster. Returns the
// name, or kNone, for each patch of `used`.
std::vector<std::size_t> names_of(const AssignmentInput& input, const std::vector<std::size_t>& used,
                                  const std::vector<std::size_t>& cluster) {
  std::vector<std::size_t> names(used.size(), kNone);
  for (std::size_t i = 0; i < used.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < used.size(); ++k) {
      const std::size_t name = input.named[used[k]];
      if (name == kNone || cluster[k] != cluster[i]) continue;
      const double d = i == k ? -1.0 : difference(input.patches[used[i]].lab, input.patches[used[k]].lab);
      if (d >= nearest) continue;
      nearest = d;
      names[i] = name;
    }
  }
  return names;
}

PatchLabels labels_of(const AssignmentInput& input, const std::vector<std::size_t>& used,
                      const std::vector<std::size_t>& cluster) {
  const std::vector<std::size_t> names = names_of(input, used, cluster);
  PatchLabels out;
  out.label_of.assign(input.patches.size(), kNone);
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> number;  // key: (name, 0) or (kNone, cluster)
  for (std::size_t i = 0; i < used.size(); ++i) {
    const auto key = names[i] == kNone ? std::pair{kNone, cluster[i]} : std::pair{names[i], std::size_t{0}};
    const auto [entry, is_new] = number.try_emplace(key, out.labels.size());
    if (is_new) {
      out.labels.emplace_back();
      out.labels.back().named = names[i];
    }
    out.labels[entry->second].patches.push_back(used[i]);
    out.label_of[used[i]] = entry->second;
  }
  for (Label& label : out.labels) {
    label.rgb = median_rgb(input, label.patches);
    label.lab = lab_of(label.rgb);
  }
  return out;
}

}  // namespace

std::size_t PatchLabels::named(std::size_t color) const {
  for (std::size_t l = 0; l < labels.size(); ++l) {
    if (labels[l].named == color) return l;
  }
  return kNone;
}

Rgb median_rgb(const AssignmentInput& input, const std::vector<std::size_t>& patches) {
  Rgb rgb{};
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<double> values;
    values.reserve(patches.size());
    for (const std::size_t p : patches) values.push_back(input.patches[p].rgb[c]);
    rgb[c] = statistics::median(values);
  }
  return rgb;
}

std::vector<PatchLabels> label_patches(const AssignmentInput& input) {
  std::set<std::size_t> in_use(input.balls.begin(), input.balls.end());
  for (const MarkerCandidate& m : input.markers) in_use.insert(m.patches.begin(), m.patches.end());
  for (std::size_t p = 0; p < input.named.size(); ++p) {
    if (input.named[p] != kNone) in_use.insert(p);
  }
  const std::vector<std::size_t> used(in_use.begin(), in_use.end());
  std::vector<Lab> colors;
  colors.reserve(used.size());
  for (const std::size_t p : used) colors.push_back(input.patches[p].lab);
  const ColorClusters clusters(colors);
  std::vector<PatchLabels> out;
  std::size_t before = kNone;
  for (const double distance : kCuts) {
    std::size_t count = 0;
    const std::vector<std::size_t> cluster = clusters.cut(distance, count);
    if (count == before) continue;
    before = count;
    out.push_back(labels_of(input, used, cluster));
  }
  return out;
}

}  // namespace touchline::calibrate
