#pragma once

#include "core/control/control_parameters.h"
#include "core/control/external_control.h"
#include "core/control/line_up.h"
#include "core/control/play.h"
#include "core/geometry/field_area.h"
#include "core/types.h"

namespace touchline {

/// Computes the velocities of all own robots from the tracks (paper, section 2, last paragraph).
class Controller {
 public:
  /// kOutOfRange: an impossible limit or size.
  Status configure(const ControlParameters& parameters, const FieldParameters& field);
  /// Replaces the built-in play by another strategy, which must outlive this object; null: the built-in play. Call it
  /// before configure().
  void set_strategy(Strategy* strategy) { other_ = strategy; }
  /// Changes limits and parameters of the play during a game without resetting it. Errors as configure(); nothing
  /// changes then.
  Status set_parameters(const ControlParameters& parameters) { return apply(parameters, play_.field()); }
  void reset();
  /// Sets the commands of other programs. A robot with such a command leaves the built-in play until a command releases
  /// it; the play goes on with the other robots. A command older than external.max_age_s stops its robot. `now`: the
  /// time of the next decide(), on the clock of ExternalCommand::received.
  void set_external(const ExternalCommands& commands, Instant now) { external_.set(commands, now); }
  /// Sets whether the own team defends the half with positive x. Then the play attacks towards negative x.
  void set_turned(bool turned);
  /// Sets the referee's decision. While the team lines up, LineUp drives the robots of the built-in play, and its
  /// maximum speed holds for all robots.
  void set_situation(const GameSituation& situation);
  /// Writes one command for each own robot that is tracked with an id, in the order of the tracks. `measured` is in the
  /// venue's coordinates. The command of a new robot, or of one that was not seen for longer than max_coast_s, is zero.
  /// A lost robot is not listed, which has the same effect (docs/radio.md). If `is_halted`, or if the referee permits
  /// nothing, all commands are zero, and the robots start from rest afterwards. The same input gives the same bits.
  void decide(const Tracks& measured, bool is_halted, Commands& out);

  /// Writes what the strategy decided in the last decide(), in the venue's coordinates. Empty if it decided nothing.
  void explain(PlayDecisions& out) const;

  [[nodiscard]] const Play& play() const { return play_; }

  /// See Pipeline::visit_state(). The rest is set before each decision. A strategy of set_strategy() is left out.
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    auto& [parameters, play, other, external, line_up, situation, motion, turned, turned_tracks, states, started,
           last_time] = self;
    archive(play, motion, states, started, last_time);
  }

 private:
  struct RobotState {
    RobotId id = kUnknownId;
    bool listed = false;
    Twist command;  // last command
    Twist wheels;   // predicted velocities of the wheels when the next command begins to act

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
      auto& [id, listed, command, wheels] = self;
      archive(id, listed, command, wheels);
    }
  };
  [[nodiscard]] Strategy& strategy() { return other_ != nullptr ? *other_ : play_; }
  [[nodiscard]] const Strategy& strategy() const {
    return other_ != nullptr ? *other_ : static_cast<const Strategy&>(play_);
  }
  Status apply(const ControlParameters& parameters, const FieldParameters& field);
  RobotState* state_of(RobotId id);
  void remove_absent();
  [[nodiscard]] bool is_usable(const RobotTrack& robot, Instant now) const;
  // Returns the robots of the built-in play.
  [[nodiscard]] Players players_of(const Tracks& tracks);
  // Predicts the wheels of all robots by the time since the last command.
  void predict_wheels(const Tracks& tracks, double since_last_s);
  [[nodiscard]] Twist external_twist(const ExternalCommand& command, const Player& robot);
  [[nodiscard]] Twist within_limits(const Twist& wanted, const Twist& wheels, double period_s) const;
  // The command within the limits; if control.avoid is strict and does not permit it, one that brakes.
  [[nodiscard]] Twist permitted(const Twist& wanted, const Player& robot, double period_s);

  ControlParameters parameters_;
  Play play_;
  Strategy* other_ = nullptr;  // plays instead of play_
  ExternalControl external_;
  LineUp line_up_;
  GameSituation situation_;
  MotionPlanner motion_;  // of the robots that other programs drive
  bool turned_ = false;
  Tracks turned_tracks_;
  FixedVector<RobotState, kMaxRobotsPerTeam> states_;
  bool started_ = false;
  Instant last_time_{};
};

}  // namespace touchline
