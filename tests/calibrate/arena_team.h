#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "hal/mock/lens.h"
#include "tests/calibrate/arena_photograph.h"
#include "tools/programs/calibrate/colors/auto_detect.h"
#include "tools/programs/calibrate/field/field_fit.h"

namespace touchline::calibrate {

/// Two teams of the arena at random positions: pictures with their true content, and the files to calibrate colors
/// with.
class ArenaTeam : public ::testing::Test {
 protected:
  ArenaTeam() {
    FieldFitInput input;
    input.width_px = kWidth;
    input.height_px = kHeight;
    input.camera_height_m = arena_.camera.position_m[2];
    for (int i = 0; i < 4; ++i) {
      const double x = (i == 1 || i == 2 ? 0.5 : -0.5) * arena_.field.length_m;
      const double y = (i >= 2 ? 0.5 : -0.5) * arena_.field.width_m;
      const auto [u, v] = lens_.project({x, y, 0.0});
      input.points.push_back({x, y, u, v});
    }
    FieldFit fit;
    EXPECT_EQ(fit_field(input, fit).text(), "");
    venue_.exists = true;
    venue_.file.camera_model = fit.camera;
    venue_.file.field.length_m = static_cast<float>(arena_.field.length_m);
    venue_.file.field.width_m = static_cast<float>(arena_.field.width_m);
    Result<TeamColors> team = read_team_colors(TOUCHLINE_MOCK_TEAM);
    EXPECT_TRUE(team.ok()) << team.text();
    team_ = std::move(team).value();
  }

  // The robots stand on a grid of 0.2 m, in mixed order and at different angles.
  void add_picture(const std::string& name, unsigned seed, const std::function<void(hal::Picture&)>& paint = {},
                   std::optional<std::pair<double, double>> ball = {}) {
    std::mt19937 random(seed);
    std::vector<std::pair<double, double>> places;
    for (int i = 0; i < 80; ++i) places.emplace_back(-0.9 + 0.2 * (i % 10), -0.7 + 0.2 * (i / 10));
    std::shuffle(places.begin(), places.end(), random);
    hal::mock::Snapshot things;
    for (std::size_t i = 0; i < arena_.robot.size(); ++i) {
      const double angle = std::uniform_real_distribution<double>(-3.1, 3.1)(random);
      things.robots.push_back({places[i].first, places[i].second, angle});
      const double team = angle + std::atan2(1.0, 1.0), reach = std::hypot(0.01875, 0.01875);
      const auto at = [&](double side) {
        const auto [u, v] = lens_.project({places[i].first + side * reach * std::cos(team),
                                           places[i].second + side * reach * std::sin(team), arena_.robot_height_m});
        return std::pair{u, v};
      };
      truth_[name].push_back({arena_.robot[i].team == hal::mock::Side::kOwn ? "blue" : "yellow", at(1)});
      truth_[name].push_back({arena_.robot[i].colors[0], at(-1)});
    }
    if (!ball) ball = places.back();
    things.ball = {ball->first, ball->second, 0};
    const auto [u, v] = lens_.project({things.ball.x_m, things.ball.y_m, arena_.ball_radius_m});
    truth_[name].push_back({"orange", {u, v}});
    hal::Picture photo = photograph(arena_, hal::mock::Floor::kField, seed, &things);
    if (paint) paint(photo);
    Frame frame;
    frame.format = PixelFormat::kRgb24;
    frame.width_px = kWidth;
    frame.height_px = kHeight;
    frame.stride_bytes[0] = 3 * kWidth;
    frame.plane[0] = photo.rgb8.data();
    pictures_[name] = CameraPicture::copy_of(frame);
  }

  // Returns the true color of the patch at the click; "" if there is none within 4 pixels.
  std::string truth_at(const Click& click) const {
    for (const auto& [color, place] : truth_.at(click.image)) {
      if (std::hypot(click.u_px - place.first, click.v_px - place.second) < 4) return color;
    }
    return "";
  }

  hal::mock::ArenaParameters arena_;
  const hal::mock::Lens lens_{arena_.camera};
  VenueDraft venue_;
  TeamColors team_;
  std::map<std::string, CameraPicture> pictures_;
  std::map<std::string, std::vector<std::pair<std::string, std::pair<double, double>>>> truth_;
};

}  // namespace touchline::calibrate
