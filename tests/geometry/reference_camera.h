#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <vector>

#include "core/geometry/camera_model.h"

// Cameras from first principles, in double: a product of rotations about single axes, a pinhole, and the
// lens equations as printed in their sources. This file does not call the code under test.
namespace touchline::testing {

using Point2 = std::array<double, 2>;
using Point3 = std::array<double, 3>;

inline double distance(Point2 a, Point2 b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }
inline double distance(PixelPoint a, PixelPoint b) {
  return std::hypot(static_cast<double>(a.u_px) - static_cast<double>(b.u_px),
                    static_cast<double>(a.v_px) - static_cast<double>(b.v_px));
}
inline double distance(FieldPoint a, Point2 b) {
  return std::hypot(static_cast<double>(a.x_m) - b[0], static_cast<double>(a.y_m) - b[1]);
}
inline FieldPoint field_point(Point2 p) { return {static_cast<float>(p[0]), static_cast<float>(p[1])}; }
inline PixelPoint pixel_point(Point2 p) { return {static_cast<float>(p[0]), static_cast<float>(p[1])}; }

/// With zero angles it looks vertically down; the field's x is right and y is up in the picture. `yaw` rotates it about
/// the field's z, `pitch` and `roll` then about the picture's horizontal and vertical axis.
struct Pinhole {
  double yaw_rad = 0, pitch_rad = 0, roll_rad = 0;
  Point3 position_m{0, 0, 2};

  [[nodiscard]] Eigen::Matrix3d rotation() const {
    const auto turn = [](double angle, const Eigen::Vector3d& axis) {
      return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    };
    Eigen::Matrix3d down;
    down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
    return turn(roll_rad, Eigen::Vector3d::UnitY()) * turn(pitch_rad, Eigen::Vector3d::UnitX()) * down *
           turn(yaw_rad, Eigen::Vector3d::UnitZ());
  }
  /// Returns ideal normalized coordinates at depth 1: right and down from the optical axis.
  [[nodiscard]] Point2 project(Point3 p) const {
    const Eigen::Vector3d c =
        rotation() * Eigen::Vector3d(p[0] - position_m[0], p[1] - position_m[1], p[2] - position_m[2]);
    return {c.x() / c.z(), c.y() / c.z()};
  }
  /// Returns the vanishing point of this direction in the same coordinates.
  [[nodiscard]] Point2 vanishing_point(Point3 direction) const {
    const Eigen::Vector3d c = rotation() * Eigen::Vector3d(direction[0], direction[1], direction[2]);
    return {c.x() / c.z(), c.y() / c.z()};
  }
};

/// A pinhole with Brown's lens, and the corresponding parameters.
struct FullCamera {
  Pinhole pinhole;
  FullModelParameters lens;  // lens parameters; rotation and position are zero

  [[nodiscard]] CameraParameters parameters() const {
    CameraParameters out;
    out.kind = CameraModelKind::kFull;
    out.full = lens;
    const Eigen::AngleAxisd turn(pinhole.rotation());
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      out.full.rotation_rad[k] = static_cast<float>(turn.angle() * turn.axis()[i]);
      out.full.position_m[k] = static_cast<float>(pinhole.position_m[k]);
    }
    return out;
  }
  /// Applies Brown 1971 in OpenCV's order, term by term.
  [[nodiscard]] Point2 pixel(Point3 point) const {
    const auto [x, y] = pinhole.project(point);
    const auto value = [](float v) { return static_cast<double>(v); };
    const double k1 = value(lens.k1), k2 = value(lens.k2), k3 = value(lens.k3), p1 = value(lens.p1),
                 p2 = value(lens.p2);
    const double r2 = x * x + y * y;
    const double radial = 1 + k1 * r2 + k2 * std::pow(r2, 2) + k3 * std::pow(r2, 3);
    return {value(lens.fx_px) * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + value(lens.cx_px),
            value(lens.fy_px) * (y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + value(lens.cy_px)};
  }
};

/// Returns the radius by Klancar eq. (12) in its exponential form.
inline double paper_radius(double r, double h) { return h / 2 * (1 - std::exp(-2 * r / h)) / std::exp(-r / h); }

/// Removes the radial distortion of a pixel relative to the picture's center, by Klancar eq. (12) and (13).
inline Point2 paper_straighten(Point2 distorted, double h) {
  const double r = std::sqrt(distorted[0] * distorted[0] + distorted[1] * distorted[1]);
  const double phi = std::atan2(distorted[1], distorted[0]);
  return {paper_radius(r, h) * std::cos(phi), paper_radius(r, h) * std::sin(phi)};
}

/// Applies Klancar eq. (14), solved as two linear equations by Cramer's rule.
inline Point2 paper_untilt(Point2 straight, double p, double q) {
  const auto [x, y] = straight;
  const double determinant = (p * x - 1) * (q * y - 1) - q * x * p * y;
  return {(-x * (q * y - 1) + y * q * x) / determinant, (-(p * x - 1) * y + p * y * x) / determinant};
}

/// A pinhole with the paper's lens, whose H is the pinhole's focal length, and the corresponding parameters.
struct PaperCamera {
  Pinhole pinhole;
  double h_px = 600;
  Point2 center_px{319.5, 239.5};

