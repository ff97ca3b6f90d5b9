#include "tests/calibrate/drawn_team.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "firmware/config/standard_layouts.h"
#include "hal/mock/lens.h"
#include "hal/mock/random.h"
#include "tools/programs/calibrate/colors/color_names.h"
#include "tools/programs/calibrate/field/field_fit.h"
#include "tools/programs/command_line/formatted.h"

namespace touchline::calibrate {
namespace {

constexpr int kTeamWidth = 640, kTeamHeight = 480;

struct FieldSize {
  double length_m, width_m;
};

class Draft {
 public:
  explicit Draft(unsigned seed) : random_(seed, 3), seed_(seed) {}

  DrawnTeam drawn(std::size_t pictures) {
    choose_layout();
    choose_hall();
    while (!choose_paints()) continue;
    choose_robots();
    choose_camera();
    DrawnTeam out;
    out.team_file = team_file();
    out.venue = venue();
    const bool yuv = chance(0.5);
    out.format = yuv ? "yuyv" : "rgb24";
    Exposure exposure;
    exposure.tint = {random_.uniform(0.85, 1.15), 1, random_.uniform(0.75, 1.15)};
    exposure.gain = random_.uniform(0.35, 1.3);
    exposure.veil = random_.uniform(0, 0.02);
    exposure.blur_px = random_.uniform(0.5, 1.2);
    exposure.noise = random_.uniform(1, 4);
    exposure.shares_chroma = yuv || chance(0.3);
    const bool close = chance(0.25);
    for (std::size_t i = 0; i < pictures; ++i) {
      TeamScene scene = scene_;
      place(scene, close);
      out.pictures.push_back({draw_scene(scene, field_, lens_, light_, exposure, kTeamWidth, kTeamHeight,
                                         seed_ + 1000 * static_cast<unsigned>(i)),
                              scene});
    }
    out.about = formatted(
        "%s, %s, %zu + %zu robots%s, floor %.0f %.0f %.0f, body %.0f, gain %.2f, tint %.2f %.2f, blur %.1f, noise "
        "%.1f%s;",
        std::string(layout_->name).c_str(), out.format.c_str(), robots_[0].size(), robots_[1].size(),
        close ? ", close together" : "", scene_.floor[0], scene_.floor[1], scene_.floor[2], scene_.body[0],
        exposure.gain, exposure.tint[0], exposure.tint[2], exposure.blur_px, exposure.noise,
        exposure.shares_chroma ? ", chroma shared" : "");
    for (const auto& [name, rgb] : paint_)
      out.about += formatted(" %s %.0f %.0f %.0f,", name.c_str(), rgb[0], rgb[1], rgb[2]);
    return out;
  }

 private:
  bool chance(double probability) { return random_.bernoulli(probability); }
  std::size_t below(std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(random_.uniform() * static_cast<double>(count)));
  }
  template <class T>
  void shuffle(std::vector<T>& items) {
    for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[below(i)]);
  }

  void choose_layout() {
    const auto layouts = config::standard_layouts();
    layout_ = &layouts[seed_ % layouts.size()];
    scene_.layout = layout_->layout;
    const std::string name(layout_->name);
    const FieldSize size = name == "ssl-butterfly" ? FieldSize{3.0, 2.2}
                           : name == "mirosot-triangles" || (name == "two-squares" && chance(0.5))
                               ? FieldSize{2.2, 1.8}
                               : FieldSize{1.5, 1.3};
    field_.length_m = size.length_m;
    field_.width_m = size.width_m;
    if (name != "ssl-butterfly" && chance(0.3)) scene_.layout.height_m = 0.04F;
    // Patches are cut by hand, so their sizes vary.
    const auto cut = static_cast<float>(random_.uniform(0.88, 1.03));
    for (PatchPlace& place : scene_.layout.patches) {
      place.length_m *= cut;
      place.width_m *= cut;
      place.x_m += static_cast<float>(0.001 * random_.normal());
      place.y_m += static_cast<float>(0.001 * random_.normal());
    }
  }

