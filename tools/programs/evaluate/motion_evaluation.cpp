#include "tools/programs/evaluate/motion_evaluation.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>

#include "core/geometry/angle.h"
#include "core/geometry/vector2.h"

namespace touchline::evaluate {
namespace {

using hal::mock::Placement;
using hal::mock::Snapshot;

constexpr Duration kStep = std::chrono::milliseconds(1);
// Velocities are differences over 2 ms.
constexpr Duration kMargin = 2 * kStep;
// Below the first speed a robot counts as standing; the arena's robots drive at about 1 m/s.
constexpr double kRest_mps = 0.02, kFast_mps = 0.8, kFastest_mps = 1.3;
// Change of velocity within a millisecond that counts as an impact. Tires change it by 0.008 m/s at most.
constexpr double kImpact_mps = 0.3;
// Nothing moves faster than this. A larger step means that the referee has placed the ball.
constexpr double kJump_mps = 10.0;
constexpr double kNearWall_m = 0.06;
// A ball that the referee has placed is evaluated again after this time.
constexpr double kPlaced_s = 0.5;
constexpr std::size_t kFramesAfterImpact = 3;
// Names of the rows, in the order of MotionEvaluation's samples.
constexpr std::array kRows{"own robots", "opponents", "at rest", "own at 1 m/s", "opponents at 1 m/s"};
constexpr std::array kImpacts{"own robots", "opponents", "ball"};
// The last two are among the first two.
constexpr std::array kHidden{"own robots", "opponents", "own robots without impact", "opponents without impact"};
constexpr std::array kBalls{"ball", "ball within 60 mm of a wall"};
constexpr std::array kVelocities{"own robots", "opponents", "ball"};

Vector2 place(const Placement& p) { return {p.x_m, p.y_m}; }

double speed_between(const Placement& a, const Placement& b, Duration time) {
  return distance(place(a), place(b)) / seconds(time);
}

struct Samples {
  std::vector<double> sighted, sighted_angle, tracked, tracked_angle, acted, acted_angle;
  std::vector<double> nees_position, nees_angle, nis;

  [[nodiscard]] MotionRow row(const char* name) && {
    using statistics::mean;
    return {name,
            statistics::summarize(std::move(sighted)),
            statistics::summarize(std::move(sighted_angle)),
            statistics::summarize(std::move(tracked)),
            statistics::summarize(std::move(tracked_angle)),
            statistics::summarize(std::move(acted)),
            statistics::summarize(std::move(acted_angle)),
            mean(nees_position),
            mean(nees_angle),
            mean(nis)};
  }
};

struct VelocitySamples {
  std::vector<double> sighted, tracked, sighted_turn, tracked_turn;
};

struct BallSamples {
  std::vector<double> sighted, tracked, acted, nees, nis;
  std::size_t lost = 0;
};

struct HiddenSamples {
  std::vector<double> position, angle;
  std::size_t lost = 0;
};

struct ImpactSamples {
  std::array<std::vector<double>, kFramesAfterImpact> position, speed;
  std::array<std::size_t, kFramesAfterImpact> lost{};
};

// Returns the squared error of a position relative to its covariance, divided by the two degrees of freedom.
double normalized(Vector2 error, double xx, double xy, double yy) {
  const double determinant = xx * yy - xy * xy;
  return 0.5 * (yy * error.x * error.x - 2.0 * xy * error.x * error.y + xx * error.y * error.y) / determinant;
}

double square(float value) { return static_cast<double>(value) * static_cast<double>(value); }

class MotionEvaluation {
 public:
  explicit MotionEvaluation(const RecordedGame& game) : game_(game), truth_(game.truth()) {
    const std::vector<GameFrame>& frames = game.frames();
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const GameFrame& frame = frames[k];
      if (!truth_.covers(frame.capture_time, kMargin) || !truth_.covers(frame.tracks.action_time, {})) continue;
      ++report_.frames;
      before_ = truth_.at(frame.capture_time - kMargin);
      now_ = truth_.at(frame.capture_time);
      after_ = truth_.at(frame.capture_time + kMargin);
      if (k > 0 && speed_between(truth_.at(frames[k - 1].capture_time).ball, now_.ball,
                                 frame.capture_time - frames[k - 1].capture_time) > kJump_mps) {
        ball_placed_ = frame.capture_time;
      }
      add_robots(frame);
      if (!was_placed(frame)) add_ball(frame);
      if (k > 0) {
        add_impacts(k);
        add_velocities(frames[k - 1], frame);
      }
    }
    for (const hal::mock::ArenaFault& fault : game.arena().faults()) {
      if (fault.kind == hal::mock::FaultKind::kHideRobot) add_hidden(fault);
    }
  }

