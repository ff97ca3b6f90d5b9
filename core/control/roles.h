#pragma once

#include "core/control/ball_approach.h"
#include "core/geometry/vector2.h"
#include "core/types.h"

namespace touchline {

/// An own robot that takes part, at the instant at which its command acts.
struct Player {
  RobotId id = kUnknownId;
  Pose pose;
  Twist twist;
};
using Players = FixedVector<Player, kMaxRobotsPerTeam>;

using Places = FixedVector<Vector2, kMaxRobotsPerTeam>;
/// Where supporters stand for a ball, the most important place first: one behind the attacker on the inner side, then
/// between ball and own goal, then spread over the field. No two places are nearer than robots need to pass.
void supporter_places(const PushPlan& plan, const FieldParameters& field, const PlayParameters& play, std::size_t count,
                      Places& out);

/// Goalkeeper, attacker and supporters. Who has a role keeps it until another is better by the hysteresis, so that two
/// robots that are equally good do not swap every frame.
class Roles {
 public:
  void reset();
  /// `plan` null: no ball, hence no attacker and no supporters.
  void assign(const Players& players, const PushPlan* plan, const FieldParameters& field, const PlayParameters& play);

  [[nodiscard]] RobotId goalkeeper() const { return goalkeeper_; }
  [[nodiscard]] RobotId attacker() const { return attacker_; }
  /// Null: none is assigned to this robot.
  [[nodiscard]] const Vector2* place_of(RobotId id) const;

 private:
  void choose_goalkeeper(const Players& players, const FieldParameters& field, const PlayParameters& play);
  void choose_attacker(const Players& players, const PushPlan& plan, const PlayParameters& play);
  void choose_supporters(const Players& players, const PlayParameters& play);

  RobotId goalkeeper_ = kUnknownId, attacker_ = kUnknownId;
  Places places_;
  std::array<RobotId, kMaxRobotsPerTeam> holder_{};  // of each place
  std::size_t held_ = 0;                             // places that had a holder in the last frame
};

}  // namespace touchline
