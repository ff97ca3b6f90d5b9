#pragma once

#include <span>

#include "core/control/roles.h"
#include "core/control/scene.h"
#include "core/control/strike.h"

// The play as a table: which jobs the team does, and by which skill. play_table.cpp is the page to read.
namespace touchline {

/// A robot with its job in this frame.
struct Task {
  const Player& player;
  const Scene& scene;
  const Strike& strike;  // the best contact with the ball, for the attacker and the goalkeeper
  Vector2 place;         // of the job
};

/// A job of the team. The robots beside the goalkeeper take the first jobs whose situation holds.
struct JobLine {
  Job job;
  bool (*situation)(const Scene& scene);
  Vector2 (*place)(const Scene& scene);  // null: where the ball is
  double weight;                         // how much a second of its time counts in the assignment
  const char* name = "";                 // as the console's page shows it
};

/// What a robot does in its job: the first line of its job whose condition holds.
struct SkillLine {
  Job job;
  bool (*condition)(const Task& task);
  SkillGoal (*skill)(const Task& task);
  const char *name = "", *reason = "";  // as the console's page shows them; the reason says why this line holds
};

std::span<const JobLine> job_table();
std::span<const SkillLine> skill_table();

}  // namespace touchline
