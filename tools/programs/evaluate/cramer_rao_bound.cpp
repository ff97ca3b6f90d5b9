#include "tools/programs/evaluate/cramer_rao_bound.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "core/geometry/angle.h"
#include "core/marker/rigid_fit.h"
#include "hal/replay/picture.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::evaluate {
namespace {

// A variance estimated from fewer pictures would be too uncertain.
constexpr std::size_t kMinPictures = 3;

// Poses and patch centers of one robot in all results.
struct StaticRobot {
  std::size_t team = 0;
  std::vector<Vector2> position_m;
  std::vector<double> theta_rad;
  std::vector<Vector2> center_px;  // sum of the centers of each patch
};

PixelPoint as_pixel(Vector2 point) { return {static_cast<float>(point.x), static_cast<float>(point.y)}; }

// Returns the Jacobian d(field) / d(pixel), by central differences of half a pixel.
Eigen::Matrix2d field_by_pixel(const CameraModel& camera, PixelPoint at, float height_m) {
  constexpr float kHalf = 0.5f;
  const FieldPoint right = camera.to_field({at.u_px + kHalf, at.v_px}, height_m);
  const FieldPoint left = camera.to_field({at.u_px - kHalf, at.v_px}, height_m);
  const FieldPoint below = camera.to_field({at.u_px, at.v_px + kHalf}, height_m);
  const FieldPoint above = camera.to_field({at.u_px, at.v_px - kHalf}, height_m);
  Eigen::Matrix2d field_by_px;
  field_by_px << static_cast<double>(right.x_m - left.x_m), static_cast<double>(below.x_m - above.x_m),
      static_cast<double>(right.y_m - left.y_m), static_cast<double>(below.y_m - above.y_m);
  return field_by_px;
}

// Returns the derivative of the pose of eq. (3) (x, y, heading) with respect to one coordinate of a patch center.
Eigen::Vector3d pose_by(std::vector<Correspondence> points, std::size_t k, bool along_y) {
  constexpr float kStep = 1e-3f;
  float& coordinate = along_y ? points[k].seen.y_m : points[k].seen.x_m;
  const float there = coordinate;
  coordinate = there + kStep;
  const Pose high = fit_rigidly(points).pose;
  coordinate = there - kStep;
  const Pose low = fit_rigidly(points).pose;
  return Eigen::Vector3d(static_cast<double>(high.position.x_m - low.position.x_m),
                         static_cast<double>(high.position.y_m - low.position.y_m),
                         static_cast<double>(wrap_angle(high.theta_rad - low.theta_rad))) /
         (2.0 * static_cast<double>(kStep));
}

double deviation_of_positions(const std::vector<Vector2>& points) {
  const double n = static_cast<double>(points.size());
  Vector2 mean;
  for (const Vector2& p : points) {
    mean.x += p.x / n;
    mean.y += p.y / n;
  }
  double squares = 0.0;
  for (const Vector2& p : points) squares += (p.x - mean.x) * (p.x - mean.x) + (p.y - mean.y) * (p.y - mean.y);
  return std::sqrt(squares / (n - 1.0));
}

double deviation_of_angles(const std::vector<double>& angles) {
  const double n = static_cast<double>(angles.size());
  double mean = 0.0, squares = 0.0;
  for (const double angle : angles) mean += wrap_angle(angle - angles.front()) / n;
  for (const double angle : angles) squares += std::pow(wrap_angle(angle - angles.front() - mean), 2);
  return std::sqrt(squares / (n - 1.0));
}

bool bound_of(const StaticPictures& pictures, const StaticRobot& robot, const BoundInputs& inputs, PoseBound& out) {
  const MarkerLayout& layout = inputs.layouts[robot.team];
  const std::size_t patches = robot.center_px.size();
  const double n = static_cast<double>(robot.position_m.size());
  std::vector<Vector2> centers;
  std::vector<Correspondence> points;
  for (std::size_t k = 0; k < patches; ++k) {
    centers.push_back({robot.center_px[k].x / n, robot.center_px[k].y / n});
    points.push_back({{layout.patches[k].x_m, layout.patches[k].y_m},
                      inputs.camera.to_field(as_pixel(centers[k]), layout.height_m)});
  }
  Eigen::Matrix3d pose = Eigen::Matrix3d::Zero();
  double squares_px = 0.0;
  for (std::size_t k = 0; k < patches; ++k) {
    // Half the distance to the nearest patch, because pixels closer to that patch belong to it.
    double radius = std::numeric_limits<double>::infinity();
    for (std::size_t other = 0; other < patches; ++other) {
      if (other == k) continue;
      radius = std::min(radius, 0.5 * std::hypot(centers[k].x - centers[other].x, centers[k].y - centers[other].y));
    }
    const StaticPictures::FisherInformation i = pictures.fisher_information(centers[k], radius);
    Eigen::Matrix2d fisher;
    fisher << i.uu, i.uv, i.uv, i.vv;
    if (!(fisher.determinant() > 0.0 && i.uu > 0.0)) return false;
    const Eigen::Matrix2d pixel = fisher.inverse();
    squares_px += pixel.trace();
    const Eigen::Matrix2d field_by_px = field_by_pixel(inputs.camera, as_pixel(centers[k]), layout.height_m);
    Eigen::Matrix<double, 3, 2> pose_by_field;
    pose_by_field << pose_by(points, k, false), pose_by(points, k, true);
    pose += pose_by_field * field_by_px * pixel * field_by_px.transpose() * pose_by_field.transpose();
  }
  out.center_px = std::sqrt(squares_px / static_cast<double>(patches));
  out.position_m = std::sqrt(pose(0, 0) + pose(1, 1));
  out.angle_rad = std::sqrt(pose(2, 2));
  out.position_rms_m = deviation_of_positions(robot.position_m);
  out.angle_rms_rad = deviation_of_angles(robot.theta_rad);
  return true;
}

Result<StaticPictures> read_pictures(const std::vector<FrameRecord>& results, const std::string& folder) {
  std::optional<StaticPictures> pictures;
  std::size_t width = 0, height = 0;
  for (const FrameRecord& record : results) {
    const std::string path = folder + "/" + record.file;
    TOUCHLINE_TRY_ASSIGN(const hal::Picture picture, hal::read_picture(path));
    if (picture.is_16_bit())
      return failure(ErrorCode::kInconsistent, "%s: has more than 8 bits per channel", path.c_str());
    if (!pictures) {
      width = picture.width_px;
      height = picture.height_px;
      pictures.emplace(width, height);
    } else if (picture.width_px != width || picture.height_px != height) {
      return failure(ErrorCode::kInconsistent, "%s: differs in size from the first picture, %zu x %zu", path.c_str(),
                     width, height);
    }
    pictures->add(picture.rgb8);
  }
  pictures->estimate_noise();
  return *std::move(pictures);
}

std::map<std::string, StaticRobot> static_robots(const std::vector<FrameRecord>& results, const BoundInputs& inputs) {
  std::map<std::string, StaticRobot> robots;
  for (const FrameRecord& record : results) {
    for (const RobotRecord& robot : record.sightings.robots) {
      const auto team = std::find(inputs.teams.begin(), inputs.teams.end(), robot.team);
      if (team == inputs.teams.end() || !robot.id.has_value() || !robot.theta_rad.has_value()) continue;
      const auto index = static_cast<std::size_t>(team - inputs.teams.begin());
      const std::size_t patches = inputs.layouts[index].patches.size();
      if (patches < 2 || robot.patches.size() != patches) continue;
      StaticRobot& static_robot = robots[robot.team + " " + std::to_string(*robot.id)];
      static_robot.team = index;
      static_robot.position_m.push_back(robot.position_m);
      static_robot.theta_rad.push_back(*robot.theta_rad);
      static_robot.center_px.resize(patches);
      for (std::size_t k = 0; k < patches; ++k) {
        static_robot.center_px[k].x += robot.patches[k].center_px.x;
        static_robot.center_px[k].y += robot.patches[k].center_px.y;
      }
    }
  }
  std::erase_if(robots, [&](const auto& robot) { return robot.second.position_m.size() != results.size(); });
  return robots;
}

}  // namespace