  MotionReport finish() && {
    for (std::size_t i = 0; i < rows_.size(); ++i) report_.robots.push_back(std::move(rows_[i]).row(kRows[i]));
    for (std::size_t i = 0; i < impacts_.size(); ++i) {
      ImpactSamples& impact = impacts_[i];
      for (std::size_t after = 0; after < kFramesAfterImpact; ++after) {
        report_.impacts.push_back({kImpacts[i], after, statistics::summarize(std::move(impact.position[after])),
                                   statistics::summarize(std::move(impact.speed[after])), impact.lost[after]});
      }
    }
    for (std::size_t i = 0; i < balls_.size(); ++i) {
      BallSamples& ball = balls_[i];
      report_.balls.push_back({kBalls[i], statistics::summarize(std::move(ball.sighted)),
                               statistics::summarize(std::move(ball.tracked)),
                               statistics::summarize(std::move(ball.acted)), ball.lost, statistics::mean(ball.nees),
                               statistics::mean(ball.nis)});
    }
    for (std::size_t i = 0; i < velocities_.size(); ++i) {
      VelocitySamples& v = velocities_[i];
      report_.velocities.push_back(
          {kVelocities[i], statistics::summarize(std::move(v.sighted)), statistics::summarize(std::move(v.tracked)),
           statistics::summarize(std::move(v.sighted_turn)), statistics::summarize(std::move(v.tracked_turn))});
    }
    const auto is_empty = [](const HiddenSamples& samples) { return samples.position.empty() && samples.lost == 0; };
    if (std::all_of(hidden_.begin(), hidden_.end(), is_empty)) return std::move(report_);
    for (std::size_t i = 0; i < hidden_.size(); ++i) {
      HiddenSamples& hidden = hidden_[i];
      const auto median = [](std::vector<double> errors) { return errors.empty() ? 0.0 : statistics::median(errors); };
      report_.hidden.push_back({kHidden[i], median(hidden.position), median(hidden.angle),
                                statistics::summarize(hidden.position), statistics::summarize(hidden.angle),
                                hidden.lost});
    }
    return std::move(report_);
  }

 private:
  [[nodiscard]] const hal::mock::ArenaRobot& robot(std::size_t i) const {
    return game_.configuration().board.arena.robot[i];
  }
  template <class Robots>
  const auto* find(const Robots& robots, std::size_t i) const {
    const Team team = robot(i).team == hal::mock::Side::kOwn ? Team::kOwn : Team::kOpponent;
    const auto found = std::find_if(robots.begin(), robots.end(), [&](const auto& one) {
      return one.team == team && static_cast<int>(one.id) == robot(i).id;
    });
    return found == robots.end() ? nullptr : &*found;
  }

  void add_robots(const GameFrame& frame) {
    const Snapshot acting = truth_.at(frame.tracks.action_time);
    for (std::size_t i = 0; i < now_.robots.size(); ++i) {
      const auto* sighting = find(frame.sightings, i);
      const auto* track = find(frame.tracks.robots, i);
      if (sighting == nullptr || track == nullptr || !sighting->has_heading) continue;
      const double speed = speed_between(before_.robots[i], after_.robots[i], 2 * kMargin);
      const bool own = robot(i).team == hal::mock::Side::kOwn;
      add_robot(rows_[own ? 0 : 1], *sighting, *track, now_.robots[i], acting.robots[i]);
      if (speed < kRest_mps) add_robot(rows_[2], *sighting, *track, now_.robots[i], acting.robots[i]);
      if (speed > kFast_mps && speed < kFastest_mps) {
        add_robot(rows_[own ? 3 : 4], *sighting, *track, now_.robots[i], acting.robots[i]);
      }
    }
  }