  [[nodiscard]] Point2 pixel(Point3 point) const {
    const auto [x, y] = pinhole.project(point);
    const double rectified = h_px * std::hypot(x, y), phi = std::atan2(y, x);
    const double r = h_px * std::asinh(rectified / h_px);
    return {center_px[0] + r * std::cos(phi), center_px[1] + r * std::sin(phi)};
  }
  [[nodiscard]] CameraParameters parameters() const {
    // The line through both vanishing points is pX + qY = 1; they may be at infinity, so it is computed in homogeneous
    // coordinates as the cross product of the two directions in the camera's frame.
    const Eigen::Matrix3d r = pinhole.rotation();
    const Eigen::Vector3d line = r.col(0).cross(r.col(1));
    const double p = -line.x() / (line.z() * h_px), q = -line.y() / (line.z() * h_px);
    // The remaining map is affine, so three points of the floor determine it.
    Eigen::Matrix3d rectified, floor;
    rectified.setOnes();
    floor.setOnes();
    const std::array<Point2, 3> corners{{{-1, -0.8}, {1, -0.8}, {0, 0.9}}};
    for (int i = 0; i < 3; ++i) {
      const Point2 at = corners[static_cast<std::size_t>(i)];
      const Point2 ideal = pinhole.project({at[0], at[1], 0});
      const Point2 flat = paper_untilt({h_px * ideal[0], h_px * ideal[1]}, p, q);
      rectified.col(i).head<2>() = Eigen::Vector2d(flat[0], flat[1]);
      floor.col(i).head<2>() = Eigen::Vector2d(at[0], at[1]);
    }
    const Eigen::Matrix3d affine = floor * rectified.inverse();
    CameraParameters out;
    out.kind = CameraModelKind::kPaper;
    out.paper.center_u_px = static_cast<float>(center_px[0]);
    out.paper.center_v_px = static_cast<float>(center_px[1]);
    out.paper.focal_px = static_cast<float>(h_px);
    out.paper.p_per_px = static_cast<float>(p);
    out.paper.q_per_px = static_cast<float>(q);
    for (int i = 0; i < 6; ++i)
      out.paper.affine[static_cast<std::size_t>(i)] = static_cast<float>(affine(i / 3, i % 3));
    for (std::size_t i = 0; i < 3; ++i) out.paper.position_m[i] = static_cast<float>(pinhole.position_m[i]);
    return out;
  }
};

inline constexpr int kWidth = 640, kHeight = 480;

inline bool in_picture(Point2 pixel) {
  return pixel[0] >= -0.5 && pixel[0] <= kWidth - 0.5 && pixel[1] >= -0.5 && pixel[1] <= kHeight - 0.5;
}

/// Returns every 8th pixel, and the border to its outermost edge, half a pixel beyond the outermost centers.
inline std::vector<PixelPoint> whole_picture() {
  std::vector<float> us{-0.5f, kWidth - 0.5f}, vs{-0.5f, kHeight - 0.5f};
  for (int u = 0; u < kWidth; u += 8) us.push_back(static_cast<float>(u));
  for (int v = 0; v < kHeight; v += 8) vs.push_back(static_cast<float>(v));
  std::vector<PixelPoint> out;
  for (const float u : us) {
    for (const float v : vs) out.push_back({u, v});
  }
  return out;
}

/// Returns true if the pixel is above the horizon, where the model differs.
inline bool over_horizon(const CameraModel& model, PixelPoint pixel) {
  const std::array<float, 3> d = model.ray(pixel).direction;
  const double level = std::hypot(static_cast<double>(d[0]), static_cast<double>(d[1]));
  return static_cast<double>(-d[2]) < 1.001 * CameraModel::kMinDip * level;
}

/// Returns points of the field of 2.2 m x 1.8 m and its goals, in steps of 10 cm.
inline std::vector<Point2> whole_field() {
  std::vector<Point2> out;
  for (int x = -13; x <= 13; ++x) {
    for (int y = -9; y <= 9; ++y) out.push_back({0.1 * x, 0.1 * y});
  }
  return out;
}

/// Heights of the floor, the ball's center, a robot's patches, and the tallest robots of other leagues.
inline constexpr std::array<float, 4> kHeights{0.0f, 0.02135f, 0.075f, 0.15f};

}  // namespace touchline::testing
