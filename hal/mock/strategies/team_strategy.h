#pragma once

#include "core/control/strategy.h"
#include "core/geometry/vector2.h"
#include "hal/mock/strategies/drive_law.h"
#include "hal/mock/strategies/jam_release.h"
#include "hal/mock/strategies/team_roles.h"

namespace touchline::hal::mock {

/// What a reference opponent knows in a frame, at the time when the commands act.
struct Scene {
  const Tracks& tracks;
  const Players& players;
  bool ball_known = false;
  Vector2 ball{}, ball_velocity{};  // zero if the ball is not known
  double frame_s = 0.0;             // time since the last frame, at most 0.1 s
};

/// A team of goalkeeper, attacker and assistants: the base of the reference opponents. It assigns the roles, asks for
/// the velocities of each robot, and frees robots that are jammed.
class TeamStrategy : public Strategy {
 public:
  virtual ~TeamStrategy() = default;

  void configure(const ControlParameters& parameters, const FieldParameters& field) final;
  void reset() final;
  void decide(const Tracks& tracks, const Players& players, Twists& wanted) final;
  [[nodiscard]] PlayRole role_of(RobotId id) const final { return roles_.role_of(id); }

 protected:
  /// Prepares the decisions of a frame.
  virtual void begin(const Scene& /*scene*/) {}
  /// Returns the velocities of a robot that is not the goalkeeper. Called in the order of the players.
  virtual Twist move(const Player& player, const Scene& scene) = 0;
  /// Returns the velocities of the goalkeeper.
  virtual Twist keep(const Player& player, const Scene& scene) { return guard_goal(player, scene, max_speed_mps()); }
  /// Forgets the game so far.
  virtual void forget() {}

  /// Keeps the goal line: follows the ball, or the place at which an approaching ball will cross the line, and hits a
  /// near ball by spinning.
  [[nodiscard]] Twist guard_goal(const Player& player, const Scene& scene, double speed_mps) const;
  /// Slows down where a robot that decelerates by 4 m/s^2, after the delay of camera and radio, stops at the target.
  [[nodiscard]] DriveLaw stopping_law(double speed_mps) const;
  /// Turns on the spot until the heading is along the direction, or opposite to it.
  [[nodiscard]] static Twist turn_along(const Pose& robot, double direction_rad);
  /// Returns the point moved into the field, at this distance from the walls.
  [[nodiscard]] Vector2 inside(Vector2 p, double margin_m) const;

  [[nodiscard]] const TeamRoles& roles() const { return roles_; }
  [[nodiscard]] const FieldParameters& field() const { return field_; }
  [[nodiscard]] double half_length_m() const { return 0.5 * static_cast<double>(field_.length_m); }
  [[nodiscard]] double half_width_m() const { return 0.5 * static_cast<double>(field_.width_m); }
  [[nodiscard]] double half_goal_m() const { return 0.5 * static_cast<double>(field_.goal_width_m); }
  [[nodiscard]] Vector2 own_goal() const { return {-half_length_m(), 0.0}; }
  [[nodiscard]] Vector2 far_goal() const { return {half_length_m(), 0.0}; }
  /// Ratio of the robots' size to that of a VSSS or MiroSot robot of 75 mm, for which the published teams state
  /// lengths.
  [[nodiscard]] double scale() const { return radius_m_ / 0.0375; }
  /// Half the side of a robot.
  [[nodiscard]] double radius_m() const { return radius_m_; }
  /// Speed and angular velocity that the team's drive parameters allow.
  [[nodiscard]] double max_speed_mps() const { return drive_.max_speed_mps; }
  [[nodiscard]] double max_turn_radps() const { return drive_.max_turn_radps; }
  [[nodiscard]] double max_wheel_mps() const { return drive_.max_wheel_speed_mps; }
  [[nodiscard]] double wheel_base_m() const { return drive_.wheel_base_m; }

 private:
  // Delay and lag of a robot in the arena are 0.13 s together, so a faster response would oscillate.
  static constexpr double kTurnPerS = 6.0;

  FieldParameters field_;
  DriveParameters drive_;
  double radius_m_ = 0.0375;
  int goalkeeper_id_ = -1;
  TeamRoles roles_;
  JamRelease jams_;
  bool started_ = false;
  Instant last_{};
};

}  // namespace touchline::hal::mock
