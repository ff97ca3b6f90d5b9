#pragma once

#include "core/control/play_table.h"

// Skills: pure functions from what the play knows to a robot's motion goal, and places of jobs.
namespace touchline {

// The ball counts as jammed when it has not moved for so long although the attacker is there; then the attacker spins.
// If this does not help either, it leaves the ball until kBackOffS, and another robot may take over.
inline constexpr double kJamS = 0.4, kSpinS = 0.9, kBackOffS = 1.2;

/// Drives through the ball along the planned contact.
SkillGoal strike(const Task& task);
/// Spins at the ball so that the touching side moves it the better way.
SkillGoal spin(const Task& task);
/// Leaves the ball and the walls, so that the next approach begins elsewhere.
SkillGoal back_off(const Task& task);
/// Waits between ball and goal, outside the own area, in which the goalkeeper plays.
SkillGoal wait_outside(const Task& task);
/// Stands at the job's place, around the ball.
SkillGoal go_to_place(const Task& task);

/// On the line, where the bisector of the angle between ball and posts crosses it, or where an approaching ball,
/// bounces included, will cross it.
SkillGoal keep(const Task& task);
SkillGoal keep_middle(const Task& task);
/// Spins so that the ball leaves the goal.
SkillGoal clear_by_spin(const Task& task);

/// Between ball and own goal, outside the own area.
Vector2 cover(const Scene& scene);
/// Behind the attacker, where a lost ball comes.
Vector2 back_up(const Scene& scene);
/// For rebounds: at the far post when the ball is in the opponents' half, else ahead on the other side.
Vector2 support(const Scene& scene);
/// Beside the rank-th most dangerous opponent, towards the own goal.
Vector2 mark_rank(const Scene& scene, std::size_t rank);
template <std::size_t rank>
Vector2 mark(const Scene& scene) {
  return mark_rank(scene, rank);
}

}  // namespace touchline
