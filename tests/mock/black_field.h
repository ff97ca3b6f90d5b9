#pragma once

#include <cmath>
#include <numbers>

#include "hal/mock/renderer.h"
#include "tests/mock/noise_free_arena.h"

namespace touchline::hal::mock {

/// Returns a black field with black robots in uniform light. Only a white square patch in the center of the robot's top
/// and a green ball are visible.
inline ArenaParameters black_field() {
  ArenaParameters parameters = noise_free_arena();
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

inline Snapshot stationary(const Placement& robot, const Placement& ball = {9.0, 9.0, 0.0}) {
  Snapshot all;
  all.robots.push_back(robot);
  all.ball = ball;
  return all;
}

/// Moments of the intensity of one channel over the picture. An intensity of 1 is a fully lit white pixel.
struct IntensityMoments {
  double sum = 0.0, u = 0.0, v = 0.0, variance_u = 0.0, variance_v = 0.0;
};
inline constexpr double kWhite = 0.9 * kLinearScale;

inline IntensityMoments intensity_moments(std::span<const std::uint16_t> picture, std::size_t width,
                                          std::size_t channel) {
  IntensityMoments moments;
  double uu = 0.0, vv = 0.0;
  for (std::size_t i = 0; i < picture.size() / 3; ++i) {
    const double weight = picture[3 * i + channel] / kWhite;
    const auto u = static_cast<double>(i % width), v = static_cast<double>(i / width);
    moments.sum += weight;
    moments.u += weight * u;
    moments.v += weight * v;
    uu += weight * u * u;
    vv += weight * v * v;
  }
  if (moments.sum <= 0.0) return moments;
  moments.u /= moments.sum;
  moments.v /= moments.sum;
  moments.variance_u = uu / moments.sum - moments.u * moments.u;
  moments.variance_v = vv / moments.sum - moments.v * moments.v;
  return moments;
}

}  // namespace touchline::hal::mock
