#pragma once

#include <cstdint>
#include <vector>

#include "core/parameter.h"
#include "firmware/config/difference.h"

// New files while robots play. The declaration of a key says whether it can change then (Reload in core/parameter.h).
namespace touchline::config {

/// The difference between new files and the running configuration.
struct ReloadChanges {
  std::vector<Change> applied;
  std::vector<Change> need_restart;

  [[nodiscard]] bool empty() const { return applied.empty() && need_restart.empty(); }
  /// True if an applied change has to be taken over by `by`.
  [[nodiscard]] bool concern(Reload by) const;
};

/// Copies the values that can change while robots play from `next` to `running`; all others of `running` stay. Both
/// were loaded without a problem.
/// Thresholds, light map and region of interest need a restart, too, if the new files are for pictures of another size
/// or format, or have another list of colors.
/// kInconsistent: the mixture of old and new values contradicts itself, see `problems`; `running` must not be used.
Status apply_reloadable(const Configuration& next, Configuration& running, ReloadChanges& changes, Problems& problems);

}  // namespace touchline::config
