#include "core/control/line_up.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/control/motion/drive_to_goal.h"
#include "core/control/obstacle_avoidance.h"
#include "core/linear_assignment.h"

namespace touchline {
namespace {

// More than the error of a robot that has arrived, so that it stays legal there.
constexpr double kMargin = 0.05;

struct FieldSize {
  explicit FieldSize(const FieldParameters& field)
      : half_length(0.5 * static_cast<double>(field.length_m)),
        half_width(0.5 * static_cast<double>(field.width_m)),
        mouth(0.5 * static_cast<double>(field.goal_width_m)),
        area_depth(static_cast<double>(field.penalty_area_depth_m)),
        half_area(0.5 * static_cast<double>(field.penalty_area_width_m)),
        circle(static_cast<double>(field.center_circle_m)) {}

  double half_length, half_width, mouth, area_depth, half_area, circle;
};

bool is_taken_by_us(const GameSituation& situation) {
  return situation.phase == GamePhase::kPrepare && situation.restart != Restart::kNone && situation.ours;
}

// Distance that the robots keep from the ball.
double distance_to_ball(const GameSituation& situation, const ControlParameters& parameters, const FieldSize& field) {
  const double least = parameters.line_up.ball_distance_m + parameters.play.robot_radius_m;
  return situation.restart == Restart::kKickOff ? std::max(least, field.circle + parameters.play.robot_radius_m)
                                                : least;
}

Vector2 place_of_goalkeeper(const GameSituation& situation, Vector2 ball, const ControlParameters& parameters,
                            const FieldSize& field) {
  const double line = -field.half_length + parameters.play.keeper_line_m;
  if (situation.restart == Restart::kGoalKick && is_taken_by_us(situation)) {
    // The goalkeeper takes it: between the ball and the middle of the goal.
    const Vector2 to_ball = ball - Vector2{-field.half_length, 0.0};
    const double reach = norm(to_ball);
    return reach > parameters.play.clearance_m ? ball - (parameters.play.clearance_m / reach) * to_ball
                                               : Vector2{line, 0.0};
  }
  double y = std::clamp(ball.y, -field.mouth, field.mouth);
  const double least = distance_to_ball(situation, parameters, field) + kMargin, ahead = ball.x - line;
  if (situation.restart != Restart::kPenalty && std::hypot(ahead, ball.y - y) < least) {
    const double aside = std::sqrt(std::max(0.0, least * least - ahead * ahead));
    y = ball.y > 0.0 ? ball.y - aside : ball.y + aside;
  }
  return {line, y};
}

// Returns the next waypoint on the way to `target` outside of a circle: the target itself if the straight way is free,
// else the point at which a tangent touches the circle, on the shorter side that is on the field. A robot inside leaves
// the circle on its way around.
Vector2 way_around(Vector2 here, Vector2 target, Vector2 center, double radius, const FieldSize& field) {
  const Vector2 way = target - here, to_center = center - here;
  const double length = norm(way), away = norm(to_center);
  if (length < 1e-6 || away < 1e-6) return target;
  const double along = std::clamp(dot(to_center, way) / (length * length), 0.0, 1.0);
  if (distance(here + along * way, center) >= std::min(radius, away) - 1e-9) return target;
  constexpr double kMinTurn = 0.3;  // rad; a robot on the circle would otherwise touch it where it is
  const double turn = std::max(kMinTurn, std::acos(std::min(1.0, radius / away)));
  const double side = cross(here - center, target - center) >= 0.0 ? 1.0 : -1.0;
  const auto touching = [&](double direction) {
    return center +
           radius / std::cos(std::min(turn, kMinTurn)) * unit_vector(bearing(here - center) + direction * turn);
  };
  const auto is_inside = [&](Vector2 p) {
    return std::abs(p.x) < field.half_length && std::abs(p.y) < field.half_width;
  };
  return is_inside(touching(side)) || !is_inside(touching(-side)) ? touching(side) : touching(-side);
}

bool is_legal(Vector2 p, const GameSituation& situation, Vector2 ball, const ControlParameters& parameters,
              const FieldSize& field) {
  const double radius = parameters.play.robot_radius_m, wall = radius + kMargin;
  if (std::abs(p.x) > field.half_length - wall || std::abs(p.y) > field.half_width - wall) return false;
  const double own_edge = field.area_depth + radius,
               other_edge = field.area_depth + radius + parameters.line_up.area_distance_m;
  if (field.area_depth > 0.0) {
    if (p.x < -field.half_length + own_edge && std::abs(p.y) < field.half_area + radius) return false;
    const double half = field.half_area + radius + parameters.line_up.area_distance_m;
    if (p.x > field.half_length - other_edge && std::abs(p.y) < half) return false;
  }
  switch (situation.restart) {
    case Restart::kKickOff:
      return p.x <= -wall;
    case Restart::kPenalty:
      // Behind the ball as the kicker sees it.
      return situation.ours ? p.x <= ball.x - parameters.line_up.penalty_distance_m
                            : p.x >= ball.x + parameters.line_up.penalty_distance_m;
    default:
      return true;
  }
}

}  // namespace

void line_up_places(const GameSituation& situation, Vector2 ball, const ControlParameters& parameters,
                    const FieldParameters& field, std::size_t count, LineUpPlaces& out) {
  const FieldSize size(field);
  out.goalkeeper = place_of_goalkeeper(situation, ball, parameters, size);
  out.taker.reset();
  out.others.clear();
  const Vector2 goal{size.half_length, 0.0};
  if (is_taken_by_us(situation) && situation.restart != Restart::kGoalKick) {
    const Vector2 ahead = goal - ball;
    out.taker = ball - (parameters.play.clearance_m / std::max(norm(ahead), 1e-6)) * ahead;
  }
  const double apart = 2.0 * parameters.play.clearance_m;
  const auto is_free = [&](Vector2 p) {
    const auto is_near = [&](Vector2 other) { return distance(p, other) < apart; };
    return !is_near(out.goalkeeper) && std::none_of(out.others.begin(), out.others.end(), is_near);
  };
  const double home = bearing(-goal - ball);
  const double farthest = 2.0 * std::hypot(size.half_length, size.half_width);
  for (double radius = distance_to_ball(situation, parameters, size) + kMargin;
       radius < farthest && out.others.size() < count; radius += parameters.play.clearance_m) {
    // Alternately to the left and to the right, so that the places are between ball and own goal.
    const double step = apart / radius;
    const int steps = static_cast<int>(std::numbers::pi / step);
    for (int i = 0; i <= 2 * steps && out.others.size() < count; ++i) {
      const int nth = (i + 1) / 2;
      const double turn = (i % 2 == 0 ? -step : step) * nth;
      const Vector2 place = ball + radius * unit_vector(home + turn);
      if (is_legal(place, situation, ball, parameters, size) && is_free(place)) out.others.push_back(place);
    }
  }
}

void LineUp::configure(const ControlParameters& parameters, const FieldParameters& field) {
  parameters_ = parameters;
  field_ = field;
}

void LineUp::decide(const Tracks& tracks, const Players& players, const GameSituation& situation, double period_s,
                    Strategy::Twists& wanted) const {
  // Without a ball, as if it were in the center: there it is at a kick-off.
  const bool is_ball_known = tracks.ball.state == TrackState::kSeen || tracks.ball.state == TrackState::kCoasting;
  const Vector2 ball = is_ball_known ? to_vector(tracks.ball.position_at_action) : Vector2{};
  LineUpPlaces places;
  line_up_places(situation, ball, parameters_, field_, players.size(), places);
  FixedVector<Vector2, kMaxRobotsPerTeam + 2> all;
  all.push_back(places.goalkeeper);
  if (places.taker) all.push_back(*places.taker);
  for (const Vector2 place : places.others) all.push_back(place);

  // The first places must be taken, whatever the way: a place that is left free costs more than every way.
  const double far = 10.0 * (static_cast<double>(field_.length_m) + static_cast<double>(field_.width_m));
  const std::size_t robots = players.size(), columns = std::max(robots, all.size());
  const auto cost = [&](std::size_t robot, std::size_t column) {
    if (column >= all.size()) return far * static_cast<double>(columns + 1);
    const int goalkeeper = parameters_.play.goalkeeper_id;
    const bool is_wrong_goalkeeper = column == 0 && goalkeeper >= 0 && int{players[robot].id} != goalkeeper;
    return distance(position(players[robot].pose), all[column]) +
           far * static_cast<double>(is_wrong_goalkeeper ? columns + 1 : column);
  };
  constexpr std::size_t kColumns = kMaxRobotsPerTeam + 3;
  std::array<double, kMaxRobotsPerTeam + 1> row_potential{};
  std::array<double, kColumns> column_potential{}, slack{};
  std::array<std::size_t, kColumns> row_of{}, before{};
  std::array<bool, kColumns> visited{};
  solve_assignment<double>(robots, columns, cost,
                           {{row_potential.data(), robots + 1},
                            {column_potential.data(), columns + 1},
                            {slack.data(), columns + 1},
                            {row_of.data(), columns + 1},
                            {before.data(), columns + 1},
                            {visited.data(), columns + 1}});
  for (std::size_t column = 0; column < columns; ++column) {
    if (row_of[column + 1] == 0) continue;
    const std::size_t robot = row_of[column + 1] - 1;
    wanted[robot] = column < all.size() ? drive(players[robot], all[column], ball, tracks, period_s) : Twist{};
  }
}

Twist LineUp::drive(const Player& player, Vector2 place, Vector2 ball, const Tracks& tracks, double period_s) const {
  const PlayParameters& play = parameters_.play;
  const Vector2 here = position(player.pose);
  RoundObstacles obstacles;
  for (const RobotTrack& robot : tracks.robots) {
    if (robot.team == Team::kOwn && robot.id == player.id) continue;
    obstacles.push_back({.position = position(robot.pose_at_action), .clearance_m = play.clearance_m});
  }
  Vector2 next = detour(here, {}, place, obstacles, Pitch(field_, play));
  // A place inside of the circle that robots must not enter makes it smaller.
  const double circle = parameters_.line_up.ball_distance_m + play.robot_radius_m;
  next = way_around(here, next, ball, std::min(circle, distance(place, ball)), FieldSize(field_));
  DriveParameters limits = parameters_.drive;
  limits.max_speed_mps = std::min(limits.max_speed_mps, parameters_.line_up.max_speed_mps);
  // Robots stop at the points of their way, so that they do not cut its corners.
  MotionGoal goal;
  goal.place = next;
  if (distance(next, place) < 1e-9) goal.direction_rad = bearing(ball - place);
  return touchline::drive(motion_state(player.pose, player.twist, player.wheels), goal, period_s, limits);
}

}  // namespace touchline