  static void add_robot(Samples& row, const RobotSighting& sighting, const RobotTrack& track, const Placement& truth,
                        const Placement& acting) {
    const Vector2 error = position(track.pose) - place(truth);
    const double angle = wrap_angle(heading(track.pose) - truth.theta_rad);
    row.sighted.push_back(distance(position(sighting.pose), place(truth)));
    row.sighted_angle.push_back(wrap_angle(heading(sighting.pose) - truth.theta_rad));
    row.tracked.push_back(norm(error));
    row.tracked_angle.push_back(angle);
    row.acted.push_back(distance(position(track.pose_at_action), place(acting)));
    row.acted_angle.push_back(wrap_angle(heading(track.pose_at_action) - acting.theta_rad));
    row.nees_position.push_back(
        normalized(error, square(track.sigma[0]), static_cast<double>(track.xy_covariance_m2), square(track.sigma[1])));
    row.nees_angle.push_back(angle * angle / square(track.sigma[2]));
    if (track.innovation2 >= 0.0f) row.nis.push_back(static_cast<double>(track.innovation2) / 3.0);
  }

  // Returns true if the ball was placed elsewhere shortly before, as after a goal.
  [[nodiscard]] bool was_placed(const GameFrame& frame) const {
    return ball_placed_ && seconds(frame.capture_time - *ball_placed_) <= kPlaced_s;
  }

  void add_ball(const GameFrame& frame) {
    if (!frame.ball.seen) return;
    add_ball(balls_[0], frame);
    const hal::mock::ArenaField& field = game_.configuration().board.arena.field;
    if (std::abs(now_.ball.x_m) > 0.5 * field.length_m - kNearWall_m ||
        std::abs(now_.ball.y_m) > 0.5 * field.width_m - kNearWall_m) {
      add_ball(balls_[1], frame);
    }
  }

  void add_ball(BallSamples& row, const GameFrame& frame) const {
    const BallTrack& track = frame.tracks.ball;
    row.sighted.push_back(distance(to_vector(frame.ball.position), place(now_.ball)));
    if (track.state == TrackState::kLost) {
      ++row.lost;
      return;
    }
    const double error = distance(to_vector(track.position), place(now_.ball));
    row.tracked.push_back(error);
    row.acted.push_back(distance(to_vector(track.position_at_action), place(truth_.at(frame.tracks.action_time).ball)));
    row.nees.push_back(0.5 * error * error / square(track.sigma_m));
    if (track.innovation2 >= 0.0f) row.nis.push_back(0.5 * static_cast<double>(track.innovation2));
  }

