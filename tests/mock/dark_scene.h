#pragma once

#include <cmath>
#include <numbers>

#include "hal/mock/renderer.h"
#include "tests/mock/quiet_arena.h"

namespace touchline::hal::mock {

/// Even light on a black field with black robots, so that only what is painted shows: one white square patch in the
/// middle of the robot's top, and a green ball.
inline ArenaParameters dark_scene() {
  ArenaParameters parameters = quiet_arena();
  parameters.light.lamp.clear();
  parameters.camera.vignetting = 0.0;
  parameters.field.floor_rgb = parameters.field.line_rgb = parameters.field.outside_rgb = {0, 0, 0};
  parameters.body_rgb = {0, 0, 0};
  parameters.paint = {{"white", {255, 255, 255}}, {"green", {0, 255, 0}}, {"red", {255, 0, 0}}};
  parameters.own_color = parameters.opponent_color = "white";
  parameters.ball_color = "green";
  parameters.patch = {{PatchShape::kSquare, 0.0, 0.0, 0.05, 0.05}};
  parameters.robot[0].colors.clear();
  return parameters;
}

inline Snapshot still(const Placement& robot, const Placement& ball = {9.0, 9.0, 0.0}) {
  Snapshot all;
  all.robots.push_back(robot);
  all.ball = ball;
  return all;
}

/// Light of one channel in a picture, as weights of pixels. 1 is what a fully lit pixel of white sends.
struct Blot {
  double sum = 0.0, u = 0.0, v = 0.0, variance_u = 0.0, variance_v = 0.0;
};
inline constexpr double kWhite = 0.9 * kLinearScale;

inline Blot blot_of(std::span<const std::uint16_t> picture, std::size_t width, std::size_t channel) {
  Blot blot;
  double uu = 0.0, vv = 0.0;
  for (std::size_t i = 0; i < picture.size() / 3; ++i) {
    const double weight = picture[3 * i + channel] / kWhite;
    const auto u = static_cast<double>(i % width), v = static_cast<double>(i / width);
    blot.sum += weight;
    blot.u += weight * u;
    blot.v += weight * v;
    uu += weight * u * u;
    vv += weight * v * v;
  }
  if (blot.sum <= 0.0) return blot;
  blot.u /= blot.sum;
  blot.v /= blot.sum;
  blot.variance_u = uu / blot.sum - blot.u * blot.u;
  blot.variance_v = vv / blot.sum - blot.v * blot.v;
  return blot;
}

}  // namespace touchline::hal::mock
