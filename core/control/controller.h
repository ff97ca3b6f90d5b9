#pragma once

#include "core/control/control_parameters.h"
#include "core/control/play.h"
#include "core/control/stuck_monitor.h"
#include "core/geometry/field_area.h"
#include "core/types.h"

namespace touchline {

/// Tracks -> velocities for every own robot (paper, section 2, last paragraph).
class Controller {
 public:
  /// kOutOfRange: a limit or gain that no drive can have.
  Status configure(const ControlParameters& parameters, const FieldParameters& field);
  /// Other limits, gains and rules in the middle of a game, which goes on. Errors as configure(); then all stays.
  Status retune(const ControlParameters& parameters) { return take(parameters, play_.field()); }
  void reset();
  /// One command for each own robot that is tracked under an id, in the order of the tracks. A robot that is new, or
  /// has coasted for longer than max_coast_s, is told to stand; one that is lost is not listed, which tells it the same
  /// (docs/radio.md). `halted`: all stand, and start from rest afterwards. Same input, same bits.
  void decide(const Tracks& tracks, bool halted, Commands& out);

  [[nodiscard]] const Roles& roles() const { return play_.roles(); }

 private:
  struct Memory {
    RobotId id = kUnknownId;
    bool listed = false;
    Twist last;  // commanded
    StuckMonitor stuck;
  };
  Status take(const ControlParameters& parameters, const FieldParameters& field);
  Memory* memory_of(RobotId id);
  void forget_absent();
  [[nodiscard]] bool fit_to_play(const RobotTrack& robot, Instant now) const;

  ControlParameters parameters_;
  Play play_;
  FixedVector<Memory, kMaxRobotsPerTeam> memories_;
  bool started_ = false;
  Instant last_time_{};
};

}  // namespace touchline
