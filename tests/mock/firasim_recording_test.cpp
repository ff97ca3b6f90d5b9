// Compares the arena's physics with a recording of the league's simulator FIRASim: short pieces of it are repeated from
// the recorded positions with the recorded commands.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "core/geometry/angle.h"
#include "hal/mock/world.h"
#include "tests/mock/noise_free_arena.h"

namespace touchline::hal::mock {
namespace {

constexpr int kStepsPerRow = 16;  // FIRASim publishes every 16 ms
constexpr double kRowS = kStepsPerRow * World::kStepS;
// Base of the wheels for which the recorded commands were converted to wheel speeds.
constexpr double kCommandBaseM = 0.085;
constexpr double kHalfLengthM = 0.75, kHalfWidthM = 0.65, kHalfSideM = 0.0375, kBallRadiusM = 0.0215;

// Robots 0 to 2 are blue and are driven, 3 to 5 are yellow and stand.
struct Row {
  bool is_restart = false;
  Vector2 ball;
  std::array<Placement, 6> robots;
  std::array<double, 3> v_mps{}, w_radps{};
};
using Recording = std::vector<Row>;

Recording read_recording(const std::string& path) {
  Recording rows;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(("zcat '" + path + "'").c_str(), "r"), pclose);
  std::array<char, 1024> line{};
  if (pipe == nullptr || std::fgets(line.data(), line.size(), pipe.get()) == nullptr) return rows;
  while (std::fgets(line.data(), line.size(), pipe.get()) != nullptr) {
    std::istringstream cells(line.data());
    std::string cell;
    const auto next = [&] {
      std::getline(cells, cell, ',');
      return std::atof(cell.c_str());
    };
    Row row;
    next();
    next();
    row.is_restart = !cell.empty();
    row.ball.x = next();
    row.ball.y = next();
    for (Placement& robot : row.robots) {
      robot.x_m = next();
      robot.y_m = next();
      robot.theta_rad = next();
    }
    for (std::size_t i = 0; i < 3; ++i) {
      row.v_mps[i] = next();
      row.w_radps[i] = next();
      next();
    }
    rows.push_back(row);
  }
  return rows;
}

Vector2 heading_of(const Placement& placement) { return unit_vector(placement.theta_rad); }

// Mean velocities between two rows.
Vector2 ball_velocity(const Recording& rows, std::size_t from, std::size_t to) {
  return 1.0 / (static_cast<double>(to - from) * kRowS) * (rows[to].ball - rows[from].ball);
}
// Velocity of a robot at a row, extrapolated from the rows before.
Vector2 velocity(const Recording& rows, std::size_t robot, std::size_t row) {
  const auto at = [&](std::size_t back) { return position(rows[row - back].robots[robot]); };
  return 0.5 / kRowS * (3.0 * (at(0) - at(1)) - (at(1) - at(2)));
}
double turn(const Recording& rows, std::size_t robot, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (std::size_t i = from; i < to; ++i) {
    sum += wrap_angle(rows[i + 1].robots[robot].theta_rad - rows[i].robots[robot].theta_rad);
  }
  return sum;
}
double speed_ahead(const Recording& rows, std::size_t robot, std::size_t row) {
  return dot(position(rows[row].robots[robot]) - position(rows[row - 1].robots[robot]),
             heading_of(rows[row].robots[robot])) /
         kRowS;
}

ArenaParameters arena_of(ArenaPreset preset) {
  ArenaParameters parameters;
  apply_preset(preset, parameters);
  parameters.physics.wheel_error = parameters.physics.wheel_slip = parameters.physics.floor_roughness_mps_rts = 0.0;
  // The corner pieces follow from the boxes in src/sslworld.cpp.
  parameters.field = {
      .length_m = 2.0 * kHalfLengthM, .width_m = 2.0 * kHalfWidthM, .goal_depth_m = 0.1, .corner_m = 0.082};
  parameters.opponents = Opponents::kStand;
  parameters.robot.clear();
  for (int i = 0; i < 6; ++i) {
    parameters.robot.push_back({i < 3 ? Side::kOwn : Side::kOpponent, i % 3, -0.5 + 0.2 * i, 0.0, 0.0, {"red"}});
  }
  return parameters;
}

/// Repeats `count` rows after `begin` in the arena; the result has the row `begin`, too, at index 1, after the one
/// before.
Recording repeat(const ArenaParameters& parameters, const Recording& rows, std::size_t begin, std::size_t count) {
  World world(parameters, 1);
  const Row& start = rows[begin];
  for (std::size_t i = 0; i < start.robots.size(); ++i) {
    world.place(i, start.robots[i], velocity(rows, i, begin), turn(rows, i, begin - 1, begin) / kRowS);
  }
  world.place_ball({start.ball.x, start.ball.y, 0.0}, ball_velocity(rows, begin - 1, begin));
  Recording out{rows[begin - 1], start};
  for (std::size_t k = begin; k < begin + count; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double half = 0.5 * kCommandBaseM * rows[k].w_radps[i];
      world.drive(static_cast<int>(i), rows[k].v_mps[i] - half, rows[k].v_mps[i] + half);
    }
    for (int step = 0; step < kStepsPerRow; ++step) world.step();
    const Snapshot now = world.snapshot();
    Row row;
    row.ball = {now.ball.x_m, now.ball.y_m};
    std::copy(now.robots.begin(), now.robots.end(), row.robots.begin());
    out.push_back(row);
  }
  return out;
}

