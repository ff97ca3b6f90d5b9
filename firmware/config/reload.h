#pragma once

#include <cstdint>
#include <vector>

#include "core/parameter.h"
#include "firmware/config/difference.h"
#include "hal/result.h"

// Reloads the files while robots play. The declaration of a key says whether its value can change (Reload in
// core/parameter.h).
namespace touchline::config {

/// The difference between new files and the running configuration.
struct ReloadChanges {
  std::vector<Change> applied;
  std::vector<Change> need_restart;

  [[nodiscard]] bool empty() const { return applied.empty() && need_restart.empty(); }
  /// Returns whether a change concerns part `by` of the program, which must act on it.
  [[nodiscard]] bool concern(Reload by) const;
};

/// Copies the values that can change while robots play from `next` to `running`; all other values of `running` stay.
/// Both must have been loaded without errors. Thresholds, light map and region of interest also need a restart if the
/// new files have another picture size or format, or another list of colors. kInconsistent: old and new values
/// contradict each other; `running` must not be used.
Result<ReloadChanges> apply_reloadable(const Configuration& next, Configuration& running);

}  // namespace touchline::config
