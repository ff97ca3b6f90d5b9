// Prints the processor time of MotionPlanner for eleven robots among 22 that drive to random goals, and of the built-in
// play with eleven robots against eleven that do so, while the ball rolls: motion-benchmark
// Other programs on the machine still disturb the caches; callgrind counts instructions without them:
//   valgrind --tool=callgrind motion-benchmark 300
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <random>
#include <vector>

#include "core/control/motion/drive_limits.h"
#include "core/control/motion/motion_planner.h"
#include "core/control/play.h"
#include "core/geometry/angle.h"

namespace touchline {
namespace {

constexpr double kPeriod = 1.0 / 60.0;
constexpr std::size_t kOwn = 11, kAll = 22;

double processor_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

struct Field {
  explicit Field(const ControlParameters& parameters) : drive_parameters(parameters.drive) {
    for (std::size_t i = 0; i < kAll; ++i) {
      MotionState state;
      state.place = place();
      state.heading_rad = 3.0 * any(random);
      robots.push_back(state);
      goals.push_back(goal(i));
    }
  }
  Vector2 place() {
    const double x = any(random);
    return {x, 0.8 * any(random)};
  }
  MotionGoal goal(std::size_t i) {
    MotionGoal goal;
    goal.place = place();
    if (i % 2 == 1) goal.direction_rad = 3.0 * any(random);
    if (i % 3 == 0) goal.end_speed_mps = 0.8;
    return goal;
  }
  void tracks(Tracks& out, int frame) const {
    out.robots.clear();
    out.capture_time = Instant{} + from_seconds(1.0 + frame * kPeriod);
    for (std::size_t i = 0; i < kAll; ++i) {
      RobotTrack track;
      track.team = i < kOwn ? Team::kOwn : Team::kOpponent;
      track.id = static_cast<RobotId>(i % kOwn);
      track.state = TrackState::kSeen;
      track.pose_at_action = {to_field_point(robots[i].place), wrap_to_float(robots[i].heading_rad)};
      track.twist_at_action = robots[i].wheels;
      out.robots.push_back(track);
    }
  }
  void obey(std::size_t i, const Twist& command) {
    MotionState& robot = robots[i];
    robot.wheels =
        wheels_after(robot.wheels, within_speed_limits(command, drive_parameters), kPeriod, drive_parameters);
    robot.v_mps = static_cast<double>(robot.wheels.v_mps);
    robot.w_radps = static_cast<double>(robot.wheels.w_radps);
    robot.heading_rad = wrap_angle(robot.heading_rad + kPeriod * robot.w_radps);
    robot.place = robot.place + kPeriod * robot.v_mps * unit_vector(robot.heading_rad);
    if (distance(robot.place, goals[i].place) < 0.04) goals[i] = goal(i);
  }

  DriveParameters drive_parameters;
  std::mt19937 random{1};
  std::uniform_real_distribution<double> any{-1.0, 1.0};
  std::vector<MotionState> robots;
  std::vector<MotionGoal> goals;
};

void print(const char* what, std::vector<double> times) {
  std::sort(times.begin(), times.end());
  const auto at = [&](double share) {
    return times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))];
  };
  std::printf("%s: median %.1f us, p99 %.1f us, maximum %.1f us\n", what, at(0.5), at(0.99), at(1.0));
}

// The ball is placed anew each second, so that it rolls most of the time.
void run_play(int frames) {
  const ControlParameters parameters;
  const auto play = std::make_unique<Play>();
  play->configure(parameters, {});
  Field field(parameters);
  const Pitch pitch({}, parameters.play, parameters.ball);
  BallState ball;
  std::vector<double> times;
  const auto tracks = std::make_unique<Tracks>();
  for (int frame = 0; frame < frames; ++frame) {
    if (frame % 60 == 0) ball = {field.place(), field.place()};
    ball = rolled(ball, kPeriod, pitch);
    field.tracks(*tracks, frame);
    tracks->ball.state = TrackState::kSeen;
    tracks->ball.position_at_action = to_field_point(ball.position);
    tracks->ball.velocity_at_action = to_field_point(ball.velocity);
    Players players;
    for (std::size_t i = 0; i < kOwn; ++i) {
      players.push_back({static_cast<RobotId>(i), tracks->robots[i].pose_at_action, tracks->robots[i].twist_at_action,
                         field.robots[i].wheels});
    }
    Strategy::Twists commands{};
    const double begin = processor_us();
    play->decide(*tracks, players, commands);
    times.push_back(processor_us() - begin);
    for (std::size_t i = 0; i < kAll; ++i) {
      field.obey(i, i < kOwn ? commands[i] : drive(field.robots[i], field.goals[i], kPeriod, parameters.drive));
    }
  }
  print("play, 11 against 11", times);
}

void run(int frames) {
  const ControlParameters parameters;
  const auto planner = std::make_unique<MotionPlanner>();
  planner->configure(parameters, {});
  Field field(parameters);
  std::vector<double> times;
  const auto tracks = std::make_unique<Tracks>();
  for (int frame = 0; frame < frames; ++frame) {
    field.tracks(*tracks, frame);
    std::array<Twist, kAll> commands{};
    const double begin = processor_us();
    planner->begin(*tracks);
    for (std::size_t i = 0; i < kOwn; ++i) {
      commands[i] = planner->drive(static_cast<RobotId>(i), field.robots[i], field.goals[i]);
    }
    times.push_back(processor_us() - begin);
    for (std::size_t i = kOwn; i < kAll; ++i) {
      commands[i] = drive(field.robots[i], field.goals[i], kPeriod, parameters.drive);
    }
    for (std::size_t i = 0; i < kAll; ++i) field.obey(i, commands[i]);
  }
  print("motion, 11 of 22 robots", times);
}

}  // namespace
}  // namespace touchline

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5000;
  touchline::run(frames);
  touchline::run_play(frames);
  return 0;
}
