#pragma once

#include "core/types.h"

namespace touchline {

struct ControlParameters {};  // drive limits, gains, play; see control's owner

/// Tracks -> velocities for every own robot (paper, section 2, last paragraph).
class Controller {
 public:
  Status configure(const ControlParameters& parameters);
  void reset();
  void decide(const Tracks& tracks, Commands& out);
};

}  // namespace touchline
