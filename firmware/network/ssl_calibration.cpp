#include "firmware/network/ssl_calibration.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace touchline::network {
namespace {

constexpr double kMillimetersPerMeter = 1000.0;

/// A pixel and the field point that our model gives for it.
struct Sample {
  Eigen::Vector2d pixel;
  Eigen::Vector3d field_m;
};

// Parameters of the fit: rotation vector applied after the initial rotation (3), position (3), focal length, principal
// point (2), distortion (last, because it may be left out).
constexpr int kParameters = 10;
using Vector = Eigen::Matrix<double, kParameters, 1>;
using Matrix = Eigen::Matrix<double, kParameters, kParameters>;

struct Model {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  // field -> camera
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  double focal_px = 1.0;
  Eigen::Vector2d principal_px = Eigen::Vector2d::Zero();
  double distortion = 0.0;

  [[nodiscard]] Model moved(const Vector& step) const {
    Model next = *this;
    const Eigen::Vector3d turn = step.head<3>();
    const double angle = turn.norm();
    if (angle > 0.0) next.rotation = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * rotation;
    next.position_m += step.segment<3>(3);
    next.focal_px += step[6];
    next.principal_px += step.segment<2>(7);
    next.distortion += step[9];
    return next;
  }

  [[nodiscard]] Eigen::Vector2d to_field(const Eigen::Vector2d& pixel, double height_m) const {
    const Eigen::Vector2d distorted = (pixel - principal_px) / focal_px;
    const Eigen::Vector2d ideal = distorted * (1.0 + distortion * distorted.squaredNorm());
    const Eigen::Vector3d ray = rotation.transpose() * ideal.homogeneous();
    return (position_m + ray * ((height_m - position_m.z()) / ray.z())).head<2>();
  }

  [[nodiscard]] Eigen::Vector2d error(const Sample& sample) const {
    return to_field(sample.pixel, sample.field_m.z()) - sample.field_m.head<2>();
  }
};

double squared_error(const Model& model, const std::vector<Sample>& samples) {
  double sum = 0.0;
  for (const Sample& sample : samples) sum += model.error(sample).squaredNorm();
  return std::isfinite(sum) ? sum : 1e300;
}

/// Returns the visible points of a grid over the field, on the floor and on the robots' tops.
std::vector<Sample> visible_samples(const CameraModel& camera, const FieldParameters& field, std::uint16_t width_px,
                                    std::uint16_t height_px, float robot_height_m) {
  constexpr int kColumns = 17, kRows = 13;
  std::vector<Sample> samples;
  for (const float height : {0.0f, robot_height_m}) {
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        const FieldPoint point{field.length_m * (static_cast<float>(column) / static_cast<float>(kColumns - 1) - 0.5f),
                               field.width_m * (static_cast<float>(row) / static_cast<float>(kRows - 1) - 0.5f)};
        const PixelPoint pixel = camera.to_pixel(point, height);
        if (!(pixel.u_px >= 0.0f && pixel.u_px < static_cast<float>(width_px) && pixel.v_px >= 0.0f &&
              pixel.v_px < static_cast<float>(height_px))) {
          continue;
        }
        samples.push_back({Eigen::Vector2d(static_cast<double>(pixel.u_px), static_cast<double>(pixel.v_px)),
                           Eigen::Vector3d(static_cast<double>(point.x_m), static_cast<double>(point.y_m),
                                           static_cast<double>(height))});
      }
    }
  }
  return samples;
}

Eigen::Vector3d direction(const CameraModel& camera, double u, double v) {
  const Ray ray = camera.ray({static_cast<float>(u), static_cast<float>(v)});
  return Eigen::Vector3d(static_cast<double>(ray.direction[0]), static_cast<double>(ray.direction[1]),
                         static_cast<double>(ray.direction[2]));
}

/// Returns a pinhole camera with the lines of sight of the picture's center and of two points beside it.
Model initial_model(const CameraModel& camera, std::uint16_t width_px, std::uint16_t height_px) {
  Model model;
  const double u = 0.5 * (width_px - 1), v = 0.5 * (height_px - 1);
  const double aside = 0.1 * width_px;
  const Eigen::Vector3d forward = direction(camera, u, v);
  const Eigen::Vector3d beside = direction(camera, u + aside, v);
  const Eigen::Vector3d right = (beside - forward * forward.dot(beside)).normalized();
  model.rotation.row(0) = right;
  model.rotation.row(1) = forward.cross(right);
  model.rotation.row(2) = forward;
  model.focal_px = aside / std::tan(std::acos(std::clamp(forward.dot(beside), -1.0, 1.0)));
  model.principal_px = {u, v};
  const std::array<float, 3> origin = camera.ray({static_cast<float>(u), static_cast<float>(v)}).origin_m;
  model.position_m = {static_cast<double>(origin[0]), static_cast<double>(origin[1]), static_cast<double>(origin[2])};
  return model;
}

