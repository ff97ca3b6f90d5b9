#include "tests/marker/painted_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"

namespace touchline::testing {
namespace {}  // namespace

bool covers(const PatchPlace& place, FieldPoint p) {
  const float dx = p.x_m - place.x_m, dy = p.y_m - place.y_m;
  const float c = std::cos(place.turn_rad), s = std::sin(place.turn_rad);
  const float x = c * dx + s * dy, y = c * dy - s * dx;
  switch (place.outline) {
    case PatchOutline::kSquare:
    case PatchOutline::kBar:
      return std::abs(x) <= place.length_m / 2 && std::abs(y) <= place.width_m / 2;
    case PatchOutline::kTriangle: {
      // From the base, which is a third of the height behind the centroid, to the tip.
      const float up = (x + place.length_m / 3) / place.length_m;
      return up >= 0 && up <= 1 && std::abs(y) <= (1 - up) * place.width_m / 2;
    }
    case PatchOutline::kCircle:
      return std::hypot(x / place.length_m, y / place.width_m) <= 0.5f;
  }
  return false;
}

CameraParameters straight_camera() {
  CameraParameters camera;
  camera.full.fx_px = camera.full.fy_px = 500.0f;
  camera.full.cx_px = 319.5f;
  camera.full.cy_px = 239.5f;
  camera.full.rotation_rad = {kPi, 0.0f, 0.0f};
  camera.full.position_m = {0.0f, 0.0f, 2.0f};
  return camera;
}

CameraParameters tilted_camera() {
  CameraParameters camera;
  camera.full.fx_px = camera.full.fy_px = 560.0f;
  camera.full.cx_px = 324.0f;
  camera.full.cy_px = 231.0f;
  camera.full.k1 = -0.16f;
  camera.full.k2 = 0.03f;
  camera.full.rotation_rad = {kPi - 0.14f, 0.03f, 0.02f};
  camera.full.position_m = {0.1f, -0.3f, 2.3f};
  return camera;
}

MarkerParameters paper_teams() {
  MarkerParameters parameters;
  const std::array<std::array<ColorId, 5>, 2> identification{
      {{kRed, kGreen, kMagenta, kCyan, kViolet}, {kPink, kLime, kBrown, kGrey, kWhite}}};
  for (std::size_t t = 0; t < 2; ++t) {
    TeamMarking& team = parameters.teams[t];
    team.layout = paper_layout();
    team.team_color = t == 0 ? kBlue : kYellow;
    for (std::size_t r = 0; r < 5; ++r) {
      RobotMarking robot;
      robot.id = static_cast<RobotId>(r);
      robot.colors.push_back(identification[t][r]);
      team.robots.push_back(robot);
    }
  }
  parameters.ball.color = kOrange;
  return parameters;
}

FieldPoint on_field(const Pose& pose, float x_m, float y_m) {
  const float c = std::cos(pose.theta_rad), s = std::sin(pose.theta_rad);
  return {pose.position.x_m + c * x_m - s * y_m, pose.position.y_m + s * x_m + c * y_m};
}

bool overlap(const Pose& a, const Pose& b, float side_m) {
  // Two squares are separate if all corners of one are beyond a side of the other (separating axis).
  const float half = side_m / 2;
  for (const auto& [base, other] : {std::pair(a, b), std::pair(b, a)}) {
    float left = 1e9f, right = -1e9f, low = 1e9f, high = -1e9f;
    for (const float x : {-half, half}) {
      for (const float y : {-half, half}) {
        const FieldPoint corner = to_robot_frame(base, on_field(other, x, y));
        left = std::min(left, corner.x_m);
        right = std::max(right, corner.x_m);
        low = std::min(low, corner.y_m);
        high = std::max(high, corner.y_m);
      }
    }
    if (left >= half || right <= -half || low >= half || high <= -half) return false;
  }
  return true;
}

std::vector<Placed> scattered(PortableRandom& random, const MarkerParameters& parameters, std::size_t robots,
                              float length_m, float width_m) {
  std::vector<Placed> wanted;
  for (const Team team : {Team::kOwn, Team::kOpponent}) {
    if (parameters.teams[static_cast<std::size_t>(team)].team_color == kBackground) continue;
    for (std::size_t r = 0; r < robots; ++r) wanted.push_back({team, r, {}});
  }
  const float side = std::max(parameters.teams[0].layout.robot_side_m, parameters.teams[1].layout.robot_side_m);
  std::vector<Placed> placed;
  for (int tries = 0; placed.size() < wanted.size(); ++tries) {
    // The first robots may leave no room for the last one.
    if (tries > 1000) {
      placed.clear();
      tries = 0;
    }
    Placed robot = wanted[placed.size()];
    robot.pose.position.x_m = random.real(-length_m / 2, length_m / 2);
    robot.pose.position.y_m = random.real(-width_m / 2, width_m / 2);
    robot.pose.theta_rad = random.real(-kPi, kPi);
    const auto collides = [&](const Placed& p) { return overlap(p.pose, robot.pose, side); };
    if (std::none_of(placed.begin(), placed.end(), collides)) placed.push_back(robot);
  }
  return placed;
}

PaintedField::PaintedField(const CameraParameters& camera, const MarkerParameters& parameters)
    : parameters_(parameters),
      grid_(make_grid(640, 480)),
      labeling_(std::make_unique<Labeling>()),
      matcher_(std::make_unique<Matcher>()),
      runs_(std::make_unique<Runs>()),
      regions_(std::make_unique<Regions>()),
      sightings_(std::make_unique<Sightings>()) {
  EXPECT_TRUE(camera_.configure(camera).ok());
  EXPECT_TRUE(matcher_->configure(parameters, camera_).ok());
}

void PaintedField::clear() { std::fill(grid_.color.begin(), grid_.color.end(), kBackground); }

std::ptrdiff_t PaintedField::pixels_of(ColorId color) const {
  return std::count(grid_.color.begin(), grid_.color.end(), color);
}

template <class Inside>
void PaintedField::fill(const std::array<FieldPoint, 4>& corners, float height_m, ColorId color, Inside inside) {
  // Over a robot's width, the distortion of straight edges is below one pixel.
  constexpr float kMargin = 2.0f;
  float left = 1e9f, right = -1e9f, top = 1e9f, bottom = -1e9f;
  for (const FieldPoint& corner : corners) {
    const PixelPoint p = camera_.to_pixel(corner, height_m);
    left = std::min(left, p.u_px - kMargin);
    right = std::max(right, p.u_px + kMargin);
    top = std::min(top, p.v_px - kMargin);
    bottom = std::max(bottom, p.v_px + kMargin);
  }
  const int first = static_cast<int>(std::max(0.0f, left)), last = std::min(grid_.width - 1, static_cast<int>(right));
  for (int v = static_cast<int>(std::max(0.0f, top)); v <= std::min(grid_.height - 1, static_cast<int>(bottom)); ++v) {
    for (int u = first; u <= last; ++u) {
      const PixelPoint pixel{static_cast<float>(u), static_cast<float>(v)};
      if (inside(camera_.to_field(pixel, height_m))) grid_.at(u, v) = color;
    }
  }
}

std::array<FieldPoint, 4> PaintedField::corners_of(const Pose& pose, FieldPoint low, FieldPoint high) {
  return {on_field(pose, low.x_m, low.y_m), on_field(pose, high.x_m, low.y_m), on_field(pose, high.x_m, high.y_m),
          on_field(pose, low.x_m, high.y_m)};
}

void PaintedField::paint_patch(const Placed& robot, std::size_t patch, ColorId color) {
  const MarkerLayout& layout = marking(robot.team).layout;
  const PatchPlace& place = layout.patches[patch];
  const float reach = 0.7f * std::hypot(place.length_m, place.width_m);
  const auto corners =
      corners_of(robot.pose, {place.x_m - reach, place.y_m - reach}, {place.x_m + reach, place.y_m + reach});
  fill(corners, layout.height_m, color, [&](FieldPoint p) { return covers(place, to_robot_frame(robot.pose, p)); });
}

void PaintedField::paint_part(const Placed& robot, FieldPoint low, FieldPoint high, ColorId color) {
  fill(corners_of(robot.pose, low, high), marking(robot.team).layout.height_m, color, [&](FieldPoint p) {
    const FieldPoint q = to_robot_frame(robot.pose, p);
    return q.x_m >= low.x_m && q.x_m < high.x_m && q.y_m >= low.y_m && q.y_m < high.y_m;
  });
}

void PaintedField::paint(const Placed& robot) {
  const TeamMarking& team = marking(robot.team);
  paint_patch(robot, 0, team.team_color);
  for (std::size_t s = 0; s + 1 < team.layout.patches.size(); ++s) {
    paint_patch(robot, s + 1, team.robots[robot.robot].colors[s]);
  }
}

void PaintedField::paint(const std::vector<Placed>& robots) {
  for (const Placed& robot : robots) paint(robot);
}

void PaintedField::paint_ball(FieldPoint at) {
  const float radius = parameters_.ball.radius_m;
  fill(corners_of({at, 0}, {-radius, -radius}, {radius, radius}), radius, parameters_.ball.color,
       [&](FieldPoint p) { return distance_m(p, at) <= radius; });
}

const Sightings& PaintedField::match(const Frame* frame, const ExpectedGain& light, const ExpectedBall& ball) {
  runs_->clear();
  labeling_->begin(1, 1);
  std::size_t above = 0;
  for (int v = 0; v < grid_.height; ++v) {
    const std::size_t first = runs_->size();
    for (int u = 0; u < grid_.width;) {
      const ColorId color = grid_.at(u, v);
      int end = u + 1;
      while (end < grid_.width && grid_.at(end, v) == color) ++end;
      if (color != kBackground) {
        EXPECT_TRUE(runs_->push_back({static_cast<std::uint16_t>(v), static_cast<std::uint16_t>(u),
                                      static_cast<std::uint16_t>(end), color, kNoRun}));
      }
      u = end;
    }
    std::vector<Contact> contacts;
    for (std::size_t below = first; below < runs_->size(); ++below) {
      for (std::size_t upper = above; upper < first; ++upper) {
        const Run &a = (*runs_)[upper], &b = (*runs_)[below];
        if (a.color != b.color || a.begin >= b.end || b.begin >= a.end) continue;
        contacts.push_back({static_cast<std::uint16_t>(upper - above), static_cast<std::uint16_t>(below - first)});
      }
    }
    labeling_->add_row(*runs_, first, contacts);
    above = first;
  }
  labeling_->finish(*runs_, *regions_);
  for (Region& region : *regions_) region.is_cut = is_cut_;
  matcher_->match(frame, light, ball, *runs_, *regions_, *sightings_);
  return *sightings_;
}

Verdict PaintedField::verdict_at(PixelPoint pixel) const {
  const int u = static_cast<int>(std::lround(pixel.u_px)), v = static_cast<int>(std::lround(pixel.v_px));
  for (std::size_t i = 0; i < regions_->size(); ++i) {
    for (std::uint32_t r = (*regions_)[i].first_run; r != kNoRun; r = (*runs_)[r].next) {
      const Run& run = (*runs_)[r];
      if (run.row == v && run.begin <= u && u < run.end) return sightings_->verdicts[i];
    }
  }
  ADD_FAILURE() << "no region at " << u << ", " << v;
  return Verdict::kNotExamined;
}

Comparison compare(const std::vector<Placed>& placed, const Sightings& seen, const MarkerParameters& parameters,
                   float near_m) {
  Comparison result;
  std::vector<bool> found(placed.size(), false);
  for (const RobotSighting& robot : seen.robots) {
    std::size_t best = placed.size();
    float least = near_m;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      const float d = distance_m(robot.pose.position, placed[i].pose.position);
      if (found[i] || d > least) continue;
      least = d;
      best = i;
    }
    if (best == placed.size()) {
      ++result.ghosts;
      continue;
    }
    found[best] = true;
    const TeamMarking& team = parameters.teams[static_cast<std::size_t>(placed[best].team)];
    const bool same_team = robot.team == placed[best].team;
    const bool named = robot.id != kUnknownId;
    if (!same_team || (named && robot.id != team.robots[placed[best].robot].id)) {
      ++result.wrong;
    } else {
      ++(named ? result.right : result.unknown);
    }
    if (!robot.has_heading) continue;
    result.position_m = std::max(result.position_m, least);
    const float turned = wrap_angle(robot.pose.theta_rad - placed[best].pose.theta_rad);
    result.heading_rad = std::max(result.heading_rad, std::abs(turned));
  }
  result.missed = static_cast<std::size_t>(std::count(found.begin(), found.end(), false));
  return result;
}

}  // namespace touchline::testing
