#include "core/control/play.h"

#include <algorithm>
#include <cmath>

#include "core/control/play_table.h"
#include "core/control/skills.h"

namespace touchline {
namespace {

// Contacts are planned for so many robots, the soonest ones and the attacker: all that a team of five has in the field.
// Planning for all of eleven would take twice as long as everything else in the play.
constexpr std::size_t kPlanned = 4;
// A robot that needs so much longer to the ball than the soonest one will not attack, either.
constexpr double kFarS = 0.8;

// Lower bounds of the times in which robots meet the ball.
std::array<double, kMaxRobotsPerTeam> times_to_reach(const Players& players, const Scene& scene) {
  constexpr double kStepS = 0.15;
  constexpr int kSteps = 10;
  std::array<double, kMaxRobotsPerTeam> times{};
  times.fill(1e9);
  for (std::size_t k = 0; k < players.size(); ++k) {
    const Vector2 here = position(players[k].pose);
    for (int i = 0; i < kSteps; ++i) {
      const double t = i * kStepS;
      const Vector2 to = scene.path.at(t).position - here;
      times[k] = std::min(times[k], std::max(t, std::sqrt(dot(to, to)) / scene.parameters.drive.max_speed_mps));
    }
  }
  return times;
}

bool known(const BallTrack& ball) { return ball.state == TrackState::kSeen || ball.state == TrackState::kCoasting; }

}  // namespace

void Play::configure(const ControlParameters& parameters, const FieldParameters& field) {
  field_ = field;
  scene_.parameters = parameters;
  scene_.pitch = Pitch(field, parameters.play, parameters.ball);
}

void Play::reset() {
  roles_.reset();
  openings_.clear();
  goalkeeper_ = attacker_ = kUnknownId;
  tried_.clear();
  scene_.ball_known = false;
  decisions_.clear();
}

PlayRole Play::role_of(RobotId id) const {
  if (is_in_goal(id)) return PlayRole::kGoalkeeper;
  if (id == attacker_) return PlayRole::kAttacker;
  return roles_.opening_of(id) >= 0 ? PlayRole::kSupporter : PlayRole::kNone;
}

void Play::look(const Tracks& tracks, const Players& players) {
  // As long as the last commands acted; a pause is no period.
  constexpr double kShortestS = 0.004, kLongestS = 0.05;
  if (scene_.now != Instant{}) {
    scene_.period_s = std::clamp(seconds(tracks.capture_time - scene_.now), kShortestS, kLongestS);
  }
  scene_.now = tracks.capture_time;
  scene_.players = players;
  // A ball that is not seen is where it was: a robot hides it, or holds it.
  const bool seen = known(tracks.ball);
  scene_.ball_known = scene_.ball_known || seen;
  scene_.opponents.clear();
  for (const RobotTrack& robot : tracks.robots) {
    if (robot.team == Team::kOwn) {
      // Another program may drive the goalkeeper that the team file names.
      if (robot.id >= 0 && robot.id == scene_.parameters.play.goalkeeper_id) goalkeeper_seen_ = scene_.now;
      continue;
    }
    const auto v = static_cast<double>(robot.twist_at_action.v_mps);
    scene_.opponents.push_back(
        {position(robot.pose_at_action), v * unit_vector(heading(robot.pose_at_action)), std::abs(v)});
  }
  if (!scene_.ball_known) return;
  if (seen) scene_.ball = to_vector(tracks.ball.position_at_action);
  scene_.ball_velocity = seen ? to_vector(tracks.ball.velocity_at_action) : Vector2{};
  scene_.path = BallPath({scene_.ball, scene_.ball_velocity}, scene_.pitch);
  scene_.opponent_at_ball_s = 1e9;
  for (const Opponent& opponent : scene_.opponents) {
    const double way = std::max(0.0, distance(opponent.position, scene_.ball) - scene_.pitch.contact_m());
    scene_.opponent_at_ball_s = std::min(scene_.opponent_at_ball_s, 0.1 + way / 0.8);
  }
}

// A single robot plays in the field.
void Play::choose_goalkeeper() {
  find_goalkeeper();
  scene_.goalkeeper_plays = (scene_.players.size() > 1 && goalkeeper_ != kUnknownId) || !scene_.ball_known;
}

void Play::find_goalkeeper() {
  const PlayParameters& play = scene_.parameters.play;
  // A goalkeeper whose track is lost for a moment comes back.
  constexpr double kReturnS = 0.5, kBetterS = 1.0;
  if (play.goalkeeper_id >= 0) {
    const bool is_there = seconds(scene_.now - goalkeeper_seen_) <= kReturnS;
    goalkeeper_ = is_there ? static_cast<RobotId>(play.goalkeeper_id) : kUnknownId;
    return;
  }
  const SkillGoal goal{.place = {-scene_.pitch.end_m + play.keeper_line_m, 0.0}};
  RobotId best = kUnknownId;
  double least = 1e9;
  for (const Player& player : scene_.players) {
    double time = time_to(player, goal, scene_.pitch, scene_.parameters.drive);
    if (player.id == goalkeeper_) {
      goalkeeper_seen_ = scene_.now;
      time -= kBetterS;
    }
    if (time >= least) continue;
    least = time;
    best = player.id;
  }
  const bool away = seconds(scene_.now - goalkeeper_seen_) > kReturnS;
  const bool present = goalkeeper_seen_ == scene_.now;
  if (goalkeeper_ == kUnknownId || away || (present && best != goalkeeper_)) {
    goalkeeper_ = best;
    goalkeeper_seen_ = scene_.now;
  }
}

// What robots on the straight way cost, in s. Each makes a detour.
double Play::blocked_time(const Player& player, Vector2 place) const {
  constexpr double kDetourS = 0.3;
  const Vector2 here = position(player.pose), way = place - here;
  const double length = norm(way), width = 1.8 * scene_.pitch.robot_m;
  if (length < 1e-6) return 0.0;
  double time = 0.0;
  const auto add = [&](Vector2 p) {
    const double along = dot(p - here, way) / length, beside = cross(way, p - here) / length;
    if (along > 0.0 && along < length && std::abs(beside) < width) time += kDetourS;
  };
  for (const Player& other : scene_.players) {
    if (other.id != player.id) add(position(other.pose));
  }
  for (const Opponent& opponent : scene_.opponents) add(opponent.position);
  return time;
}

void Play::assign_jobs() {
  openings_.clear();
  attacker_ = scene_.ball_known ? attacker_ : kUnknownId;
  if (!scene_.ball_known) return roles_.reset();
  Players others;
  for (const Player& player : scene_.players) {
    if (player.id != goalkeeper_ || !scene_.goalkeeper_plays) others.push_back(player);
  }
  options_.find(scene_);
  const auto strike_of = [this](const Player& player) {
    return options_.best_for(player, player.id == attacker_ ? &strike_.direction_rad : nullptr, scene_);
  };
  const std::array<double, kMaxRobotsPerTeam> reach_s = times_to_reach(others, scene_);
  std::array<double, kPlanned> soonest_s{};
  std::partial_sort_copy(reach_s.begin(), reach_s.end(), soonest_s.begin(), soonest_s.end());
  const double least_reach_s = soonest_s.front(), planned_s = std::min(soonest_s.back(), least_reach_s + kFarS);
  double least_cost_s = 1e9;
  std::array<Strike, kMaxRobotsPerTeam> strikes{};
  for (const JobLine& line : job_table()) {
    if (openings_.size() == others.size()) break;
    if (!line.situation(scene_)) continue;
    Opening opening;
    opening.job = line.job;
    opening.line = static_cast<std::uint8_t>(&line - job_table().data());
    opening.weight = line.weight;
    if (line.place != nullptr) opening.place = line.place(scene_);
    for (std::size_t k = 0; k < others.size(); ++k) {
      if (line.place != nullptr) {
        opening.time_s[k] = time_to(others[k], {.place = opening.place}, scene_.pitch, scene_.parameters.drive);
        continue;
      }
      if (reach_s[k] > planned_s && others[k].id != attacker_) continue;
      strikes[k] = strike_of(others[k]);
      least_cost_s = std::min(least_cost_s, strikes[k].cost_s);
      opening.time_s[k] = strikes[k].cost_s + blocked_time(others[k], strikes[k].goal.place);
      // A robot that attacks in vain loses the ball to the next one: what exceeds kJamS counts as time of its own.
      opening.time_s[k] += std::max(0.0, tried_by(others[k].id) - kJamS);
    }
    for (std::size_t k = 0; line.place == nullptr && k < others.size(); ++k) {
      if (strikes[k].contact_s < 1e9) continue;
      opening.time_s[k] = least_cost_s + reach_s[k] - least_reach_s;  // too far away to plan its contact
    }
    openings_.push_back(opening);
  }
  roles_.assign(others, openings_, scene_.parameters.play.hysteresis_s);
  attacker_ = roles_.holder_of(0);
  for (std::size_t k = 0; k < others.size(); ++k) {
    if (others[k].id == attacker_) strike_ = strikes[k].contact_s < 1e9 ? strikes[k] : strike_of(others[k]);
  }
}

// Measures how long each robot has attacked without moving the ball: it is at the ball, or somebody holds it. When the
// ball moves, all begin anew.
void Play::watch_ball() {
  constexpr double kMovedM = 0.03, kAtBallM = 0.2, kSlowMps = 0.1;
  if (distance(scene_.ball, ball_stayed_at_) > kMovedM) {
    ball_stayed_at_ = scene_.ball;
    tried_.clear();
  }
  double tried_s = 0.0;
  const bool waits = scene_.goalkeeper_plays && scene_.pitch.in_own_area(scene_.ball, 0.0);
  for (const Player& player : scene_.players) {
    if (player.id != attacker_ || waits) continue;
    const bool is_at_ball = distance(position(player.pose), scene_.ball) < kAtBallM;
    const bool is_held = std::abs(static_cast<double>(player.twist.v_mps)) < kSlowMps;
    tried_s = tried_by(player.id);
    if (is_at_ball || is_held) tried_s = add_try(player.id, scene_.period_s);
  }
  // After it has left the ball, the attacker tries again.
  scene_.ball_stays_s = std::fmod(tried_s, kBackOffS);
}

double Play::tried_by(RobotId id) const {
  for (const Tried& tried : tried_) {
    if (tried.id == id) return tried.time_s;
  }
  return 0.0;
}

double Play::add_try(RobotId id, double time_s) {
  for (Tried& tried : tried_) {
    if (tried.id == id) return tried.time_s += time_s;
  }
  if (!tried_.full()) tried_.push_back({id, time_s});
  return time_s;
}

// The goal of a robot by the table of skills; one that stays where it is if it has no job.
SkillGoal Play::goal_of(const Player& player, PlayDecision& decision) {
  const int opening = roles_.opening_of(player.id);
  const bool keeps = player.id == goalkeeper_ && scene_.goalkeeper_plays;
  Strike strike = strike_;
  if (keeps && scene_.ball_known && scene_.pitch.in_own_area(scene_.ball, 0.0)) {
    strike = options_.best_for(player, nullptr, scene_);
  }
  Task task{player, scene_, strike, position(player.pose)};
  Job job = keeps ? Job::kKeep : Job::kNone;
  if (opening >= 0) {
    job = openings_[static_cast<std::size_t>(opening)].job;
    task.place = openings_[static_cast<std::size_t>(opening)].place;
    decision.job_line = openings_[static_cast<std::size_t>(opening)].line;
  }
  for (const SkillLine& line : skill_table()) {
    if (line.job != job || !line.condition(task)) continue;
    decision.skill_line = static_cast<std::uint8_t>(&line - skill_table().data());
    return line.skill(task);
  }
  return {.place = task.place, .twist = Twist{}};
}

float Play::time_of(RobotId id) const {
  const int opening = roles_.opening_of(id);
  if (opening < 0) return -1.0f;
  // As assign_jobs() lists the players.
  std::size_t k = 0;
  for (const Player& player : scene_.players) {
    if (is_in_goal(player.id)) continue;
    if (player.id == id) return static_cast<float>(openings_[static_cast<std::size_t>(opening)].time_s[k]);
    ++k;
  }
  return -1.0f;
}

// Own robots with a lower rank have the right of way.
int Play::rank_of(RobotId id) const {
  if (id == kUnknownId) return 100;
  if (is_in_goal(id)) return -2;
  if (id == attacker_) return -1;
  const int opening = roles_.opening_of(id);
  return opening < 0 ? 100 : opening;
}

void Play::list_obstacles(const Player& player, const SkillGoal& goal, const Tracks& tracks,
                          RoundObstacles& out) const {
  out.clear();
  const double clearance = scene_.parameters.play.clearance_m;
  const bool attacks = player.id == attacker_;
  // In front of the own goal the others make room; on its way there the goalkeeper drives around robots, too.
  if (is_in_goal(player.id) && scene_.pitch.in_own_area(position(player.pose), 2.0 * clearance)) return;
  for (const RobotTrack& robot : tracks.robots) {
    if (robot.team == Team::kOwn && robot.id == player.id) continue;
    const Vector2 v = static_cast<double>(robot.twist_at_action.v_mps) * unit_vector(heading(robot.pose_at_action));
    const Vector2 p = position(robot.pose_at_action);
    // The attacker does not drive around opponents at the ball.
    if (attacks && robot.team == Team::kOpponent && distance(p, scene_.ball) < 2.0 * clearance) continue;
    // Nobody pushes team-mates; those with the right of way get more room.
    const bool yields = rank_of(robot.id) < rank_of(player.id);
    const double brake = robot.team == Team::kOwn ? (yields ? 3.2 : 2.7) * scene_.pitch.robot_m : 0.0;
    out.push_back({p, v, clearance, brake});
  }
  if (goal.avoid_ball) out.push_back({scene_.ball, scene_.ball_velocity, clearance, 0.0});
}

void Play::decide(const Tracks& tracks, const Players& players, Twists& wanted) {
  look(tracks, players);
  choose_goalkeeper();
  assign_jobs();
  watch_ball();
  RoundObstacles obstacles;
  decisions_.clear();
  for (std::size_t i = 0; i < players.size(); ++i) {
    PlayDecision decision;
    decision.id = players[i].id;
    decision.time_s = time_of(players[i].id);
    const SkillGoal goal = goal_of(players[i], decision);
    if (!goal.twist) decision.target = to_field_point(goal.place);
    if (goal.direction_rad) decision.direction_rad = static_cast<float>(*goal.direction_rad);
    decisions_.push_back(decision);
    list_obstacles(players[i], goal, tracks, obstacles);
    wanted[i] = drive(players[i], goal, obstacles, scene_.pitch, scene_.period_s, scene_.parameters.drive);
  }
}

}  // namespace touchline
