// Robots that no region shows, because the image of a lamp lies over them, and that their tracks expect.
#include <cmath>
#include <functional>
#include <vector>

#include "core/subpixel/missed_robots.h"
#include "core/subpixel/paint_colors.h"
#include "tests/marker/painted_colors.h"
#include "tests/subpixel/top_fit_fixture.h"

namespace touchline::testing {
namespace {

// White light by place in the picture, in linear light.
using Lamp = std::function<double(double, double)>;

// The robot in the picture has id 3: the team color, and the light of kPatchLight[1] and of further patches.
class MissedRobotsTest : public TopFitTest {
 protected:
  static constexpr ColorId kOtherTeam = 9;
  static constexpr RobotId kThere = 3, kOther = 4;

  void show(const MarkerLayout& layout, PixelFormat format = PixelFormat::kRgb24) {
    use(layout);
    const auto know = [&](ColorId color, const Light& light) {
      Rgb rgb;
      for (std::size_t c = 0; c < 3; ++c) rgb[c] = 255.0 * std::pow(light[c], 1.0 / 2.2);
      typical_[color] = pixel_value(rgb, color_space(format));
      typical_.measured[color] = true;
    };
    for (std::size_t k = 0; k < kPatchLight.size(); ++k) know(static_cast<ColorId>(k + 1), kPatchLight[k]);
    know(kOtherTeam, {0.75, 0.7, 0.04});
    teams_ = {};
    for (TeamMarking& team : teams_) {
      team.layout = layout;
      RobotMarking there, other;
      there.id = kThere;
      other.id = kOther;
      for (std::size_t k = 1; k < layout.patches.size(); ++k) {
        there.colors.push_back(static_cast<ColorId>(k + 1));
        other.colors.push_back(static_cast<ColorId>(layout.patches.size() == 2 ? 5 : layout.patches.size() - k + 1));
      }
      team.robots.push_back(there);
      team.robots.push_back(other);
    }
    teams_[0].team_color = 1;
    teams_[1].team_color = kOtherTeam;
    missed_.configure(camera_, {});
    missed_.set_teams(teams_);
    missed_.set_typical(typical_);
    format_ = format;
  }
  [[nodiscard]] Photograph under(const Lamp& lamp, bool is_there = true) const {
    Photograph picture(format_, 640, 480);
    const Square exposed = surroundings(truth_);
    picture.expose(exposed.left_px, exposed.top_px, exposed.right_px, exposed.bottom_px, [&](double u, double v) {
      Light all = is_there ? light(truth_, 1.0f, u, v) : kFloor;
      for (double& one : all) one += lamp(u, v);
      return all;
    });
    return picture;
  }
  // A spot beside the robot's center, about two robots wide.
  [[nodiscard]] Lamp spot(double share) const {
    const PixelPoint at = camera_.to_pixel(truth_.position, layout_.height_m);
    return [=](double u, double v) {
      const double away = std::hypot(u - static_cast<double>(at.u_px) - 4, v - static_cast<double>(at.v_px) + 3) / 20;
      return share * std::exp(-0.5 * away * away);
    };
  }
  static double dark(double, double) { return 0; }

  // Finds robots where a track expects one, 3 mm and 3 degrees beside the truth.
  const Sightings& find(const Photograph& picture, RobotId expected = kThere, Team team = Team::kOwn) {
    ExpectedRobots robots;
    robots.push_back({team,
                      expected,
                      {{truth_.position.x_m + 0.002f, truth_.position.y_m - 0.002f}, truth_.theta_rad + 3 * kDegree}});
    const Frame frame = picture.frame();
    fit_.refine(frame, sightings_);
    missed_.find(frame, {}, robots, fit_, sightings_);
    return sightings_;
  }
  void expect_found(const Photograph& picture, float position_m, RobotId expected = kThere) {
    sightings_.robots.clear();
    find(picture, expected);
    ASSERT_EQ(sightings_.robots.size(), 1u);
    const RobotSighting& robot = sightings_.robots[0];
    EXPECT_EQ(robot.id, kThere);
    EXPECT_GT(robot.confidence, 0.85f);
    EXPECT_LT(distance_m(robot.pose.position, truth_.position), position_m);
    EXPECT_LT(std::abs(wrap_angle(robot.pose.theta_rad - truth_.theta_rad)), 1.0f * kDegree);
  }

