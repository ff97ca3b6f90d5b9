#include "tools/programs/rectify/straightness.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tools/programs/calibrate/field/edge_search.h"
#include "tools/programs/calibrate/field/field_drawing.h"

namespace touchline::rectify {
namespace {

constexpr double kStep_px = 3.0;
// Largest distance from the line at which a point is kept, for successive fits.
constexpr std::array<double, 4> kKeep_px{6.0, 3.0, 1.5, 1.5};

struct Line {
  Eigen::Vector2d normal{1, 0};
  double distance = 0;
  [[nodiscard]] double off(const Point& p) const { return std::abs(normal.x() * p[0] + normal.y() * p[1] - distance); }
};

// Fits a line by total least squares.
Line line_through(const std::vector<Point>& points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Point& p : points) mean += Eigen::Vector2d(p[0], p[1]) / static_cast<double>(points.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Point& p : points) {
    const Eigen::Vector2d away = Eigen::Vector2d(p[0], p[1]) - mean;
    spread += away * away.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(spread);  // closed form; the iterative solver takes seconds to compile
  const Eigen::Vector2d normal = axes.eigenvectors().col(0);
  return {normal, normal.dot(mean)};
}

Point floor_m(const CameraModel& camera, const Point& pixel) {
  const FieldPoint p = camera.to_field({static_cast<float>(pixel[0]), static_cast<float>(pixel[1])}, 0.0f);
  return {static_cast<double>(p.x_m), static_cast<double>(p.y_m)};
}

double scale_at(const CameraModel& camera, const Point& pixel) {
  const Point at = floor_m(camera, pixel);
  return static_cast<double>(camera.scale_px_per_m({static_cast<float>(at[0]), static_cast<float>(at[1])}, 0.0f));
}

// `per_m`: units of `places` per meter, for each point; `px_per_unit`: pixels of the picture per unit.
Deviation deviation(const std::vector<Point>& places, const std::vector<double>& per_m, double px_per_unit) {
  const Line line = line_through(places);
  Deviation out;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double off = line.off(places[i]), mm = 1e3 * off / per_m[i];
    out.rms_px += off * off * px_per_unit * px_per_unit;
    out.rms_mm += mm * mm;
    out.max_mm = std::max(out.max_mm, mm);
  }
  out.rms_px = std::sqrt(out.rms_px / static_cast<double>(places.size()));
  out.rms_mm = std::sqrt(out.rms_mm / static_cast<double>(places.size()));
  return out;
}

}  // namespace

std::vector<BorderPoint> border_points(const hal::Picture& picture, const CameraModel& camera,
                                       const FieldParameters& field, std::array<std::size_t, 4>& left_out) {
  left_out = {};
  const std::vector<calibrate::Mark> marks = calibrate::marks_of(calibrate::bare_drawing(field));
  const calibrate::LightPicture light({picture});
  const auto found = calibrate::find_marks(light, camera, marks, kStep_px, kReach_px);
  std::vector<BorderPoint> kept;
  for (std::size_t side = 0; side < 4; ++side) {
    std::vector<BorderPoint> all;
    for (const calibrate::MarkPoint& p : found) {
      if (marks[p.mark].side == static_cast<int>(side)) all.push_back({side, {p.u_px, p.v_px}});
    }
    std::vector<BorderPoint> near = all;
    for (const double keep_px : kKeep_px) {
      if (near.size() < 3) break;
      std::vector<Point> places;
      places.reserve(near.size());
      for (const BorderPoint& p : near) places.push_back(floor_m(camera, p.pixel));
      const Line line = line_through(places);
      near.clear();
      std::copy_if(all.begin(), all.end(), std::back_inserter(near), [&](const BorderPoint& p) {
        return line.off(floor_m(camera, p.pixel)) * scale_at(camera, p.pixel) < keep_px;
      });
    }
    left_out[side] = all.size() - near.size();
    kept.insert(kept.end(), near.begin(), near.end());
  }
  return kept;
}

std::array<SideStraightness, 4> straightness(const std::vector<BorderPoint>& points,
                                             const std::array<std::size_t, 4>& left_out, const CameraModel& camera,
                                             const LensMap& lens, double scale_px_per_m) {
  std::array<SideStraightness, 4> out;
  for (std::size_t side = 0; side < 4; ++side) {
    out[side].left_out = left_out[side];
    std::vector<Point> pixels, straight, floor;
    std::vector<double> seen_scale, straight_scale;
    for (const BorderPoint& p : points) {
      if (p.side != side) continue;
      pixels.push_back(p.pixel);
      straight.push_back(lens.undistorted(p.pixel));
      floor.push_back(floor_m(camera, p.pixel));
      seen_scale.push_back(scale_at(camera, p.pixel));
      // The lens stretches the surroundings of a point by the square root of the determinant of the Jacobian.
      const Point right = lens.undistorted({p.pixel[0] + 1, p.pixel[1]});
      const Point below = lens.undistorted({p.pixel[0], p.pixel[1] + 1});
      const Point& at = straight.back();
      const double area = (right[0] - at[0]) * (below[1] - at[1]) - (right[1] - at[1]) * (below[0] - at[0]);
      straight_scale.push_back(seen_scale.back() * std::sqrt(std::abs(area)));
    }
    out[side].points = pixels.size();
    if (pixels.size() < 3) continue;
    out[side].distorted = deviation(pixels, seen_scale, 1.0);
    out[side].straightened = deviation(straight, straight_scale, 1.0);
    out[side].rectified = deviation(floor, std::vector<double>(floor.size(), 1.0), scale_px_per_m);
  }
  return out;
}

}  // namespace touchline::rectify