// ---- Pieces of the recording in which one thing happens ----

double distance_to_robots(const Recording& rows, std::size_t row, std::size_t first, std::size_t last,
                          std::size_t except = 9) {
  double least = 1e9;
  for (std::size_t i = first; i <= last; ++i) {
    if (i != except) least = std::min(least, length(position(rows[row].robots[i]) - rows[row].ball));
  }
  return least;
}

bool is_robot_free(const Recording& rows, std::size_t robot, std::size_t row) {
  const Vector2 at = position(rows[row].robots[robot]);
  if (std::abs(at.x) > kHalfLengthM - 0.07 || std::abs(at.y) > kHalfWidthM - 0.055) return false;
  for (std::size_t i = 0; i < 6; ++i) {
    if (i != robot && length(position(rows[row].robots[i]) - at) < 0.12) return false;
  }
  return length(rows[row].ball - at) > 0.085;
}

bool is_ball_free(const Recording& rows, std::size_t row) {
  const double x = kHalfLengthM - std::abs(rows[row].ball.x), y = kHalfWidthM - std::abs(rows[row].ball.y);
  return x > 0.03 && y > 0.03 && x + y > 0.13 && distance_to_robots(rows, row, 0, 5) > 0.083;
}

template <class Predicate>
bool holds(std::size_t begin, std::size_t end, Predicate predicate) {
  for (std::size_t i = begin; i < end; ++i) {
    if (!predicate(i)) return false;
  }
  return true;
}

// A figure is a sum over all pieces that `begins_at` accepts, of `measure` after `rows` rows. `measure` gets rows of
// which the piece begins at the given index.
struct Figure {
  std::string name;
  std::size_t rows = 0;
  double tolerance = 0.1;
  std::function<bool(const Recording&, std::size_t begin, std::size_t robot)> begins_at;
  std::function<double(const Recording&, std::size_t begin, std::size_t robot)> measure;
};

struct Comparison {
  std::size_t pieces = 0;
  double recorded = 0.0;
  std::array<double, 2> arena{};  // with presets mirosot and firasim
};

Comparison compare(const Figure& figure, const Recording& rows) {
  Comparison out;
  const std::array<ArenaParameters, 2> arenas{arena_of(ArenaPreset::kMirosot), arena_of(ArenaPreset::kFirasim)};
  for (std::size_t robot = 0; robot < 3; ++robot) {
    for (std::size_t i = 10; i + figure.rows + 10 < rows.size(); ++i) {
      const bool restarts = !holds(i - 8, i + figure.rows + 4, [&](std::size_t k) { return !rows[k].is_restart; });
      if (restarts || !figure.begins_at(rows, i, robot)) continue;
      // The start decides the sign.
      const double recorded = figure.measure(rows, i, robot), sign = recorded < 0.0 ? -1.0 : 1.0;
      out.recorded += sign * recorded;
      for (std::size_t k = 0; k < arenas.size(); ++k) {
        out.arena[k] += sign * figure.measure(repeat(arenas[k], rows, i, figure.rows), 1, robot);
      }
      ++out.pieces;
      i += figure.rows;
    }
  }
  return out;
}

// ---- Figures ----

double moved_ahead(const Recording& rows, std::size_t robot, std::size_t from, std::size_t to) {
  return dot(position(rows[to].robots[robot]) - position(rows[from].robots[robot]),
             heading_of(rows[from].robots[robot]));
}

