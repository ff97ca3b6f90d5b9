#include "firmware/network/vss_placement.h"

#include <firmware/network/proto/vss_referee.pb.h>

#include <algorithm>
#include <numbers>

#include "core/geometry/angle.h"
#include "hal/poses/protobuf.h"

namespace touchline::network {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

// Finds places in our coordinates, those that are certain first.
class Placing {
 public:
  Placing(const RefereeState& referee, const PlacementSettings& settings, Vector2 ball)
      : restart_(referee.restart),
        ours_(referee.restart_is_ours),
        rules_(settings.sizes),
        settings_(settings),
        ball_(ball) {}

  void add(RobotId id, Vector2 here) { robots_.push_back({id, here}); }

  void place() {
    goalkeeper_ = settings_.goalkeeper;
    if (!contains(goalkeeper_)) goalkeeper_ = nearest_to({-0.5 * settings_.sizes.length_m, 0.0}, kUnknownId);
    if (ours_ || restart_ == Restart::kFreeBall) {
      taker_ = restart_ == Restart::kGoalKick ? goalkeeper_ : nearest_to(ball_, goalkeeper_);
      if (taker_ == kUnknownId) taker_ = goalkeeper_;  // the only robot
    }
    for (const Robot& robot : robots_) {
      if (const auto fixed = rules_.fixed_place(restart_, part_of(robot.id), ball_))
        placed_.push_back({robot.id, *fixed});
    }
    for (const Robot& robot : robots_) {
      if (!is_placed(robot.id)) choose(robot.id);
    }
  }

  [[nodiscard]] const PlacedRobots& placed() const { return placed_; }

 private:
  struct Robot {
    RobotId id = kUnknownId;
    Vector2 here;
  };

  [[nodiscard]] bool contains(RobotId id) const {
    return std::any_of(robots_.begin(), robots_.end(), [&](const Robot& robot) { return robot.id == id; });
  }
  [[nodiscard]] bool is_placed(RobotId id) const {
    return std::any_of(placed_.begin(), placed_.end(), [&](const PlacedRobot& robot) { return robot.id == id; });
  }
  [[nodiscard]] RobotId nearest_to(Vector2 point, RobotId except) const {
    const Robot* best = nullptr;
    for (const Robot& robot : robots_) {
      if (robot.id == except) continue;
      if (best == nullptr || distance(robot.here, point) < distance(best->here, point)) best = &robot;
    }
    return best == nullptr ? kUnknownId : best->id;
  }
  [[nodiscard]] RestartPart part_of(RobotId id) const { return {ours_, id == goalkeeper_, id == taker_}; }

  [[nodiscard]] bool is_possible(RobotId id, Vector2 place) const {
    if (!rules_.is_on_field(place) || !rules_.is_legal(restart_, part_of(id), ball_, place)) return false;
    if (distance(place, ball_) < rules_.reach_m()) return false;
    const double least = 2.0 * settings_.sizes.robot_radius_m + RestartRules::kGapM;
    return std::none_of(placed_.begin(), placed_.end(),
                        [&](const PlacedRobot& other) { return distance(place, other.place.position) < least; });
  }

  // A robot for which there is no place is left to the referee.
  void choose(RobotId id) {
    const Vector2 goal{-0.5 * settings_.sizes.length_m, 0.0};
    const Vector2 wished = id == goalkeeper_ ? goal + Vector2{settings_.keeper_line_m, 0.0} : 0.5 * (ball_ + goal);
    const auto is_free = [&](Vector2 place) { return is_possible(id, place); };
    const auto place = is_free(wished) ? wished : rules_.nearest_place(wished, 1.0, is_free);
    if (place) placed_.push_back({id, {*place, bearing(ball_ - *place)}});
  }