  void choose_hall() {
    const std::array<PaintRgb, 5> floors{{{40, 42, 44}, {60, 120, 75}, {125, 125, 120}, {130, 100, 75}, {22, 22, 24}}};
    scene_.floor = floors[below(floors.size())];
    const double shade = random_.uniform(0.8, 1.2);
    for (double& c : scene_.floor) c *= shade;
    scene_.line = {225, 225, 220};
    scene_.outside = {118, 114, 106};
    const double body = chance(0.1) ? random_.uniform(150, 220) : random_.uniform(15, 60);
    scene_.body = {body, body, body};
    light_.ambient = random_.uniform(0.1, 0.6);
    light_.lamp.clear();
    for (std::size_t i = 0; i < 2 + below(3); ++i) {
      light_.lamp.push_back({random_.uniform(-0.7, 0.7) * field_.length_m, random_.uniform(-0.7, 0.7) * field_.width_m,
                             random_.uniform(1.8, 3.0), random_.uniform(0.5, 1.0)});
    }
  }

  // Returns the paint of a name: with another hue, usually duller and darker.
  PaintRgb mixed(const std::string& name) {
    const Rgb usual = *usual_rgb(name);
    const double turn = 0.13 * random_.normal(), dull = random_.uniform(0.4, 1.1), dark = random_.uniform(0.65, 1.1);
    const double y = 0.299 * usual[0] + 0.587 * usual[1] + 0.114 * usual[2];
    const double i = 0.596 * (usual[0] - y) - 0.274 * (usual[1] - y) - 0.322 * (usual[2] - y);
    const double q = 0.211 * (usual[0] - y) - 0.523 * (usual[1] - y) + 0.312 * (usual[2] - y);
    const double a = dull * (std::cos(turn) * i - std::sin(turn) * q),
                 b = dull * (std::sin(turn) * i + std::cos(turn) * q);
    PaintRgb out{y + 0.956 * a + 0.621 * b, y - 0.272 * a - 0.647 * b, y - 1.106 * a + 1.703 * b};
    for (double& c : out) c = std::clamp(c * dark, 8.0, 250.0);
    return out;
  }

