#pragma once

#include "core/control/control_parameters.h"
#include "core/control/motion/drive_to_goal.h"
#include "core/control/motion/predicted_path.h"
#include "core/geometry/field_area.h"

namespace touchline {

/// Drives the robots of one team to their goals without contact: it compares trajectories to the goal, around obstacles
/// on both sides, and braking, each checked against the predicted motion of all others. Uses fixed memory.
class MotionPlanner {
 public:
  void configure(const ControlParameters& parameters, const FieldParameters& field);
  void reset();
  /// Begins a frame. The robots of `tracks` are the obstacles.
  void begin(const Tracks& tracks);
  /// Returns the command of robot `id`. Call it in the order of priority: a robot avoids the trajectories of the robots
  /// before it. Robots for which it was not called are expected to keep their velocity.
  Twist drive(RobotId id, const MotionState& robot, const MotionGoal& goal);
  /// Returns whether a robot may obey a command, to which all limits of the drive were applied. If control.avoid is
  /// strict, a robot must brake instead of obeying a command that could lead to a contact.
  [[nodiscard]] bool permits(RobotId id, const MotionState& robot, const Twist& command);
  /// Returns drive()'s time to a goal without obstacles.
  [[nodiscard]] double time_to(const MotionState& robot, const MotionGoal& goal) const {
    return touchline::time_to(robot, goal, parameters_.drive, area_);
  }

  /// See Pipeline::visit_state(). The rest belongs to one frame or follows from the parameters.
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    auto& [parameters, limits, area, step_s, period_s, begun, last_time, robots, memory, obstacles] = self;
    archive(period_s, begun, last_time, memory);
  }

 private:
  struct Robot {
    Team team = Team::kOwn;
    RobotId id = kUnknownId;
    MotionState state;
    PredictedPath path;
    bool is_planned = false;
  };
  struct Memory {
    RobotId id = kUnknownId;
    Vector2 via, goal;   // equal: direct
    bool used = false;   // in this frame
    bool known = false;  // via and goal are those of the last frame

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
      auto& [id, via, goal, used, known] = self;
      archive(id, via, goal, used, known);
    }
  };
  struct Choice {
    Vector2 via;
    double cost = 1e9;
    std::size_t conflict = 0;
    bool brakes = false;
    PredictedPath path;
  };

  void list_obstacles(const Robot& robot, const MotionGoal& goal);
  void consider(const PathStart& robot, const MotionGoal& goal, Vector2 via, double bonus_s, Choice& best) const;
  [[nodiscard]] Choice choose(const MotionState& robot, const MotionGoal& goal, Memory& memory) const;
  [[nodiscard]] bool may_move(const Robot& robot, const Twist& command) const;
  Memory& memory_of(RobotId id);
  Robot* find(RobotId id);

  ControlParameters parameters_;
  MotionLimits limits_{DriveParameters{}};
  MotionArea area_;
  double step_s_ = 0.1, period_s_ = 1.0 / 60.0;
  bool begun_ = false;
  Instant last_time_{};
  FixedVector<Robot, kMaxRobots> robots_;
  FixedVector<Memory, kMaxRobotsPerTeam> memory_;
  PathObstacles obstacles_;  // of the robot that is planned, the nearest first
};

}  // namespace touchline
