#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/angle.h"
#include "core/marker/rigid_fit.h"
#include "core/subpixel/top_fit.h"
#include "tests/marker/photograph.h"
#include "tests/marker/real_layouts.h"

// A robot of any layout in a rendered picture, and the errors of the fit.
namespace touchline::testing {

inline constexpr float kDegree = kPi / 180.0f;
inline constexpr Light kTop{0.01, 0.01, 0.012}, kFloor{0.03, 0.03, 0.03}, kLine{0.9, 0.9, 0.88};
inline constexpr std::array<Light, 5> kPatchLight{
    {{0.04, 0.11, 0.62}, {0.7, 0.05, 0.07}, {0.06, 0.5, 0.12}, {0.8, 0.75, 0.05}, {0.7, 0.1, 0.5}}};

struct Errors {
  float position_m = 0, angle_rad = 0, center_px = 0;
};

class TopFitTest : public ::testing::Test {
 protected:
  void use(const MarkerLayout& layout) {
    layout_ = layout;
    fit_.configure({layout, layout}, camera_);
  }

  // Light of a point: patches on a dark top, a white line along x beside the robot, the floor. The top of a robot hides
  // the floor; heights do not matter here.
  Light light(const Pose& pose, float line_m, double u, double v) const {
    const FieldPoint at = camera_.to_field({static_cast<float>(u), static_cast<float>(v)}, layout_.height_m);
    const FieldPoint local = to_robot_frame(pose, at);
    const float half = layout_.robot_side_m / 2;
    if (std::abs(local.x_m) <= half && std::abs(local.y_m) <= half) {
      for (std::size_t k = 0; k < layout_.patches.size(); ++k) {
        if (covers(layout_.patches[k], local)) return patch_light_[k];
      }
      return kTop;
    }
    return std::abs(local.y_m - half - line_m) < 0.02f ? kLine : kFloor;
  }

  struct Square {
    int left_px, top_px, right_px, bottom_px;
  };
  // The robot and what its edges are measured against.
  Square surroundings(const Pose& pose) const {
    const PixelPoint at = camera_.to_pixel(pose.position, layout_.height_m);
    const int u = static_cast<int>(at.u_px), v = static_cast<int>(at.v_px);
    const int reach = 6 + static_cast<int>(0.72f * layout_.robot_side_m * 250.0f);
    return {std::max(u - reach, 0), std::max(v - reach, 0), std::min(u + reach, 640), std::min(v + reach, 480)};
  }

  Photograph photograph(PixelFormat format, const Pose& pose, float line_m) const {
    Photograph picture(format, 640, 480);
    const Square exposed = surroundings(pose);
    picture.expose(exposed.left_px, exposed.top_px, exposed.right_px, exposed.bottom_px,
                   [&](double pu, double pv) { return light(pose, line_m, pu, pv); });
    return picture;
  }

  PixelPoint center(const Pose& pose, std::size_t k) const {
    const PatchPlace& place = layout_.patches[k];
    return camera_.to_pixel(on_field(pose, place.x_m, place.y_m), layout_.height_m);
  }

  // A sighting with the errors of the regions' centroids.
  RobotSighting sighting(const Pose& pose) const {
    RobotSighting robot;
    robot.id = 3;
    robot.has_heading = true;
    robot.pose = pose;
    robot.residual_m = 0.001f;
    for (std::size_t k = 0; k < layout_.patches.size(); ++k) {
      robot.patches.push_back({layout_.patches[k].role, static_cast<std::uint8_t>(k), ColorId{1}, center(pose, k)});
    }
    return robot;
  }

  Errors errors(const Pose& truth, const RobotSighting& robot) const {
    Errors out;
    out.position_m = distance_m(robot.pose.position, truth.position);
    out.angle_rad = std::abs(wrap_angle(robot.pose.theta_rad - truth.theta_rad));
    for (std::size_t k = 0; k < robot.patches.size(); ++k) {
      const PixelPoint is = center(truth, k), said = robot.patches[k].center;
      out.center_px = std::max(out.center_px, std::hypot(is.u_px - said.u_px, is.v_px - said.v_px));
    }
    return out;
  }

  // Largest errors over robots anywhere, from sightings with errors of up to 1.5 mm and 2 degrees in every direction.
  Errors worst(PixelFormat format, int robots, float line_m) {
    Errors most;
    for (int n = 0; n < robots; ++n) {
      const Pose truth{{dice_.real(-0.9f, 0.9f), dice_.real(-0.7f, 0.7f)}, dice_.real(-kPi, kPi)};
      const Photograph picture = photograph(format, truth, line_m);
      sightings_.robots.clear();
      sightings_.robots.push_back(sighting(
          {{truth.position.x_m + dice_.real(-0.0015f, 0.0015f), truth.position.y_m + dice_.real(-0.0015f, 0.0015f)},
           truth.theta_rad + dice_.real(-2 * kDegree, 2 * kDegree)}));
      fit_.refine(picture.frame(), sightings_);
      const Errors now = errors(truth, sightings_.robots[0]);
      most.position_m = std::max(most.position_m, now.position_m);
      most.angle_rad = std::max(most.angle_rad, now.angle_rad);
      most.center_px = std::max(most.center_px, now.center_px);
    }
    return most;
  }

  static CameraModel tilted() {
    CameraModel camera;
    EXPECT_TRUE(camera.configure(tilted_camera()).ok());
    return camera;
  }

  CameraModel camera_ = tilted();
  MarkerLayout layout_;
  std::array<Light, 5> patch_light_ = kPatchLight;
  TopFit fit_;
  Sightings sightings_;
  PortableRandom dice_{77};
};

}  // namespace touchline::testing