Result<std::vector<PoseBound>> cramer_rao_bounds(const std::vector<FrameRecord>& results, const std::string& folder,
                                                 const BoundInputs& inputs) {
  if (results.size() < kMinPictures) {
    return failure(ErrorCode::kOutOfRange, "%s: the noise cannot be estimated from fewer than %zu pictures",
                   folder.c_str(), kMinPictures);
  }
  TOUCHLINE_TRY_ASSIGN(const StaticPictures pictures, read_pictures(results, folder));
  std::vector<PoseBound> bounds;
  for (const auto& [name, robot] : static_robots(results, inputs)) {
    PoseBound bound;
    bound.name = name;
    if (bound_of(pictures, robot, inputs, bound)) bounds.push_back(bound);
  }
  if (bounds.empty()) {
    return failure(ErrorCode::kNotFound, "%s: no robot has its id, heading and all its patches in every picture",
                   folder.c_str());
  }
  return bounds;
}

void print(const std::vector<PoseBound>& bounds, std::ostream& out) {
  constexpr double kMillimeters = 1000.0, kDegrees = 180.0 / std::numbers::pi;
  char text[160];
  const auto row = [&](const PoseBound& b) {
    std::snprintf(text, sizeof text, "%-20s %9.4f %10.4f %10.4f %8.2f %10.4f %10.4f %8.2f", b.name.c_str(), b.center_px,
                  b.position_m * kMillimeters, b.position_rms_m * kMillimeters, b.position_rms_m / b.position_m,
                  b.angle_rad * kDegrees, b.angle_rms_rad * kDegrees, b.angle_rms_rad / b.angle_rad);
    out << text << '\n';
  };
  out << "Cramer-Rao bound of stationary robots for the noise of these pictures, and the measured deviation\n";
  std::snprintf(text, sizeof text, "%-20s %9s %10s %10s %8s %10s %10s %8s", "", "patch px", "bound mm", "RMS mm",
                "times", "bound deg", "RMS deg", "times");
  out << text << '\n';
  PoseBound all;
  all.name = "RMS of all";
  const double n = static_cast<double>(bounds.size());
  const auto rms = [&](double PoseBound::*field) {
    double squares = 0.0;
    for (const PoseBound& b : bounds) squares += b.*field * b.*field / n;
    all.*field = std::sqrt(squares);
  };
  for (double PoseBound::*field : {&PoseBound::center_px, &PoseBound::position_m, &PoseBound::angle_rad,
                                   &PoseBound::position_rms_m, &PoseBound::angle_rms_rad}) {
    rms(field);
  }
  for (const PoseBound& b : bounds) row(b);
  row(all);
}

std::string with_bounds(const std::string& json, const std::vector<PoseBound>& bounds) {
  auto document = nlohmann::ordered_json::parse(json);
  auto list = nlohmann::ordered_json::array();
  for (const PoseBound& b : bounds) {
    list.push_back({{"name", b.name},
                    {"center_px", b.center_px},
                    {"position_m", b.position_m},
                    {"angle_rad", b.angle_rad},
                    {"position_rms_m", b.position_rms_m},
                    {"angle_rms_rad", b.angle_rms_rad}});
  }
  document["bound"] = list;
  return document.dump(2) + "\n";
}

}  // namespace touchline::evaluate
