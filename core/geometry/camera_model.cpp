#include "core/geometry/camera_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace touchline {
namespace {

// Beyond this ratio r / H, eq. (12) continues along its tangent. R = 10 H is 84 degrees from the axis.
constexpr double kMaxSinhArgument = 3.0;
// At a smaller denominator of eq. (14), a pixel is treated as lying on the horizon.
constexpr double kMinDenominator = 0.02;
// Depth in front of the camera, as a fraction of the distance, below which a point is treated as beside the camera.
constexpr double kMinDepth = 1e-3;

double rectified_radius(double r, double h) {
  const double t = r / h;
  if (t <= kMaxSinhArgument) return h * std::sinh(t);
  return h * (std::sinh(kMaxSinhArgument) + std::cosh(kMaxSinhArgument) * (t - kMaxSinhArgument));
}

double distorted_radius(double rectified, double h) {
  const double s = rectified / h, end = std::sinh(kMaxSinhArgument);
  if (s <= end) return h * std::asinh(s);
  return h * (kMaxSinhArgument + (s - end) / std::cosh(kMaxSinhArgument));
}

template <class Values>
bool all_finite(const Values& values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

bool usable(const FullModelParameters& p) {
  const std::array<float, 9> numbers{p.fx_px, p.fy_px, p.cx_px, p.cy_px, p.k1, p.k2, p.k3, p.p1, p.p2};
  return all_finite(numbers) && all_finite(p.rotation_rad) && all_finite(p.position_m) && p.fx_px > 0 && p.fy_px > 0 &&
         p.position_m[2] > 0;
}

bool usable(const PaperModelParameters& p) {
  const std::array<float, 5> numbers{p.center_u_px, p.center_v_px, p.focal_px, p.p_per_px, p.q_per_px};
  return all_finite(numbers) && all_finite(p.affine) && all_finite(p.position_m) && p.focal_px > 0 &&
         p.position_m[2] > 0;
}

// Limits a value to the range that the interface guarantees. Points at the limit are far from field and picture.
float bounded(double value) {
  constexpr double kLimit = 1e9;
  return static_cast<float>(std::clamp(value, -kLimit, kLimit));
}

template <class From>
std::array<double, 3> as_double(const From& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

}  // namespace

Status CameraModel::configure(const CameraParameters& parameters) {
  CameraModel next;
  next.kind_ = parameters.kind;
  const Status status =
      parameters.kind == CameraModelKind::kFull ? next.configure(parameters.full) : next.configure(parameters.paper);
  if (status.ok()) *this = next;
  return status;
}

Status CameraModel::configure(const FullModelParameters& p) {
  if (!usable(p)) return ErrorCode::kOutOfRange;
  focal_ = {static_cast<double>(p.fx_px), static_cast<double>(p.fy_px)};
  principal_ = {static_cast<double>(p.cx_px), static_cast<double>(p.cy_px)};
  distortion_ = BrownDistortion(static_cast<double>(p.k1), static_cast<double>(p.k2), static_cast<double>(p.k3),
                                static_cast<double>(p.p1), static_cast<double>(p.p2));
  position_ = as_double(p.position_m);
  const std::array<double, 3> r = as_double(p.rotation_rad);
  const Eigen::Vector3d axis(r[0], r[1], r[2]);
  const double angle = axis.norm();
  const Eigen::Matrix3d matrix =
      angle > 0 ? Eigen::AngleAxisd(angle, axis / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
  for (int i = 0; i < 3; ++i) {
    rotation_[static_cast<std::size_t>(i)] = {matrix(i, 0), matrix(i, 1), matrix(i, 2)};
  }
  return {};
}

Status CameraModel::configure(const PaperModelParameters& p) {
  if (!usable(p)) return ErrorCode::kOutOfRange;
  center_ = {static_cast<double>(p.center_u_px), static_cast<double>(p.center_v_px)};
  h_ = static_cast<double>(p.focal_px);
  p_ = static_cast<double>(p.p_per_px);
  q_ = static_cast<double>(p.q_per_px);
  std::transform(p.affine.begin(), p.affine.end(), affine_.begin(), [](float v) { return static_cast<double>(v); });
  position_ = as_double(p.position_m);
  determinant_ = affine_[0] * affine_[4] - affine_[1] * affine_[3];
  // The test is relative to the norms of the columns, because they depend on the scale of a pixel.
  const double columns = std::hypot(affine_[0], affine_[3]) * std::hypot(affine_[1], affine_[4]);
  if (!(std::abs(determinant_) > 1e-6 * columns)) return ErrorCode::kInconsistent;
  return {};
}

CameraModel::Point2 CameraModel::paper_floor(Point2 pixel) const {
  // Eq. (13); the angle itself is not needed.
  const double x = pixel[0] - center_[0], y = pixel[1] - center_[1];
  const double r = std::hypot(x, y);
  const double stretch = r > 0 ? rectified_radius(r, h_) / r : 1.0;
  const double rectified_x = stretch * x, rectified_y = stretch * y;
  // Eq. (14), solved for x and y.
  const double w = std::max(kMinDenominator, 1.0 - p_ * rectified_x - q_ * rectified_y);
  const double a = rectified_x / w, b = rectified_y / w;
  return {affine_[0] * a + affine_[1] * b + affine_[2], affine_[3] * a + affine_[4] * b + affine_[5]};
}

CameraModel::Point2 CameraModel::paper_pixel(Point2 floor) const {
  const double dx = floor[0] - affine_[2], dy = floor[1] - affine_[5];
  const double a = (affine_[4] * dx - affine_[1] * dy) / determinant_;
  const double b = (affine_[0] * dy - affine_[3] * dx) / determinant_;
  const double w = 1.0 / std::max(kMinDenominator, 1.0 + p_ * a + q_ * b);
  const double x = a * w, y = b * w;
  const double rectified = std::hypot(x, y);
  const double shrink = rectified > 0 ? distorted_radius(rectified, h_) / rectified : 1.0;
  return {center_[0] + shrink * x, center_[1] + shrink * y};
}

CameraModel::Point3 CameraModel::direction(Point2 pixel) const {
  Point3 d{};
  if (kind_ == CameraModelKind::kPaper) {
    const Point2 floor = paper_floor(pixel);
    d = {floor[0] - position_[0], floor[1] - position_[1], -position_[2]};
  } else {
    const Point2 ideal =
        distortion_.undistort({(pixel[0] - principal_[0]) / focal_[0], (pixel[1] - principal_[1]) / focal_[1]});
    for (std::size_t i = 0; i < 3; ++i) {
      d[i] = rotation_[0][i] * ideal[0] + rotation_[1][i] * ideal[1] + rotation_[2][i];
    }
  }
  const double level = d[0] * d[0] + d[1] * d[1];
  if (!(d[2] < 0.0 && d[2] * d[2] >= kMinDip * kMinDip * level)) {
    double length = std::sqrt(level);
    if (length == 0.0) d[0] = length = 1.0;  // straight up: the azimuth is arbitrary
    d[2] = std::min(d[2], -kMinDip * length);
  }
  return d;
}

CameraModel::Point3 CameraModel::from_camera(Point3 way) const {
  Point3 c{};
  for (std::size_t i = 0; i < 3; ++i) {
    c[i] = rotation_[i][0] * way[0] + rotation_[i][1] * way[1] + rotation_[i][2] * way[2];
  }
  return c;
}

CameraModel::Point2 CameraModel::project(Point3 point) const {
  const Point3 d{point[0] - position_[0], point[1] - position_[1], point[2] - position_[2]};
  if (kind_ == CameraModelKind::kPaper) {
    const double down = position_[2] / -d[2];  // factor that extends the line of sight to the floor
    return paper_pixel({position_[0] + down * d[0], position_[1] + down * d[1]});
  }
  const Point3 c = from_camera(d);
  const double distance = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  const bool ahead = c[2] > 0.0 && c[2] * c[2] >= kMinDepth * kMinDepth * distance;
  const double depth = ahead ? c[2] : kMinDepth * std::sqrt(distance);
  const Point2 distorted = distortion_.distort({c[0] / depth, c[1] / depth});
  return {focal_[0] * distorted[0] + principal_[0], focal_[1] * distorted[1] + principal_[1]};
}

double CameraModel::below_camera(float height_m) const {
  return std::min(static_cast<double>(height_m), 0.999 * position_[2]);
}

Ray CameraModel::ray(PixelPoint pixel) const {
  const Point3 d = direction({static_cast<double>(pixel.u_px), static_cast<double>(pixel.v_px)});
  const double norm = std::hypot(d[0], d[1], d[2]);
  Ray out;
  for (std::size_t i = 0; i < 3; ++i) {
    out.origin_m[i] = static_cast<float>(position_[i]);
    out.direction[i] = static_cast<float>(d[i] / norm);
  }
  return out;
}

FieldPoint CameraModel::to_field(PixelPoint pixel, float height_m) const {
  const Point3 d = direction({static_cast<double>(pixel.u_px), static_cast<double>(pixel.v_px)});
  const double length = (below_camera(height_m) - position_[2]) / d[2];
  return {bounded(position_[0] + length * d[0]), bounded(position_[1] + length * d[1])};
}

PixelPoint CameraModel::to_pixel(FieldPoint point, float height_m) const {
  const Point2 pixel =
      project({static_cast<double>(point.x_m), static_cast<double>(point.y_m), below_camera(height_m)});
  return {bounded(pixel[0]), bounded(pixel[1])};
}

float CameraModel::scale_px_per_m(FieldPoint point, float height_m) const {
  if (kind_ == CameraModelKind::kFull) {
    // The area of a horizontal plane through a pinhole is proportional to the vertical distance over the cube of the
    // depth.
    const Point3 d{static_cast<double>(point.x_m) - position_[0], static_cast<double>(point.y_m) - position_[1],
                   below_camera(height_m) - position_[2]};
    const Point3 c = from_camera(d);
    const double distance = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    if (c[2] > 0.0 && c[2] * c[2] >= kMinDepth * kMinDepth * distance) {
      const double stretch = distortion_.stretch({c[0] / c[2], c[1] / c[2]});
      if (stretch > 0.0) {
        return bounded(std::sqrt(focal_[0] * focal_[1] * stretch * -d[2] / (c[2] * c[2] * c[2])));
      }
    }
  }
  // The derivatives are central differences. With a step of 1 mm, the error is the third derivative of the lens model
  // times 1e-6.
  constexpr double kStep = 1e-3;
  const double x = static_cast<double>(point.x_m), y = static_cast<double>(point.y_m), z = below_camera(height_m);
  const Point2 right = project({x + kStep, y, z}), left = project({x - kStep, y, z});
  const Point2 up = project({x, y + kStep, z}), down = project({x, y - kStep, z});
  const double area = (right[0] - left[0]) * (up[1] - down[1]) - (right[1] - left[1]) * (up[0] - down[0]);
  return bounded(std::sqrt(std::abs(area)) / (2.0 * kStep));
}

}  // namespace touchline
