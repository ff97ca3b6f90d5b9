#pragma once

#include "core/control/ball_approach.h"
#include "core/geometry/vector2.h"
#include "core/types.h"

namespace touchline {

/// An own robot that takes part in the game, predicted to the time at which its command acts.
struct Player {
  RobotId id = kUnknownId;
  Pose pose;
  Twist twist;
  Twist wheels{};  // velocities of the wheels by the commands alone
};
using Players = FixedVector<Player, kMaxRobotsPerTeam>;

using Places = FixedVector<Vector2, kMaxRobotsPerTeam>;
/// Computes the places of the supporters, the most important first: behind the attacker on the inner side, between ball
/// and own goal, then distributed over the field. The distance between two places is large enough for robots to pass.
void supporter_places(const PushPlan& plan, const FieldParameters& field, const PlayParameters& play, std::size_t count,
                      Places& out);

/// Assigns goalkeeper, attacker and supporters. A robot keeps its role until another one is better by more than the
/// hysteresis, so two equally good robots do not swap roles in every frame.
class Roles {
 public:
  void reset();
  /// `plan` is null if there is no ball; then there is no attacker and no supporter.
  void assign(const Players& players, const PushPlan* plan, const FieldParameters& field, const PlayParameters& play);

  [[nodiscard]] RobotId goalkeeper() const { return goalkeeper_; }
  [[nodiscard]] RobotId attacker() const { return attacker_; }
  /// Returns null if this robot has no place.
  [[nodiscard]] const Vector2* place_of(RobotId id) const;
  [[nodiscard]] PlayRole role_of(RobotId id) const;

 private:
  void choose_goalkeeper(const Players& players, const FieldParameters& field, const PlayParameters& play);
  void choose_attacker(const Players& players, const PushPlan& plan, const PlayParameters& play);
  void choose_supporters(const Players& players, const PlayParameters& play);

  RobotId goalkeeper_ = kUnknownId, attacker_ = kUnknownId;
  Places places_;
  std::array<RobotId, kMaxRobotsPerTeam> holder_{};  // robot of each place
  std::size_t held_ = 0;                             // number of places with a robot in the last frame
};

}  // namespace touchline
