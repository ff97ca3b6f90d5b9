#pragma once

#include "core/control/roles.h"
#include "core/control/scene.h"
#include "core/control/strategy.h"
#include "core/control/strike.h"

namespace touchline {

/// The built-in game. In each frame, the table of jobs (play_table.cpp) says what the team must do; the robots take the
/// jobs so that the sum of their times is the least; and the table of skills says how each of them drives. Before the
/// ball was seen for the first time, the goalkeeper keeps the middle and the others stand still.
class Play final : public Strategy {  // NOLINT(cppcoreguidelines-virtual-class-destructor): as Strategy says
 public:
  void configure(const ControlParameters& parameters, const FieldParameters& field) override;
  void reset() override;
  void decide(const Tracks& tracks, const Players& players, Twists& wanted) override;
  [[nodiscard]] PlayRole role_of(RobotId id) const override;
  [[nodiscard]] const PlayDecisions* decisions() const override { return &decisions_; }

  [[nodiscard]] RobotId goalkeeper() const { return goalkeeper_; }
  [[nodiscard]] RobotId attacker() const { return attacker_; }
  [[nodiscard]] const FieldParameters& field() const { return field_; }

  /// See Pipeline::visit_state(). The rest is found in each frame.
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    auto& [field, scene, options, openings, roles, goalkeeper, attacker, goalkeeper_seen, strike, ball_stayed_at, tried,
           decisions] = self;
    archive(scene, roles, goalkeeper, attacker, goalkeeper_seen, strike, ball_stayed_at, tried);
  }

 private:
  // A robot that has attacked for so long without moving the ball.
  struct Tried {
    RobotId id = kUnknownId;
    double time_s = 0.0;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
      auto& [id, time_s] = self;
      archive(id, time_s);
    }
  };
  [[nodiscard]] double tried_by(RobotId id) const;
  double add_try(RobotId id, double time_s);
  void look(const Tracks& tracks, const Players& players);
  void watch_ball();
  void choose_goalkeeper();
  void find_goalkeeper();
  void assign_jobs();
  [[nodiscard]] double blocked_time(const Player& player, Vector2 place) const;
  // Sets the lines of the tables in `decision`.
  [[nodiscard]] SkillGoal goal_of(const Player& player, PlayDecision& decision);
  // Returns the time of a robot's opening as it was estimated; negative: it has none.
  [[nodiscard]] float time_of(RobotId id) const;
  // Whether this robot keeps the goal now: a single robot plays in the field.
  [[nodiscard]] bool is_in_goal(RobotId id) const { return id == goalkeeper_ && scene_.goalkeeper_plays; }
  [[nodiscard]] int rank_of(RobotId id) const;
  void list_obstacles(const Player& player, const SkillGoal& goal, const Tracks& tracks, RoundObstacles& out) const;

  FieldParameters field_;
  Scene scene_;
  StrikeOptions options_;
  Openings openings_;
  Roles roles_;
  RobotId goalkeeper_ = kUnknownId, attacker_ = kUnknownId;
  Instant goalkeeper_seen_{};
  Strike strike_;  // of the attacker
  Vector2 ball_stayed_at_;
  FixedVector<Tried, kMaxRobotsPerTeam> tried_;
  PlayDecisions decisions_;
};

}  // namespace touchline