  bool choose_paints() {
    static const std::vector<std::string> names = {
        "red",      "green", "magenta", "pink",       "cyan",       "purple",    "lime",   "mint",
        "brown",    "white", "grey",    "light blue", "dark green", "turquoise", "violet", "navy",
        "lavender", "gold",  "maroon",  "salmon",     "olive",      "teal"};
    const bool usual_teams = chance(0.75);
    std::vector<std::string> all = names;
    shuffle(all);
    std::vector<std::string> chosen = {"blue", "yellow", chance(0.85) ? "orange" : "red"};
    if (!usual_teams) {
      chosen[0] = chance(0.5) ? "cyan" : "green";
      chosen[1] = chance(0.5) ? "magenta" : "yellow";
    }
    const std::size_t places = scene_.layout.patches.size() - 1;
    const std::size_t wanted = 3 + (places == 1 ? 2 + below(4) : places == 2 ? 3 + below(2) : 2);
    constexpr double kNamesApart = 30, kPaintsApart = 18;
    for (const std::string& name : all) {
      if (chosen.size() == wanted) break;
      const bool apart = std::none_of(chosen.begin(), chosen.end(), [&](const std::string& other) {
        return difference(lab_of(*usual_rgb(name)), lab_of(*usual_rgb(other))) < kNamesApart;
      });
      if (apart) chosen.push_back(name);
    }
    if (chosen.size() < wanted) return false;
    std::vector<Lab> looks, expected;
    std::vector<PaintRgb> rgbs;
    for (const std::string& name : chosen) {
      rgbs.push_back(mixed(name));
      looks.push_back(lab_of(rgbs.back()));
      expected.push_back(lab_of(*usual_rgb(name)));
    }
    const Lab floor = lab_of(scene_.floor);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (!is_plausible(usual_rgb(chosen[i]), rgbs[i])) return false;
      if (difference(looks[i], floor) < kPaintsApart) return false;
      if (difference(looks[i], lab_of(scene_.body)) < kPaintsApart / 2) return false;
      for (std::size_t k = 0; k < i; ++k) {
        if (difference(looks[i], looks[k]) < kPaintsApart) return false;
        const double right = difference(looks[i], expected[i]) + difference(looks[k], expected[k]);
        const double exchanged = difference(looks[i], expected[k]) + difference(looks[k], expected[i]);
        if (right + kPaintsApart / 2 > exchanged) return false;
      }
    }
    paint_.clear();
    for (std::size_t i = 0; i < chosen.size(); ++i) paint_[chosen[i]] = rgbs[i];
    names_ = chosen;
    return true;
  }

  void choose_robots() {
    const std::size_t places = scene_.layout.patches.size() - 1;
    const std::vector<std::string> marks(names_.begin() + 3, names_.end());
    std::vector<std::vector<std::string>> combinations{{}};
    for (std::size_t k = 0; k < places; ++k) {
      std::vector<std::vector<std::string>> longer;
      for (const auto& begun : combinations) {
        for (const std::string& mark : marks) {
          if (places == 2 && k == 1 && begun[0] == mark) continue;
          longer.push_back(begun);
          longer.back().push_back(mark);
        }
      }
      combinations = longer;
    }
    const std::size_t most = std::min<std::size_t>(combinations.size(), 6);
    const std::size_t own = 2 + below(most - 1), other = 1 + below(std::min<std::size_t>(most, 11 - own));
    for (const std::size_t team : {std::size_t{0}, std::size_t{1}}) {
      shuffle(combinations);
      robots_[team].assign(combinations.begin(),
                           combinations.begin() + static_cast<std::ptrdiff_t>(team == 0 ? own : other));
      for (std::size_t id = 0; id < robots_[team].size(); ++id) {
        StandingRobot robot;
        robot.team = static_cast<Team>(team);
        robot.id = static_cast<int>(id);
        robot.paint = {paint_[names_[team]]};
        for (const std::string& name : robots_[team][id]) robot.paint.push_back(paint_[name]);
        const double shine = chance(0.2) ? 0.1 : 0.01;
        for (std::size_t i = 0; i < robot.paint.size(); ++i) robot.glare.push_back(random_.uniform(0, shine));
        scene_.robots.push_back(robot);
      }
    }
    scene_.ball = paint_[names_[2]];
  }

  void choose_camera() {
    const double height = random_.uniform(0.9, 1.4) * field_.length_m + (field_.length_m < 2 ? 0.4 : 0.0);
    lens_.cubic = random_.uniform(-0.08, 0.02);
    lens_.position_m = {random_.uniform(-0.08, 0.08), random_.uniform(-0.08, 0.08), height};
    lens_.aim_m = {random_.uniform(-0.04, 0.04), random_.uniform(-0.04, 0.04)};
    lens_.roll_rad = random_.uniform(-0.05, 0.05);
    lens_.center_u_px = kTeamWidth / 2.0 + random_.uniform(-4, 4);
    lens_.center_v_px = kTeamHeight / 2.0 + random_.uniform(-4, 4);
    const auto radius = [&](double reach_m) {
      const double angle = std::atan(reach_m / height);
      return angle + lens_.cubic * angle * angle * angle;
    };
    lens_.focal_px = 0.93 * std::min(kTeamWidth / 2.0 / radius(field_.length_m / 2 + 0.1),
                                     kTeamHeight / 2.0 / radius(field_.width_m / 2 + 0.1));
  }

  // Places the robots far apart; with `close`, one pair nearly touches.
  void place(TeamScene& scene, bool close) {
    const auto side = static_cast<double>(scene.layout.robot_side_m);
    std::vector<std::pair<double, double>> taken;
    const auto free_place = [&](double margin, double apart) {
      for (;;) {
        const double x = random_.uniform(-1, 1) * (field_.length_m / 2 - margin);
        const double y = random_.uniform(-1, 1) * (field_.width_m / 2 - margin);
        if (std::all_of(taken.begin(), taken.end(),
                        [&](const auto& other) { return std::hypot(x - other.first, y - other.second) > apart; })) {
          taken.emplace_back(x, y);
          return taken.back();
        }
      }
    };
    for (StandingRobot& robot : scene.robots) {
      std::tie(robot.x_m, robot.y_m) = free_place(0.75 * side, 1.7 * side);
      robot.theta_rad = random_.uniform(-3.14, 3.14);
    }
    if (close) {
      scene.robots[1].theta_rad = scene.robots[0].theta_rad;
      const double turn = scene.robots[0].theta_rad;
      const double sign = scene.robots[0].x_m * std::cos(turn) + scene.robots[0].y_m * std::sin(turn) > 0 ? -1 : 1;
      const double x = scene.robots[0].x_m + sign * 1.05 * side * std::cos(turn);
      const double y = scene.robots[0].y_m + sign * 1.05 * side * std::sin(turn);
      const bool free = std::all_of(scene.robots.begin() + 2, scene.robots.end(), [&](const StandingRobot& other) {
        return std::hypot(x - other.x_m, y - other.y_m) > 1.5 * side;
      });
      if (free) {
        scene.robots[1].x_m = x;
        scene.robots[1].y_m = y;
        taken[1] = {x, y};
      }
    }
    std::tie(scene.ball_x_m, scene.ball_y_m) = free_place(0.05, 0.75 * side + 0.04);
  }

  [[nodiscard]] std::string team_file() const {
    std::string text = "version = 1\n[ball]\ncolor = \"" + names_[2] + "\"\nradius_m = 0.02135\n";
    for (const std::size_t team : {std::size_t{0}, std::size_t{1}}) {
      text += formatted("[%s]\nlayout = \"%s\"\ncolor = \"%s\"\nheight_m = %.3f\nmax_robots = %zu\n",
                        team == 0 ? "own" : "opponent", std::string(layout_->name).c_str(), names_[team].c_str(),
                        static_cast<double>(scene_.layout.height_m), robots_[team].size());
      for (std::size_t id = 0; id < robots_[team].size(); ++id) {
        text += formatted("[[%s.robot]]\nid = %zu\ncolors = [", team == 0 ? "own" : "opponent", id);
        for (std::size_t k = 0; k < robots_[team][id].size(); ++k)
          text += (k > 0 ? ", \"" : "\"") + robots_[team][id][k] + "\"";
        text += "]\n";
      }
    }
    return text;
  }

  config::VenueFile venue() {
    const hal::mock::Lens lens(lens_);
    FieldFitInput input;
    input.width_px = kTeamWidth;
    input.height_px = kTeamHeight;
    input.camera_height_m = lens_.position_m[2] + random_.uniform(-0.01, 0.01);
    for (int i = -2; i <= 2; ++i) {
      for (int k = -2; k <= 2; ++k) {
        const double x = i * field_.length_m / 4, y = k * field_.width_m / 4;
        const auto [u, v] = lens.project({x, y, 0.0});
        input.points.push_back({x, y, u + 0.5 * random_.normal(), v + 0.5 * random_.normal()});
      }
    }
    FieldFit fit;
    EXPECT_EQ(fit_field(input, fit).text(), "");
    config::VenueFile out;
    out.picture.width_px = kTeamWidth;
    out.picture.height_px = kTeamHeight;
    out.field.length_m = static_cast<float>(field_.length_m);
    out.field.width_m = static_cast<float>(field_.width_m);
    out.camera_model = fit.camera;
    return out;
  }

  hal::mock::Random random_;
  unsigned seed_;
  const config::StandardLayout* layout_ = nullptr;
  TeamScene scene_;
  hal::mock::ArenaField field_;
  hal::mock::LightParameters light_;
  hal::mock::LensParameters lens_;
  std::vector<std::string> names_;  // own, opponent, ball, identification
  std::map<std::string, PaintRgb> paint_;
  std::array<std::vector<std::vector<std::string>>, 2> robots_;
};

}  // namespace

DrawnTeam draw_team(unsigned seed, std::size_t pictures) { return Draft(seed).drawn(pictures); }

}  // namespace touchline::calibrate