  const Pose truth_{{0.3f, -0.2f}, 0.7f};
  PixelFormat format_ = PixelFormat::kRgb24;
  TypicalColors typical_;
  TeamMarkings teams_;
  MissedRobots missed_;
};

TEST_F(MissedRobotsTest, AreFoundUnderALamp) {
  for (const MarkerLayout& layout : {paper_layout(), single_layout(), disks_layout()}) {
    show(layout);
    for (const double share : {0.0, 0.15, 0.3}) {
      SCOPED_TRACE(::testing::Message() << layout.patches.size() << " patches, " << share);
      expect_found(under(spot(share)), 0.0006f);
    }
  }
}

TEST_F(MissedRobotsTest, AreFoundInYuv) {
  show(paper_layout(), PixelFormat::kYuyv);
  expect_found(under(spot(0.15)), 0.0015f);
}

// A track confirms neither its name nor itself.
TEST_F(MissedRobotsTest, HaveTheNameThatTheyShow) {
  show(paper_layout());
  expect_found(under(spot(0.15)), 0.0006f, kOther);
}

TEST_F(MissedRobotsTest, AreNotFoundWhereNoneIs) {
  show(paper_layout());
  EXPECT_TRUE(find(under(dark, false)).robots.empty());
  EXPECT_TRUE(find(under(spot(0.3), false)).robots.empty());
}

TEST_F(MissedRobotsTest, AreNotFoundAtTheOtherTeamsRobot) {
  show(paper_layout());
  EXPECT_TRUE(find(under(dark), kThere, Team::kOpponent).robots.empty());
  EXPECT_TRUE(find(under(spot(0.15)), kThere, Team::kOpponent).robots.empty());
}

TEST_F(MissedRobotsTest, AreNotFoundIfTheyWereRecognized) {
  show(paper_layout());
  const Photograph picture = under(dark);
  // At this place, under another name.
  RobotSighting seen = sighting(truth_);
  seen.id = kOther;
  sightings_.robots.push_back(seen);
  EXPECT_EQ(find(picture).robots.size(), 1u);
  EXPECT_EQ(sightings_.robots[0].id, kOther);
  // Elsewhere, under the name that is shown here.
  sightings_.robots.clear();
  seen = sighting({{-0.5f, 0.3f}, 0.0f});
  seen.id = kThere;
  sightings_.robots.push_back(seen);
  EXPECT_EQ(find(picture, kOther).robots.size(), 1u);
  EXPECT_EQ(sightings_.robots[0].pose.position.x_m, -0.5f);
}

TEST_F(MissedRobotsTest, ReplaceASightingWithoutAName) {
  show(paper_layout());
  RobotSighting seen;
  seen.pose.position = {truth_.position.x_m + 0.02f, truth_.position.y_m};
  sightings_.robots.push_back(seen);
  find(under(spot(0.15)));
  ASSERT_EQ(sightings_.robots.size(), 1u);
  EXPECT_EQ(sightings_.robots[0].id, kThere);
}

// A top of colors that no robot of the team has.
TEST_F(MissedRobotsTest, AreNotFoundWhereAStrangerStands) {
  show(paper_layout());
  patch_light_[1] = {0.25, 0.24, 0.26};
  EXPECT_TRUE(find(under(spot(0.15))).robots.empty());
}

TEST_F(MissedRobotsTest, AreNotNamedIfAColorIsUnknown) {
  show(paper_layout());
  typical_.measured[5] = false;  // that of the other robot
  missed_.set_typical(typical_);
  EXPECT_TRUE(find(under(dark)).robots.empty());
}

TEST_F(MissedRobotsTest, AreNoMoreThanTheTeamHas) {
  show(paper_layout());
  teams_[0].max_robots = 1;
  missed_.set_teams(teams_);
  sightings_.robots.push_back(sighting({{-0.5f, 0.3f}, 0.0f}));
  sightings_.robots[0].id = kUnknownId;
  EXPECT_EQ(find(under(dark)).robots.size(), 1u);
}

TEST_F(MissedRobotsTest, DoNotReplaceASightingWithADoubt) {
  show(paper_layout());
  RobotSighting seen = sighting(truth_);
  seen.id = kUnknownId;
  seen.doubt = IdDoubt::kSeveralIds;
  sightings_.robots.push_back(seen);
  find(under(dark));
  ASSERT_EQ(sightings_.robots.size(), 1u);
  EXPECT_EQ(sightings_.robots[0].id, kUnknownId);
}

// Colors under an uneven lamp are those without it.
TEST_F(MissedRobotsTest, PaintsAreSeenWithoutTheLamp) {
  show(disks_layout());
  for (const double share : {0.0, 0.1, 0.3}) {
    PaintColors paints;
    ASSERT_TRUE(see_paints(under(spot(share)).frame(), camera_, layout_, truth_,
                           {static_cast<float>(kTop[0]), static_cast<float>(kTop[1]), static_cast<float>(kTop[2])},
                           kSaturatedValue, paints));
    for (std::size_t k = 0; k < paints.size(); ++k) {
      for (std::size_t c = 0; c < 3; ++c) {
        if (paints[k].saturated[c]) continue;
        const float light = std::pow(paints[k].rgb[c] / 255.0f, 2.2f);
        EXPECT_NEAR(light, static_cast<float>(kPatchLight[k][c]), 0.02f) << share << ", patch " << k << ", " << c;
      }
    }
  }
}

}  // namespace
}  // namespace touchline::testing
