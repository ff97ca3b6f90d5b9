#include "firmware/config/reload.h"

#include <algorithm>

#include "core/parameter_copy.h"

namespace touchline::config {
namespace {

// Returns whether both have the same picture size, format and list of colors, for which boxes, maps and polygons are
// valid.
bool same_pictures_and_colors(const Configuration& a, const Configuration& b) {
  const ScanParameters &x = a.pipeline.scan, &y = b.pipeline.scan;
  return x.format == y.format && x.width_px == y.width_px && x.height_px == y.height_px &&
         std::equal(a.venue.color.begin(), a.venue.color.end(), b.venue.color.begin(), b.venue.color.end(),
                    [](const ColorEntry& one, const ColorEntry& other) { return one.name == other.name; });
}

void copy(const Configuration& next, Configuration& running, Reload which) {
  copy_reloadable(next.board, running.board, which);
  copy_reloadable(next.venue, running.venue, which);
  copy_reloadable(next.team, running.team, which);
}

}  // namespace

bool ReloadChanges::concern(Reload by) const {
  return std::any_of(applied.begin(), applied.end(), [by](const Change& change) { return change.reload == by; });
}

Result<ReloadChanges> apply_reloadable(const Configuration& next, Configuration& running) {
  ReloadChanges changes;
  const bool thresholds_fit = same_pictures_and_colors(running, next);
  const auto can_change = [thresholds_fit](Reload reload) {
    return reload != Reload::kRestart && (reload != Reload::kThresholds || thresholds_fit);
  };
  for (Change& change : difference(running, next)) {
    (can_change(change.reload) ? changes.applied : changes.need_restart).push_back(std::move(change));
  }
  for (const Reload which :
       {Reload::kNoEffect, Reload::kCamera, Reload::kThresholds, Reload::kControl, Reload::kLoop}) {
    if (can_change(which)) copy(next, running, which);
  }
  running.pipeline.control = running.team.control;
  if (!changes.concern(Reload::kThresholds)) return changes;
  running.venue_where = next.venue_where;  // needed because the path of the light map is relative to the venue file
  const ScanParameters& scan = running.pipeline.scan;
  const InputFormat input{scan.format, scan.width_px, scan.height_px, "the running camera"};
  TOUCHLINE_TRY(resolve(input, running));
  // The pictures are those that were read with the files: they may have changed since.
  if (running.venue.light.map == next.venue.light.map) running.pipeline.scan.light = next.pipeline.scan.light;
  if (running.venue.light.reference == next.venue.light.reference) {
    running.pipeline.adaptation.reference = next.pipeline.adaptation.reference;
  }
  return changes;
}

}  // namespace touchline::config