bool starts_from_rest(const Recording& rows, std::size_t i, std::size_t robot, std::size_t count) {
  return std::abs(speed_ahead(rows, robot, i)) < 0.03 && std::abs(rows[i - 1].v_mps[robot]) < 0.01 &&
         std::abs(rows[i].v_mps[robot]) > 0.04 && std::abs(rows[i + 5].v_mps[robot]) > 0.3 &&
         holds(i - 1, i + count,
               [&](std::size_t k) { return is_robot_free(rows, robot, k) && std::abs(rows[k].w_radps[robot]) < 1.0; });
}

bool stops(const Recording& rows, std::size_t i, std::size_t robot, std::size_t count) {
  return std::abs(speed_ahead(rows, robot, i)) > 0.15 && holds(i, i + count, [&](std::size_t k) {
           return is_robot_free(rows, robot, k) && rows[k].v_mps[robot] == 0.0 && rows[k].w_radps[robot] == 0.0;
         });
}

bool starts_to_turn(const Recording& rows, std::size_t i, std::size_t robot, std::size_t count) {
  return std::abs(turn(rows, robot, i - 2, i)) < 0.01 && std::abs(rows[i - 1].w_radps[robot]) < 0.3 &&
         std::abs(rows[i + 5].w_radps[robot]) > 4.0 && holds(i - 1, i + count, [&](std::size_t k) {
           return is_robot_free(rows, robot, k) && std::abs(rows[k].v_mps[robot]) < 0.3;
         });
}

bool is_driven(const Recording& rows, std::size_t i, std::size_t robot, std::size_t count) {
  return holds(i - 1, i + count, [&](std::size_t k) { return is_robot_free(rows, robot, k); }) &&
         std::abs(rows[i + count - 1].v_mps[robot]) > 0.1;
}

bool is_turned(const Recording& rows, std::size_t i, std::size_t robot, std::size_t count) {
  return is_driven(rows, i, robot, count) && std::abs(rows[i + count / 2].w_radps[robot]) > 2.0;
}

// The robots are so far away that none reaches the ball with another preset, either.
bool rolls_freely(const Recording& rows, std::size_t i, std::size_t robot, std::size_t count) {
  const auto is_alone = [&](std::size_t k) {
    return is_ball_free(rows, k) && distance_to_robots(rows, k, 0, 5) > 0.15;
  };
  return robot == 0 && holds(i - 2, i + count, is_alone) && length(ball_velocity(rows, i, i + 3)) > 0.1;
}

Vector2 ball_in_robot(const Recording& rows, std::size_t row, std::size_t robot) {
  const Vector2 ahead = heading_of(rows[row].robots[robot]), way = rows[row].ball - position(rows[row].robots[robot]);
  return {dot(way, ahead), cross(ahead, way)};
}

// The robot drives with the ball at its front or back.
bool pushes(const Recording& rows, std::size_t i, std::size_t robot, std::size_t count) {
  return speed_ahead(rows, robot, i) * ball_in_robot(rows, i, robot).x > 0.15 * kHalfSideM &&
         holds(i - 1, i + count, [&](std::size_t k) {
           const Vector2 at = ball_in_robot(rows, k, robot);
           return std::abs(at.x) < kHalfSideM + kBallRadiusM + 0.001 && std::abs(at.y) < 0.03 &&
                  std::abs(rows[k].ball.x) < 0.65 && std::abs(rows[k].ball.y) < 0.55 &&
                  distance_to_robots(rows, k, 0, 5, robot) > 0.09;
         });
}

bool accelerates_ball(const Recording& rows, std::size_t i, std::size_t robot, std::size_t count) {
  return pushes(rows, i, robot, count) && holds(i, i + count, [&](std::size_t k) {
           const double missing = rows[k].v_mps[robot] - speed_ahead(rows, robot, k);
           return missing * speed_ahead(rows, robot, i) > 0.0 && std::abs(missing) > 0.15 &&
                  std::abs(rows[k].w_radps[robot]) < 4.0;
         });
}

bool hits_ball(const Recording& rows, std::size_t i, std::size_t robot, std::size_t count) {
  return length(ball_velocity(rows, i - 2, i)) < 0.02 && length(ball_velocity(rows, i + 3, i + 4)) > 0.15 &&
         std::abs(ball_in_robot(rows, i, robot).y) < 0.035 && distance_to_robots(rows, i, robot, robot) < 0.1 &&
         holds(i, i + count, [&](std::size_t k) {
           return std::abs(rows[k].ball.x) < 0.68 && std::abs(rows[k].ball.y) < 0.58 &&
                  distance_to_robots(rows, k, 0, 5, robot) > 0.09;
         });
}

