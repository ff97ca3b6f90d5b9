#include <gtest/gtest.h>

#include <limits>

#include "tests/marker/painted_field.h"

namespace touchline::testing {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The paper's layout with one change.
template <class Change>
ErrorCode layout_with(Change change) {
  MarkerLayout layout = paper_layout();
  change(layout);
  return validate(layout).code();
}

TEST(Validation, Layouts) {
  EXPECT_EQ(layout_with([](MarkerLayout&) {}), ErrorCode::kOk);
  EXPECT_EQ(layout_with([](MarkerLayout& l) { l.patches.clear(); }), ErrorCode::kOutOfRange);
  for (const float bad : {0.0f, -0.1f, kNan, kInfinity}) {
    EXPECT_EQ(layout_with([bad](MarkerLayout& l) { l.robot_side_m = bad; }), ErrorCode::kOutOfRange) << bad;
    EXPECT_EQ(layout_with([bad](MarkerLayout& l) { l.patches[0].length_m = bad; }), ErrorCode::kOutOfRange) << bad;
    EXPECT_EQ(layout_with([bad](MarkerLayout& l) { l.patches[1].width_m = bad; }), ErrorCode::kOutOfRange) << bad;
  }
  for (const float bad : {-0.01f, kNan, kInfinity}) {
    EXPECT_EQ(layout_with([bad](MarkerLayout& l) { l.height_m = bad; }), ErrorCode::kOutOfRange) << bad;
  }
  EXPECT_EQ(layout_with([](MarkerLayout& l) { l.height_m = 0.0f; }), ErrorCode::kOk);
  for (const float bad : {0.038f, -0.038f, kNan, kInfinity}) {
    EXPECT_EQ(layout_with([bad](MarkerLayout& l) { l.patches[0].x_m = bad; }), ErrorCode::kOutOfRange) << bad;
    EXPECT_EQ(layout_with([bad](MarkerLayout& l) { l.patches[1].y_m = bad; }), ErrorCode::kOutOfRange) << bad;
  }
  for (const float bad : {kNan, kInfinity}) {
    EXPECT_EQ(layout_with([bad](MarkerLayout& l) { l.patches[0].turn_rad = bad; }), ErrorCode::kOutOfRange) << bad;
  }
  EXPECT_EQ(layout_with([](MarkerLayout& l) { l.patches[0].role = PatchRole::kIdentification; }),
            ErrorCode::kInconsistent);
  EXPECT_EQ(layout_with([](MarkerLayout& l) { l.patches[1].role = PatchRole::kTeam; }), ErrorCode::kInconsistent);
}

template <class Change>
ErrorCode team_with(Change change) {
  TeamMarking team = paper_teams().teams[0];
  change(team);
  return validate(team).code();
}

TEST(Validation, Teams) {
  EXPECT_EQ(team_with([](TeamMarking&) {}), ErrorCode::kOk);
  EXPECT_EQ(team_with([](TeamMarking& t) { t.robots.clear(); }), ErrorCode::kOk);
  EXPECT_EQ(team_with([](TeamMarking& t) { t.robots[2].id = -1; }), ErrorCode::kOutOfRange);
  EXPECT_EQ(team_with([](TeamMarking& t) { t.robots[2].id = t.robots[0].id; }), ErrorCode::kInconsistent);
  EXPECT_EQ(team_with([](TeamMarking& t) { t.robots[2].colors = t.robots[0].colors; }), ErrorCode::kInconsistent);
  EXPECT_EQ(team_with([](TeamMarking& t) { t.robots[2].colors.push_back(kLime); }), ErrorCode::kInconsistent);
  EXPECT_EQ(team_with([](TeamMarking& t) { t.robots[2].colors.clear(); }), ErrorCode::kInconsistent);
  EXPECT_EQ(team_with([](TeamMarking& t) { t.robots[2].colors[0] = t.team_color; }), ErrorCode::kInconsistent);
  EXPECT_EQ(team_with([](TeamMarking& t) { t.robots[2].colors[0] = kBackground; }), ErrorCode::kOutOfRange);
  EXPECT_EQ(team_with([](TeamMarking& t) { t.robots[2].colors[0] = kMaxColors + 1; }), ErrorCode::kOutOfRange);
  EXPECT_EQ(team_with([](TeamMarking& t) { t.team_color = kMaxColors + 1; }), ErrorCode::kOutOfRange);
  EXPECT_EQ(team_with([](TeamMarking& t) { t.max_robots = kMaxRobotsPerTeam + 1; }), ErrorCode::kOutOfRange);
  // A team that is not searched is not validated.
  EXPECT_EQ(team_with([](TeamMarking& t) {
              t.team_color = kBackground;
              t.layout.patches.clear();
            }),
            ErrorCode::kOk);
}

template <class Change>
ErrorCode matcher_with(Change change) {
  MarkerParameters parameters = paper_teams();
  change(parameters);
  CameraModel camera;
  EXPECT_TRUE(camera.configure(straight_camera()).ok());
  return std::make_unique<Matcher>()->configure(parameters, camera).code();
}

TEST(Validation, WholeSets) {
  EXPECT_EQ(matcher_with([](MarkerParameters&) {}), ErrorCode::kOk);
  EXPECT_EQ(matcher_with([](MarkerParameters& p) { p.ball.color = kBackground; }), ErrorCode::kOk);
  EXPECT_EQ(matcher_with([](MarkerParameters& p) { p.teams[1].robots[0].id = -2; }), ErrorCode::kOutOfRange);
  EXPECT_EQ(matcher_with([](MarkerParameters& p) { p.teams[1].team_color = kBlue; }), ErrorCode::kInconsistent);
  EXPECT_EQ(matcher_with([](MarkerParameters& p) { p.teams[1].robots[0].colors[0] = kBlue; }),
            ErrorCode::kInconsistent);
  EXPECT_EQ(matcher_with([](MarkerParameters& p) { p.ball.color = kBlue; }), ErrorCode::kInconsistent);
  EXPECT_EQ(matcher_with([](MarkerParameters& p) { p.ball.color = kPink; }), ErrorCode::kInconsistent);
  EXPECT_EQ(matcher_with([](MarkerParameters& p) { p.ball.color = kMaxColors + 1; }), ErrorCode::kOutOfRange);
  for (const float bad : {0.0f, -1.0f, kNan, kInfinity}) {
    EXPECT_EQ(matcher_with([bad](MarkerParameters& p) { p.ball.radius_m = bad; }), ErrorCode::kOutOfRange) << bad;
    EXPECT_EQ(matcher_with([bad](MarkerParameters& p) { p.field.length_m = bad; }), ErrorCode::kOutOfRange) << bad;
    EXPECT_EQ(matcher_with([bad](MarkerParameters& p) { p.field.width_m = bad; }), ErrorCode::kOutOfRange) << bad;
  }
}

// Both teams may use the same identification colors.
TEST(Validation, TeamsMayShareIdentificationColors) {
  EXPECT_EQ(matcher_with([](MarkerParameters& p) { p.teams[1].robots = p.teams[0].robots; }), ErrorCode::kOk);
}

// A rejected configuration leaves no partial state.
TEST(Validation, AfterAnErrorNothingIsReported) {
  MarkerParameters parameters = paper_teams();
  PaintedField field(straight_camera(), parameters);
  PortableRandom random(1);
  field.paint(scattered(random, parameters, 2, 1, 1));
  field.match();
  Matcher matcher;
  parameters.ball.color = kBlue;
  ASSERT_FALSE(matcher.configure(parameters, field.camera()).ok());
  const auto runs = std::make_unique<Runs>();
  const auto seen = std::make_unique<Sightings>();
  matcher.match(*runs, field.regions(), *seen);
  EXPECT_TRUE(seen->robots.empty());
  EXPECT_EQ(seen->verdicts.size(), field.regions().size());
}

}  // namespace
}  // namespace touchline::testing