/// Fits the model by Levenberg-Marquardt with numerical derivatives. Without `with_distortion`, the distortion
/// parameter is not changed.
Model fitted(Model model, const std::vector<Sample>& samples, bool with_distortion) {
  // Steps of the numerical derivatives: each moves a field point by about a micrometer.
  const Vector delta = (Vector() << 1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 1e-3, 1e-3, 1e-3, 1e-5).finished();
  const int count = with_distortion ? kParameters : kParameters - 1;
  double cost = squared_error(model, samples);
  double damping = 1e-3;
  for (int iteration = 0; iteration < 100 && damping < 1e12; ++iteration) {
    Matrix normal = Matrix::Zero();
    Vector gradient = Vector::Zero();
    for (const Sample& sample : samples) {
      Eigen::Matrix<double, 2, kParameters> jacobian = Eigen::Matrix<double, 2, kParameters>::Zero();
      for (int i = 0; i < count; ++i) {
        const Vector step = Vector::Unit(i) * delta[i];
        jacobian.col(i) = (model.moved(step).error(sample) - model.moved(-step).error(sample)) / (2.0 * delta[i]);
      }
      normal += jacobian.transpose() * jacobian;
      gradient += jacobian.transpose() * model.error(sample);
    }
    Matrix damped = normal;
    for (int i = 0; i < kParameters; ++i) damped(i, i) = i < count ? normal(i, i) * (1.0 + damping) + 1e-15 : 1.0;
    const Model next = model.moved(-damped.ldlt().solve(gradient));
    const double next_cost = squared_error(next, samples);
    if (!(next_cost < cost)) {
      damping *= 10.0;
      continue;
    }
    const bool converged = cost - next_cost <= 1e-12 * cost;
    model = next;
    cost = next_cost;
    damping = std::max(0.1 * damping, 1e-9);
    if (converged) break;
  }
  return model;
}

SslCalibration calibration_of(const Model& model) {
  SslCalibration out;
  const Eigen::Quaterniond q(model.rotation);
  const Eigen::Vector3d t_mm = -kMillimetersPerMeter * (model.rotation * model.position_m);
  const Eigen::Vector3d position_mm = kMillimetersPerMeter * model.position_m;
  out.focal_length_px = model.focal_px;
  out.principal_point_px = {model.principal_px.x(), model.principal_px.y()};
  out.distortion = model.distortion;
  out.q = {q.x(), q.y(), q.z(), q.w()};
  out.t_mm = {t_mm.x(), t_mm.y(), t_mm.z()};
  out.position_mm = {position_mm.x(), position_mm.y(), position_mm.z()};
  return out;
}

}  // namespace

Status fit_ssl_calibration(const CameraParameters& parameters, const FieldParameters& field, std::uint16_t width_px,
                           std::uint16_t height_px, float robot_height_m, SslCalibration& out) {
  CameraModel camera;
  if (const Status status = camera.configure(parameters); !status.ok()) return status;
  const std::vector<Sample> samples = visible_samples(camera, field, width_px, height_px, robot_height_m);
  if (samples.size() < kParameters) return ErrorCode::kInconsistent;

  const Model initial = initial_model(camera, width_px, height_px);
  Model model = fitted(initial, samples, true);
  // SSL-Vision ignores a negative distortion when it projects points.
  if (model.distortion < 0.0) {
    model.distortion = 0.0;
    model = fitted(model, samples, false);
  }

  out = calibration_of(model);
  double max_m = 0.0;
  for (const Sample& sample : samples) max_m = std::max(max_m, model.error(sample).norm());
  out.rms_mm = kMillimetersPerMeter * std::sqrt(squared_error(model, samples) / static_cast<double>(samples.size()));
  out.max_mm = kMillimetersPerMeter * max_m;
  return {};
}

FieldPoint to_field(const SslCalibration& calibration, PixelPoint pixel, float height_m) {
  Model model;
  const std::array<double, 4>& q = calibration.q;
  model.rotation = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
  const Eigen::Vector3d t_mm(calibration.t_mm[0], calibration.t_mm[1], calibration.t_mm[2]);
  model.position_m = -(model.rotation.transpose() * t_mm) / kMillimetersPerMeter;
  model.focal_px = calibration.focal_length_px;
  model.principal_px = {calibration.principal_point_px[0], calibration.principal_point_px[1]};
  model.distortion = calibration.distortion;
  const Eigen::Vector2d point =
      model.to_field({static_cast<double>(pixel.u_px), static_cast<double>(pixel.v_px)}, static_cast<double>(height_m));
  return {static_cast<float>(point.x()), static_cast<float>(point.y())};
}

}  // namespace touchline::network
