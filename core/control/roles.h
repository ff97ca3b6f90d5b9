#pragma once

#include <type_traits>

#include "core/control/scene.h"

namespace touchline {

/// What a robot does for the team. play_table.cpp gives the order of importance.
enum class Job : std::uint8_t { kNone, kKeep, kAttack, kCover, kBackUp, kSupport, kMark };

/// A job that somebody must do, and what it costs each player, in seconds.
struct Opening {
  Job job = Job::kNone;
  std::uint8_t line = 0;  // index in job_table()
  Vector2 place;
  double weight = 1.0;                             // of its time against that of the other jobs
  std::array<double, kMaxRobotsPerTeam> time_s{};  // by the index of the player
};
using Openings = FixedVector<Opening, kMaxRobotsPerTeam>;

/// Gives each opening to one robot with the least weighted sum of times. A robot keeps its job until a change saves
/// more than the hysteresis.
class Roles {
 public:
  void reset() { held_.clear(); }
  /// Not more openings than players.
  void assign(const Players& players, const Openings& openings, double hysteresis_s);
  /// Index in the last openings of the robot's job; negative: none.
  [[nodiscard]] int opening_of(RobotId id) const;
  [[nodiscard]] RobotId holder_of(int opening) const;

  /// See Pipeline::visit_state().
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    archive(self.held_);
  }

 private:
  struct Held {
    RobotId id = kUnknownId;
    int opening = -1;
    Job job = Job::kNone;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
      auto& [id, opening, job] = self;
      archive(id, opening, job);
      if constexpr (!std::is_const_v<Self>) {
        if (opening < -1 || opening >= static_cast<int>(kMaxRobotsPerTeam)) archive.refuse();
      }
    }
  };
  FixedVector<Held, kMaxRobotsPerTeam> held_;
};

}  // namespace touchline
