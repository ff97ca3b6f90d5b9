#include "tools/programs/arena/scene_files.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

namespace touchline::arena {
namespace {

using hal::mock::ArenaParameters;
using hal::mock::ArenaRobot;
using hal::mock::Lens;
using hal::mock::Placement;
using hal::mock::Side;
using Json = nlohmann::ordered_json;

double rounded(double value, double parts) { return std::round(value * parts) / parts; }
double pixel(double value) { return rounded(value, 1e3); }
double meters(double value) { return rounded(value, 1e6); }

const std::string& team_color(const ArenaParameters& parameters, const ArenaRobot& robot) {
  return robot.team == Side::kOwn ? parameters.own_color : parameters.opponent_color;
}

Json pixel_of(const Lens& lens, double x_m, double y_m, double z_m) {
  const auto [u, v] = lens.project({x_m, y_m, z_m});
  return Json::array({pixel(u), pixel(v)});
}

Json patch_pixel(const ArenaParameters& parameters, const Lens& lens, const Placement& robot, std::size_t patch) {
  const auto& painted = parameters.patch[patch];
  const auto at = rotated({painted.x_m, painted.y_m}, robot.theta_rad);
  return pixel_of(lens, robot.x_m + at.x, robot.y_m + at.y, parameters.robot_height_m);
}

// Returns points of the empty field that a person can identify.
struct NamedPoint {
  const char* what;
  double x_m, y_m;
};
std::vector<NamedPoint> named_field_points(const hal::mock::ArenaField& field) {
  const double x = 0.5 * field.length_m, y = 0.5 * field.width_m;
  const double goal = 0.5 * field.goal_width_m, corner = field.corner_m;
  std::vector<NamedPoint> marks;
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      marks.push_back({"goal post", sx * x, sy * goal});
      marks.push_back({"corner piece at the goal line", sx * x, sy * (y - corner)});
      marks.push_back({"corner piece at the side line", sx * (x - corner), sy * y});
    }
    marks.push_back({"center line at the side line", 0.0, sx * y});
    marks.push_back({"circle on the center line", 0.0, sx * field.circle_radius_m});
    marks.push_back({"circle along the field", sx * field.circle_radius_m, 0.0});
  }
  return marks;
}

// Rounds to half a pixel, which is about the best precision of a mouse click.
double clicked(double pixel) { return rounded(pixel, 2.0); }

}  // namespace

std::string truth_line(const SceneFrame& frame, const std::string& file, const ArenaParameters& parameters,
                       const Lens& lens) {
  Json line;
  line["file"] = file;
  line["t"] = rounded(frame.t_s, 1e6);
  line["ball"] = nullptr;
  line["robots"] = Json::array();
  if (frame.objects) {
    const Placement ball = between(frame.begin.ball, frame.end.ball, 0.5);
    const Json at = pixel_of(lens, ball.x_m, ball.y_m, parameters.ball_radius_m);
    line["ball"] = {{"x", meters(ball.x_m)}, {"y", meters(ball.y_m)}, {"u", at[0]}, {"v", at[1]}};
    for (std::size_t i = 0; i < frame.begin.robots.size(); ++i) {
      const ArenaRobot& robot = parameters.robot[i];
      const Placement place = between(frame.begin.robots[i], frame.end.robots[i], 0.5);
      Json entry{{"team", team_color(parameters, robot)},
                 {"id", robot.id},
                 {"x", meters(place.x_m)},
                 {"y", meters(place.y_m)},
                 {"theta", meters(place.theta_rad)},
                 {"team_px", patch_pixel(parameters, lens, place, 0)}};
      for (std::size_t k = 1; k < parameters.patch.size(); ++k) {
        entry["ident_px"].push_back(patch_pixel(parameters, lens, place, k));
      }
      line["robots"].push_back(entry);
    }
  }
  return line.dump();
}

std::string clicks(const std::vector<SceneFrame>& frames, const std::vector<std::string>& files,
                   const ArenaParameters& parameters, const Lens& lens) {
  Json samples = Json::array();
  const auto add = [&](const std::string& file, const std::string& color, const Json& at) {
    samples.push_back(
        {{"image", file}, {"color", color}, {"u", clicked(at[0].get<double>())}, {"v", clicked(at[1].get<double>())}});
  };
  for (std::size_t m = 0; m < frames.size(); ++m) {
    if (!frames[m].objects) continue;
    const Placement& ball = frames[m].begin.ball;
    add(files[m], parameters.ball_color, pixel_of(lens, ball.x_m, ball.y_m, parameters.ball_radius_m));
    for (std::size_t i = 0; i < frames[m].begin.robots.size(); ++i) {
      const ArenaRobot& robot = parameters.robot[i];
      for (std::size_t k = 0; k < parameters.patch.size(); ++k) {
        add(files[m], k == 0 ? team_color(parameters, robot) : robot.colors[k - 1],
            patch_pixel(parameters, lens, frames[m].begin.robots[i], k));
      }
    }
  }
  return Json{{"samples", samples}}.dump(1) + "\n";
}

std::string scene_description(const ArenaParameters& parameters, const Lens& lens) {
  const auto& field = parameters.field;
  const double x = 0.5 * field.length_m, y = 0.5 * field.width_m;
  Json points = Json::array();
  for (const NamedPoint& mark : named_field_points(field)) {
    points.push_back({{"what", mark.what},
                      {"x", meters(mark.x_m)},
                      {"y", meters(mark.y_m)},
                      {"pixel", pixel_of(lens, mark.x_m, mark.y_m, 0.0)}});
  }
  Json corners = Json::array();
  for (const auto& [cx, cy] : {std::pair{-x, -y}, {x, -y}, {x, y}, {-x, y}}) {
    corners.push_back(pixel_of(lens, cx, cy, 0.0));
  }
  return Json{{"field_m", {field.length_m, field.width_m}},
              {"corners_px", corners},
              {"points", points},
              {"robot_side_m", parameters.robot_side_m},
              {"robot_height_m", parameters.robot_height_m},
              {"ball_radius_m", parameters.ball_radius_m},
              {"camera_m", lens.position_m()}}
             .dump(1) +
         "\n";
}

std::string field_points(const ArenaParameters& parameters, const Lens& lens) {
  std::ostringstream lines;
  for (const NamedPoint& mark : named_field_points(parameters.field)) {
    const auto [u, v] = lens.project({mark.x_m, mark.y_m, 0.0});
    lines << mark.x_m << ',' << mark.y_m << ',' << clicked(u) << ',' << clicked(v) << '\n';
  }
  return lines.str();
}

}  // namespace touchline::arena