  void add_velocities(const GameFrame& last, const GameFrame& frame) {
    const double dt = seconds(frame.capture_time - last.capture_time);
    const auto velocity = [](const Placement& before, const Placement& after) {
      return (0.5 / seconds(kMargin)) * (place(after) - place(before));
    };
    for (std::size_t i = 0; i < now_.robots.size(); ++i) {
      const auto *from = find(last.sightings, i), *to = find(frame.sightings, i);
      const auto* track = find(frame.tracks.robots, i);
      if (from == nullptr || to == nullptr || track == nullptr || !from->has_heading || !to->has_heading) continue;
      VelocitySamples& row = velocities_[robot(i).team == hal::mock::Side::kOwn ? 0 : 1];
      const auto along = [](const Vector2& v, double theta) { return v.x * std::cos(theta) + v.y * std::sin(theta); };
      const double speed = along(velocity(before_.robots[i], after_.robots[i]), now_.robots[i].theta_rad);
      const double turn = 0.5 * wrap_angle(after_.robots[i].theta_rad - before_.robots[i].theta_rad) / seconds(kMargin);
      const double turned = wrap_angle(heading(to->pose) - heading(from->pose));
      const double way = along(position(to->pose) - position(from->pose), heading(from->pose) + 0.5 * turned);
      row.sighted.push_back(way / dt - speed);
      row.tracked.push_back(static_cast<double>(track->twist.v_mps) - speed);
      row.sighted_turn.push_back(turned / dt - turn);
      row.tracked_turn.push_back(static_cast<double>(track->twist.w_radps) - turn);
    }
    if (!last.ball.seen || !frame.ball.seen || was_placed(frame) || frame.tracks.ball.state == TrackState::kLost)
      return;
    const Vector2 rolls = velocity(before_.ball, after_.ball);
    const Vector2 way = to_vector(frame.ball.position) - to_vector(last.ball.position);
    velocities_[2].sighted.push_back(norm((1.0 / dt) * way - rolls));
    velocities_[2].tracked.push_back(norm(to_vector(frame.tracks.ball.velocity) - rolls));
  }

  // Returns true if the velocity of an object changes suddenly between two frames. `of` gets the object's placement
  // from a snapshot.
  template <class Of>
  bool has_impact(std::size_t frame, Of of) const {
    const Instant end = game_.frames()[frame].capture_time;
    Instant t = game_.frames()[frame - 1].capture_time;
    if (!truth_.covers(t, kStep)) return false;
    Placement a = of(truth_.at(t - kStep)), b = of(truth_.at(t));
    bool changed = false;
    for (; t < end; t += kStep) {
      const Placement c = of(truth_.at(t + kStep));
      const Vector2 change = (place(c) - place(b)) - (place(b) - place(a));
      if (speed_between(b, c, kStep) > kJump_mps) return false;
      changed = changed || norm(change) > kImpact_mps * seconds(kStep);
      a = b;
      b = c;
    }
    return changed;
  }

  // Returns true if an object was placed elsewhere between two frames.
  template <class Of>
  bool has_jump(std::size_t frame, Of of) const {
    const Instant end = game_.frames()[frame].capture_time;
    for (Instant t = game_.frames()[frame - 1].capture_time; t < end; t += kStep) {
      if (speed_between(of(truth_.at(t)), of(truth_.at(t + kStep)), kStep) > kJump_mps) return true;
    }
    return false;
  }

  // Evaluates some frames after each impact before frame k, until the next impact.
  void add_impacts(std::size_t k) {
    for (std::size_t i = 0; i < now_.robots.size(); ++i) {
      const auto of = [i](const Snapshot& s) { return s.robots[i]; };
      if (!has_impact(k, of)) continue;
      for (std::size_t after = 0; after < kFramesAfterImpact && k + after < game_.frames().size(); ++after) {
        if (after > 0 && (has_impact(k + after, of) || has_jump(k + after, of))) break;
        const GameFrame& frame = game_.frames()[k + after];
        if (!truth_.covers(frame.capture_time, kMargin)) break;
        const Placement at = of(truth_.at(frame.capture_time)), then = of(truth_.at(frame.capture_time + kMargin));
        const auto* track = find(frame.tracks.robots, i);
        const bool own = robot(i).team == hal::mock::Side::kOwn;
        // A robot's track states the velocity along its heading.
        const Vector2 velocity = (1.0 / seconds(kMargin)) * (place(then) - place(at));
        const double along = velocity.x * std::cos(at.theta_rad) + velocity.y * std::sin(at.theta_rad);
        add_impact(impacts_[own ? 0 : 1], after, at, track == nullptr ? nullptr : &track->pose.position,
                   track == nullptr ? 0.0 : static_cast<double>(track->twist.v_mps) - along);
      }
    }
    const auto of = [](const Snapshot& s) { return s.ball; };
    if (was_placed(game_.frames()[k]) || !has_impact(k, of)) return;
    for (std::size_t after = 0; after < kFramesAfterImpact && k + after < game_.frames().size(); ++after) {
      if (after > 0 && (has_impact(k + after, of) || has_jump(k + after, of))) break;
      const GameFrame& frame = game_.frames()[k + after];
      if (!truth_.covers(frame.capture_time, kMargin)) break;
      const BallTrack& track = frame.tracks.ball;
      if (!frame.ball.seen && after == 0) break;
      const Placement at = of(truth_.at(frame.capture_time)), then = of(truth_.at(frame.capture_time + kMargin));
      add_impact(impacts_[2], after, at, track.state == TrackState::kLost ? nullptr : &track.position,
                 norm(to_vector(track.velocity)) - speed_between(at, then, kMargin));
    }
  }

