#include "core/control/play_table.h"

#include <array>

#include "core/control/skills.h"

namespace touchline {
namespace {

// --- situations and conditions -------------------------------------------------------------------------------------

bool always(const Scene& /*scene*/) { return true; }
bool ball_in_own_half(const Scene& scene) { return scene.ball.x <= 0.0; }
bool ball_in_far_half(const Scene& scene) { return scene.ball.x > 0.0; }

bool otherwise(const Task& /*task*/) { return true; }
bool ball_unknown(const Task& task) { return !task.scene.ball_known; }

bool ball_in_own_area(const Task& task) {
  return task.scene.goalkeeper_plays && task.scene.pitch.in_own_area(task.scene.ball, 0.0);
}

bool sooner_at_a_resting_ball(const Task& task) {
  constexpr double kSlowMps = 0.3, kSoonerS = 0.25;
  return ball_in_own_area(task) && norm(task.scene.ball_velocity) < kSlowMps &&
         task.strike.contact_s + kSoonerS < task.scene.opponent_at_ball_s;
}

bool touches_ball(const Task& task) {
  // The corners of a turning robot reach farther than its sides.
  return distance(position(task.player.pose), task.scene.ball) < 1.5 * task.scene.pitch.contact_m();
}

bool touches_ball_in_own_area(const Task& task) {
  return ball_in_own_area(task) &&
         distance(position(task.player.pose), task.scene.ball) < task.scene.pitch.contact_m() + 0.015;
}

// The ball has not moved for so long although the attacker is there.
bool jammed(const Task& task) { return task.scene.ball_stays_s > kJamS && touches_ball(task); }
bool jammed_long(const Task& task) { return task.scene.ball_stays_s > kSpinS; }

// --- the play --------------------------------------------------------------------------------------------------------

constexpr std::array kJobs{
    JobLine{Job::kAttack, always, nullptr, 4.0, "attack"},
    JobLine{Job::kCover, always, cover, 2.0, "cover"},
    JobLine{Job::kSupport, ball_in_far_half, support, 1.0, "support"},
    JobLine{Job::kBackUp, always, back_up, 1.0, "back up"},
    JobLine{Job::kSupport, ball_in_own_half, support, 1.0, "support"},
    JobLine{Job::kMark, always, mark<0>, 1.0, "mark"},
    JobLine{Job::kMark, always, mark<1>, 1.0, "mark"},
    JobLine{Job::kMark, always, mark<2>, 1.0, "mark"},
    JobLine{Job::kMark, always, mark<3>, 1.0, "mark"},
    JobLine{Job::kMark, always, mark<4>, 1.0, "mark"},
    JobLine{Job::kMark, always, mark<5>, 1.0, "mark"},
};

constexpr std::array kSkills{
    SkillLine{Job::kKeep, ball_unknown, keep_middle, "keep the middle", "the ball was not seen yet"},
    SkillLine{Job::kKeep, touches_ball_in_own_area, clear_by_spin, "clear by a spin",
              "touches the ball in the own area"},
    SkillLine{Job::kKeep, sooner_at_a_resting_ball, strike, "strike", "sooner at the resting ball than the opponents"},
    SkillLine{Job::kKeep, otherwise, keep, "keep", "between ball and goal, on the line"},

    SkillLine{Job::kAttack, jammed_long, back_off, "back off", "the ball is jammed, spinning did not help"},
    SkillLine{Job::kAttack, jammed, spin, "spin", "the ball is jammed"},
    SkillLine{Job::kAttack, ball_in_own_area, wait_outside, "wait outside", "the goalkeeper plays the ball"},
    SkillLine{Job::kAttack, otherwise, strike, "strike", "first at a usable contact"},

    SkillLine{Job::kCover, otherwise, go_to_place, "cover", "between ball and own goal"},
    SkillLine{Job::kBackUp, otherwise, go_to_place, "back up", "behind the attacker"},
    SkillLine{Job::kSupport, otherwise, go_to_place, "support", "for rebounds"},
    SkillLine{Job::kMark, otherwise, go_to_place, "mark", "beside a dangerous opponent"},
};

}  // namespace

std::span<const JobLine> job_table() { return kJobs; }
std::span<const SkillLine> skill_table() { return kSkills; }

}  // namespace touchline
