#include "core/marker/centroid_noise.h"

#include <algorithm>
#include <cmath>

#include "core/marker/rigid_fit.h"

namespace touchline {
namespace {

// Standard deviations of a pose that is computed only from a long team patch: half the patch's width, and the error of
// its axis.
constexpr float kUprightPosition_m = 0.005f, kUprightHeading = 0.1f;
// Error of a region's centroid, along each axis.
constexpr float kCentroidSigmaPx = 0.2f;
// Most of this error comes from rounding the region's border to whole pixels. It decorrelates within half a pixel.
constexpr float kCentroidLastingShare = 0.9f, kCentroidLastsPx = 0.5f;
// Error of a ball's centroid: light and shade move it by this part of the radius.
constexpr float kBallShading = 0.15f;

}  // namespace

void write_centroid_noise(const CameraModel& camera, const std::array<TeamMarking, 2>& teams, float ball_radius_m,
                          Sightings& out) {
  const auto variance_at = [&camera](FieldPoint place, float height_m) {
    const float sigma = kCentroidSigmaPx / camera.scale_px_per_m(place, height_m);
    return sigma * sigma;
  };
  for (RobotSighting& robot : out.robots) {
    const MarkerLayout& layout = teams[index_of(robot.team)].layout;
    float variance = variance_at(robot.pose.position, layout.height_m);
    robot.lasting_share = kCentroidLastingShare;
    robot.lasts_m = kCentroidLastsPx / camera.scale_px_per_m(robot.pose.position, layout.height_m);
    if (!robot.has_heading) {
      robot.noise.xx = robot.noise.yy = variance;
      continue;
    }
    const std::size_t patches = robot.patches.size();
    if (patches < 2) {
      constexpr float kXx = kUprightPosition_m * kUprightPosition_m;
      robot.noise = {kXx, kXx, kUprightHeading * kUprightHeading, 0.0f, 0.0f, 0.0f};
      continue;
    }
    // The residual has two degrees of freedom per patch, less three of the pose. If it is larger than the usual error
    // explains, it determines the error (Birge ratio). The cause is a region that lacks a part of its patch, or
    // contains a part of another one.
    const float squares = robot.residual_m * robot.residual_m * static_cast<float>(patches);
    variance = std::max(variance, squares / static_cast<float>(2 * patches - 3));
    FixedVector<FieldPoint, kMaxPatches> places;
    FixedVector<PointCovariance, kMaxPatches> errors;
    for (const PatchSighting& patch : robot.patches) {
      places.push_back({layout.patches[patch.patch].x_m, layout.patches[patch.patch].y_m});
      errors.push_back({variance, 0.0f, variance});
    }
    robot.noise = rigid_fit_noise({places.data(), places.size()}, {errors.data(), errors.size()}, robot.pose.theta_rad);
  }
  if (!out.ball.seen) return;
  out.ball.sigma_m = std::sqrt(variance_at(out.ball.position, ball_radius_m)) + kBallShading * ball_radius_m;
  out.ball.lasting_share = kCentroidLastingShare;
  out.ball.lasts_m = kCentroidLastsPx / camera.scale_px_per_m(out.ball.position, ball_radius_m);
}

}  // namespace touchline