  // Evaluates the last frame that does not show the robot. A robot that was put elsewhere meanwhile does not count.
  void add_hidden(const hal::mock::ArenaFault& fault) {
    const auto& robots = game_.configuration().board.arena.robot;
    const auto is_it = [&](const auto& one) { return one.team == fault.team && one.id == fault.id; };
    const auto i = static_cast<std::size_t>(std::find_if(robots.begin(), robots.end(), is_it) - robots.begin());
    const auto of = [i](const Snapshot& s) { return s.robots[i]; };
    const std::vector<GameFrame>& frames = game_.frames();
    const Instant begin = game_.arena().begin() + from_seconds(fault.at_s), end = begin + from_seconds(fault.for_s);
    const auto is_before = [](const GameFrame& frame, Instant at) { return frame.capture_time < at; };
    const auto first = std::lower_bound(frames.begin(), frames.end(), begin, is_before);
    const auto after = std::lower_bound(frames.begin(), frames.end(), end, is_before);
    if (first == frames.begin() || after == frames.end() || first == after) return;
    const GameFrame& last = *(after - 1);
    if (!truth_.covers(begin, kMargin)) return;
    if (speed_between(of(truth_.at(begin - kMargin)), of(truth_.at(begin)), kMargin) < kRest_mps) return;
    bool touched = false;
    for (auto frame = first; frame != after; ++frame) {
      const auto k = static_cast<std::size_t>(frame - frames.begin());
      if (has_jump(k, of)) return;
      touched = touched || has_impact(k, of);
    }
    const auto* track = find(last.tracks.robots, i);
    const Placement truth = of(truth_.at(last.capture_time));
    const std::size_t row = fault.team == hal::mock::Side::kOwn ? 0 : 1;
    for (HiddenSamples* samples : {&hidden_[row], touched ? nullptr : &hidden_[row + 2]}) {
      if (samples == nullptr) continue;
      if (track == nullptr) {
        ++samples->lost;
        continue;
      }
      samples->position.push_back(distance(position(track->pose), place(truth)));
      samples->angle.push_back(std::abs(wrap_angle(heading(track->pose) - truth.theta_rad)));
    }
  }

  static void add_impact(ImpactSamples& row, std::size_t after, const Placement& at, const FieldPoint* tracked,
                         double speed_error_mps) {
    if (tracked == nullptr) {
      ++row.lost[after];
      return;
    }
    row.position[after].push_back(distance(to_vector(*tracked), place(at)));
    row.speed[after].push_back(speed_error_mps);
  }

  const RecordedGame& game_;
  const RecordingClock& truth_;
  Snapshot before_, now_, after_;
  std::optional<Instant> ball_placed_;
  std::array<Samples, kRows.size()> rows_;
  std::array<ImpactSamples, kImpacts.size()> impacts_;
  std::array<BallSamples, kBalls.size()> balls_;
  std::array<HiddenSamples, kHidden.size()> hidden_;
  std::array<VelocitySamples, kVelocities.size()> velocities_;
  MotionReport report_;
};

}  // namespace

MotionReport evaluate_motion(const RecordedGame& game) { return MotionEvaluation(game).finish(); }

}  // namespace touchline::evaluate