  const Restart restart_;
  const bool ours_;
  const RestartRules rules_;
  const PlacementSettings& settings_;
  const Vector2 ball_;
  FixedVector<Robot, kMaxRobotsPerTeam> robots_;
  RobotId goalkeeper_ = kUnknownId, taker_ = kUnknownId;
  PlacedRobots placed_;
};

// Returns where the referee puts the ball, in our coordinates (getBallPlaceByFoul() of VSSReferee). nullopt: unknown.
std::optional<Vector2> ball_place(const Snapshot& snapshot, const PlacementSettings& settings, double direction) {
  const RefereeState& referee = snapshot.referee;
  const BallTrack& ball = snapshot.tracks.ball;
  const Vector2 seen = ball.state == TrackState::kLost ? Vector2{} : to_vector(ball.position);
  const RestartRules rules(settings.sizes);
  switch (referee.restart) {
    case Restart::kKickOff:
      return Vector2{};
    case Restart::kFreeBall: {
      if (referee.quadrant == 0 && ball.state == TrackState::kLost) return std::nullopt;
      // Quadrants are numbered counterclockwise from positive x and y on.
      const Vector2 quadrant{referee.quadrant == 2 || referee.quadrant == 3 ? -1.0 : 1.0,
                             referee.quadrant > 2 ? -1.0 : 1.0};
      return direction * rules.free_ball_mark(referee.quadrant == 0 ? seen : quadrant);
    }
    case Restart::kPenalty:
      return (referee.restart_is_ours ? 1.0 : -1.0) * rules.penalty_mark();
    case Restart::kGoalKick: {
      // The referee takes the side on which the goalkeeper is placed, 2.5 cm outside of the area less the ball's
      // radius.
      const double x = 0.5 * settings.sizes.length_m - settings.sizes.goal_area_depth_m;
      const double y = 0.5 * settings.sizes.goal_area_width_m + 0.025 - settings.sizes.ball_radius_m;
      return Vector2{referee.restart_is_ours ? -x : x, direction * seen.y < 0.0 ? -y : y};
    }
    case Restart::kNone:
    case Restart::kFreeKick:
      break;
  }
  return std::nullopt;
}

}  // namespace

void place_robots(const Snapshot& snapshot, const PlacementSettings& settings, PlacedRobots& out) {
  out.clear();
  const bool turned = snapshot.referee.own_on_positive_half.value_or(false);
  const double direction = turned ? -1.0 : 1.0;
  const std::optional<Vector2> ball = ball_place(snapshot, settings, direction);
  if (!ball) return;
  Placing placing(snapshot.referee, settings, *ball);
  std::size_t count = 0;
  for (const RobotTrack& robot : snapshot.tracks.robots) {
    if (robot.team != Team::kOwn || robot.id == kUnknownId || count == kMaxRobotsPerTeam) continue;
    placing.add(robot.id, direction * to_vector(robot.pose.position));
    ++count;
  }
  placing.place();
  for (PlacedRobot robot : placing.placed()) {
    robot.place.position = direction * robot.place.position;
    if (turned) robot.place.theta_rad = wrap_angle(robot.place.theta_rad + std::numbers::pi);
    out.push_back(robot);
  }
}

std::size_t VssPlacementEncoder::encode(const OutputFrame& frame, std::span<std::byte> out) {
  const RefereeState& referee = frame.snapshot.referee;
  if (referee.phase != GamePhase::kPrepare || answered_ == referee.received) return 0;
  PlacedRobots robots;
  place_robots(frame.snapshot, settings_, robots);
  if (robots.empty()) return 0;  // none is seen yet
  VSSRef_VSSRef_Placement message = VSSRef_VSSRef_Placement_init_zero;
  message.has_world = true;
  message.world.team_color = frame.own == TeamColor::kYellow ? VSSRef_Color_YELLOW : VSSRef_Color_BLUE;
  for (const PlacedRobot& robot : robots) {
    message.world.robots[message.world.robots_count++] = {static_cast<std::uint32_t>(int{robot.id}),
                                                          robot.place.position.x, robot.place.position.y,
                                                          robot.place.theta_rad * kDegrees};
  }
  const std::size_t size = hal::encode_message(VSSRef_VSSRef_Placement_fields, &message, out);
  if (size > 0) answered_ = referee.received;
  return size;
}

}  // namespace touchline::network
