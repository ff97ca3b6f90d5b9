#include "core/marker/robot_top.h"

#include <cmath>

#include "core/marker/rigid_fit.h"

namespace touchline {
namespace {

// A robot this far from the ball cannot hide it.
constexpr float kFarRobot_m = 0.1f;

}  // namespace

std::array<RobotSize, 2> sizes_of(const std::array<TeamMarking, 2>& teams) {
  const MarkerLayout &own = teams[0].layout, &opponent = teams[1].layout;
  return {{{own.robot_side_m, own.height_m}, {opponent.robot_side_m, opponent.height_m}}};
}

FixedVector<RobotTop, kMaxRobots> tops_near(FieldPoint ball, const CameraModel& camera,
                                            const std::array<RobotSize, 2>& sizes, const Sightings& seen) {
  FixedVector<RobotTop, kMaxRobots> tops;
  for (const RobotSighting& robot : seen.robots) {
    const auto& [side_m, height_m] = sizes[index_of(robot.team)];
    const FieldPoint at = robot.pose.position;
    if (!(side_m > 0.0f) || !robot.has_heading || distance_m(at, ball) > side_m + kFarRobot_m) continue;
    const float half = 0.5f * side_m;
    const float c = half * std::cos(robot.pose.theta_rad), s = half * std::sin(robot.pose.theta_rad);
    const PixelPoint center = camera.to_pixel(at, height_m);
    const PixelPoint ahead = camera.to_pixel({at.x_m + c, at.y_m + s}, height_m);
    const PixelPoint left = camera.to_pixel({at.x_m - s, at.y_m + c}, height_m);
    tops.push_back(
        {center,
         {{{ahead.u_px - center.u_px, ahead.v_px - center.v_px}, {left.u_px - center.u_px, left.v_px - center.v_px}}},
         camera.to_pixel(at, 0.0f),
         height_m});
  }
  return tops;
}

}  // namespace touchline