// The inward normal of the wall that the ball bounces off; zero: none.
Vector2 wall_of_bounce(const Recording& rows, std::size_t i, std::size_t count) {
  const Vector2 at = rows[i + 3].ball, before = ball_velocity(rows, i - 2, i),
                after = ball_velocity(rows, i + count - 3, i + count);
  const bool is_far = holds(i - 2, i + count, [&](std::size_t k) { return distance_to_robots(rows, k, 0, 5) > 0.085; });
  const double x = kHalfLengthM - std::abs(at.x), y = kHalfWidthM - std::abs(at.y);
  if (!is_far || x + y < 0.15) return {};
  const Vector2 normal = x < y ? Vector2{at.x > 0.0 ? -1.0 : 1.0, 0.0} : Vector2{0.0, at.y > 0.0 ? -1.0 : 1.0};
  const bool is_goal = x < y && std::abs(at.y) < 0.2 + kBallRadiusM;
  return std::min(x, y) < 0.04 && !is_goal && dot(before, normal) < -0.1 && dot(after, normal) > 0.0 ? normal
                                                                                                     : Vector2{};
}

// Bounces begin 3 rows before the wall's contact at the latest, so that the velocity before it is known.
bool bounces_off_wall(const Recording& rows, std::size_t i, std::size_t robot, std::size_t count) {
  return robot == 0 && length(wall_of_bounce(rows, i, count)) > 0.0;
}
Vector2 wall_near(const Recording& rows, std::size_t i) {
  const Vector2 at = rows[i].ball;
  return kHalfLengthM - std::abs(at.x) < kHalfWidthM - std::abs(at.y) ? Vector2{at.x > 0.0 ? -1.0 : 1.0, 0.0}
                                                                      : Vector2{0.0, at.y > 0.0 ? -1.0 : 1.0};
}

std::size_t nearest_standing(const Recording& rows, std::size_t row, Vector2 point) {
  std::size_t nearest = 3;
  for (std::size_t i = 4; i < 6; ++i) {
    if (length(position(rows[row].robots[i]) - point) < length(position(rows[row].robots[nearest]) - point))
      nearest = i;
  }
  return nearest;
}

bool bounces_off_robot(const Recording& rows, std::size_t i, std::size_t robot, std::size_t count) {
  const Vector2 change = ball_velocity(rows, i + count - 3, i + count) - ball_velocity(rows, i - 2, i);
  return robot == 0 && distance_to_robots(rows, i, 3, 5) > 0.07 && distance_to_robots(rows, i + 3, 3, 5) < 0.08 &&
         length(change) > 0.1 &&
         holds(i - 2, i + count, [&](std::size_t k) { return distance_to_robots(rows, k, 0, 2) > 0.1; });
}

bool runs_into_robot(const Recording& rows, std::size_t i, std::size_t robot, std::size_t count) {
  const Vector2 at = position(rows[i].robots[robot]);
  const Vector2 way = position(rows[i].robots[nearest_standing(rows, i, at)]) - at;
  return length(way) < 0.095 && dot(way, velocity(rows, robot, i)) > 0.1 * length(way) &&
         holds(i, i + count, [&](std::size_t k) { return distance_to_robots(rows, k, 0, 5) > 0.09; }) &&
         length(position(rows[i + count].robots[nearest_standing(rows, i, at)]) -
                position(rows[i].robots[nearest_standing(rows, i, at)])) > 0.003;
}

