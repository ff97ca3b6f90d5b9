#pragma once

#include <cstdint>
#include <vector>

#include "firmware/config/difference.h"

// Which keys may change while robots play.
namespace touchline::config {

/// What has to take a change over; bits.
enum Taker : std::uint8_t {
  kNobody = 0,      // what the key says is looked at by people and tools only
  kCamera = 1,      // Camera::adjust
  kThresholds = 2,  // the scanner's tables and the adaptation
  kControl = 4,     // Controller::retune
  kLoop = 8,        // the loop's own times
};

/// New files against what runs.
struct HotChanges {
  std::vector<Change> taken;
  std::vector<Change> need_restart;
  std::uint8_t takers = kNobody;

  [[nodiscard]] bool empty() const { return taken.empty() && need_restart.empty(); }
};

/// Puts what may change while robots play from `next` into `running`, which then says what should run; all else of
/// `running` stays. Thresholds, light and region of interest only where they are for the pictures and the colors that
/// run: another size, format or list of colors needs a restart, and they with it. Both have been loaded without a
/// problem. kInconsistent: what would run is a mixture that cannot, see `problems`; then `running` is not to be used.
Status take_hot_keys(const Configuration& next, Configuration& running, HotChanges& changes, Problems& problems);

}  // namespace touchline::config