std::vector<Figure> figures() {
  const auto after = [](std::size_t rows, auto condition) {
    return [rows, condition](const Recording& all, std::size_t i, std::size_t robot) {
      return condition(all, i, robot, rows);
    };
  };
  const auto ahead_after = [](std::size_t n) {
    return [n](const Recording& rows, std::size_t i, std::size_t robot) { return moved_ahead(rows, robot, i, i + n); };
  };
  const auto turn_after = [](std::size_t n) {
    return [n](const Recording& rows, std::size_t i, std::size_t robot) { return turn(rows, robot, i, i + n); };
  };
  const auto speed_after = [](std::size_t n) {
    return [n](const Recording& rows, std::size_t i, std::size_t robot) { return speed_ahead(rows, robot, i + n); };
  };
  const auto ball_after = [](std::size_t n) {
    return [n](const Recording& rows, std::size_t i, std::size_t) {
      return length(ball_velocity(rows, i + n - 2, i + n));
    };
  };
  std::vector<Figure> all;
  all.push_back({"start from rest: speed after 0.1 s", 6, 0.1, after(6, starts_from_rest), speed_after(6)});
  all.push_back({"start from rest: speed after 0.2 s", 12, 0.1, after(12, starts_from_rest), speed_after(12)});
  all.push_back({"stop: way in 0.03 s", 2, 0.1, after(2, stops), ahead_after(2)});
  all.push_back({"start to turn: angle after 0.03 s", 2, 0.1, after(2, starts_to_turn), turn_after(2)});
  all.push_back({"start to turn: angle after 0.1 s", 6, 0.1, after(6, starts_to_turn), turn_after(6)});
  all.push_back({"drive and turn: way in 0.3 s", 18, 0.1, after(18, is_driven), ahead_after(18)});
  all.push_back({"drive and turn: angle after 0.3 s", 18, 0.1, after(18, is_turned), turn_after(18)});
  all.push_back({"free ball: loss of speed in 0.5 s", 30, 0.1, after(30, rolls_freely),
                 [](const Recording& rows, std::size_t i, std::size_t) {
                   return length(ball_velocity(rows, i, i + 3)) - length(ball_velocity(rows, i + 27, i + 30));
                 }});
  all.push_back({"ball hit by a robot: speed after 0.13 s", 8, 0.1, after(8, hits_ball), ball_after(8)});
  all.push_back({"ball pushed for 0.1 s: its speed", 6, 0.1, after(6, pushes), ball_after(6)});
  all.push_back({"ball pushed for 0.1 s: the robot's gain", 6, 0.1, after(6, accelerates_ball),
                 [](const Recording& rows, std::size_t i, std::size_t robot) {
                   return speed_ahead(rows, robot, i + 6) - speed_ahead(rows, robot, i);
                 }});
  all.push_back({"ball off a wall: speed across, 0.15 s later", 10, 0.1, after(10, bounces_off_wall),
                 [](const Recording& rows, std::size_t i, std::size_t) {
                   return dot(ball_velocity(rows, i + 7, i + 10), wall_near(rows, i));
                 }});
  // The speed along the wall also depends on the spin about the vertical axis, which is not recorded, and which moves a
  // slow ball more than the friction does.
  all.push_back({"ball off a wall: speed along, 0.15 s later", 10, 0.1,
                 [](const Recording& rows, std::size_t i, std::size_t robot) {
                   return bounces_off_wall(rows, i, robot, 10) &&
                          std::abs(cross(ball_velocity(rows, i - 2, i), wall_near(rows, i))) > 0.1;
                 },
                 [](const Recording& rows, std::size_t i, std::size_t) {
                   return cross(ball_velocity(rows, i + 7, i + 10), wall_near(rows, i));
                 }});
  all.push_back({"ball off a standing robot: change of speed", 10, 0.1, after(10, bounces_off_robot),
                 [](const Recording& rows, std::size_t i, std::size_t) {
                   return length(ball_velocity(rows, i + 7, i + 10) - ball_velocity(rows, i - 1, i));
                 }});
  all.push_back({"robot at a standing robot: its way in 0.2 s", 12, 0.1, after(12, runs_into_robot), ahead_after(12)});
  all.push_back({"robot at a standing robot: the other's way", 12, 0.1, after(12, runs_into_robot),
                 [](const Recording& rows, std::size_t i, std::size_t robot) {
                   const std::size_t other = nearest_standing(rows, i, position(rows[i].robots[robot]));
                   return length(position(rows[i + 12].robots[other]) - position(rows[i].robots[other]));
                 }});
  return all;
}

TEST(FirasimRecording, IsRepeatedByTheArenaWithItsPreset) {
  const char* shared = std::getenv("TOUCHLINE_SHARED");  // NOLINT(concurrency-mt-unsafe): one thread
  if (shared == nullptr) GTEST_SKIP() << "TOUCHLINE_SHARED does not name the folder with firasim/";
  const Recording rows = read_recording(std::string(shared) + "/firasim/standing-opponents.csv.gz");
  ASSERT_GT(rows.size(), 7000U);
  std::printf("%-44s %6s %9s %18s %18s\n", "mean of", "pieces", "FIRASim", "mirosot", "firasim");
  for (const Figure& figure : figures()) {
    const Comparison result = compare(figure, rows);
    const double pieces = static_cast<double>(result.pieces);
    std::printf("%-44s %6zu %9.4f", figure.name.c_str(), result.pieces, result.recorded / pieces);
    for (const double value : result.arena) {
      std::printf(" %9.4f (%+4.0f %%)", value / pieces, 100.0 * (value / result.recorded - 1.0));
    }
    std::printf("\n");
    EXPECT_GE(result.pieces, 3U) << figure.name;
    EXPECT_NEAR(result.arena.back() / result.recorded, 1.0, figure.tolerance) << figure.name;
  }
}

}  // namespace
}  // namespace touchline::hal::mock
