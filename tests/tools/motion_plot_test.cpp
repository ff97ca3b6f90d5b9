// Figures 9 and 10 of the paper: touchline-replay --plot.
#include "tools/programs/replay/motion_plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>

#include "tools/programs/replay/chart.h"

namespace touchline::replay {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

// Own robot 2 drives along x with 1 m/s, opponent 0 stands. The ball is seen in every second frame.
MotionPlot plot_of(int frames, bool is_ball_seen = true) {
  MotionPlot plot;
  const auto trace = std::make_unique<StepTrace>();
  for (int i = 0; i < frames; ++i) {
    trace->frame.capture_time = Instant(std::chrono::milliseconds(10 * i));
    trace->sightings.robots.clear();
    trace->tracks.robots.clear();
    for (const Team team : {Team::kOwn, Team::kOpponent}) {
      const bool own = team == Team::kOwn;
      RobotSighting sighting;
      sighting.team = team;
      sighting.id = own ? 2 : 0;
      sighting.has_heading = true;
      sighting.pose.position.x_m = own ? 0.01f * static_cast<float>(i) : 0.5f;
      trace->sightings.robots.push_back(sighting);
      RobotTrack track;
      track.team = team;
      track.id = sighting.id;
      track.pose = sighting.pose;
      track.innovation2 = 2.0f;
      trace->tracks.robots.push_back(track);
    }
    trace->sightings.ball.seen = is_ball_seen && i % 2 == 0;
    trace->tracks.ball.state = is_ball_seen ? TrackState::kSeen : TrackState::kLost;
    trace->tracks.ball.innovation2 = trace->sightings.ball.seen ? 1.0f : -1.0f;
    plot.add(*trace);
  }
  return plot;
}

TEST(MotionPlot, ChoosesTheRobotThatDrivesFarthest) {
  const MotionPlot plot = plot_of(20);
  EXPECT_EQ(plot.farthest(), std::pair(Team::kOwn, RobotId{2}));
  EXPECT_TRUE(plot.knows(Team::kOpponent, 0));
  EXPECT_FALSE(plot.knows(Team::kOpponent, 2));
  EXPECT_EQ(MotionPlot().farthest().second, kUnknownId);
}

TEST(MotionPlot, DrawsEverySightingAndInnovation) {
  const auto curves = [](int frames) {
    const std::string svg = plot_of(frames).svg(Team::kOwn, 2, "blue 2");
    EXPECT_EQ(svg.rfind("<?xml", 0), 0U);
    EXPECT_NE(svg.find("</svg>"), std::string::npos);
    return count(svg, " C ");
  };
  // Ten more frames: the robot's path, heading, velocities (2) and innovation; the ball's path, velocities (2) and
  // innovation, each in every second frame. A point consists of the same number of curves everywhere.
  const std::size_t points = 10U * 5U + 5U * 4U, added = curves(40) - curves(30);
  EXPECT_GT(added, 0U);
  EXPECT_EQ(added % points, 0U) << added;
  EXPECT_EQ(curves(60) - curves(40), 2U * added);
}

TEST(MotionPlot, DrawsNoChartsOfWhatWasNeverSeen) {
  // Two dashes of each chart of innovations: the line, and another one beside its name.
  const auto dashes = [](const MotionPlot& plot) { return count(plot.svg(Team::kOwn, 2, "blue 2"), "dasharray"); };
  EXPECT_EQ(dashes(plot_of(20)), 4U);
  EXPECT_EQ(dashes(plot_of(20, false)), 2U);
  EXPECT_EQ(dashes(MotionPlot()), 0U);
  EXPECT_NE(MotionPlot().svg(Team::kOwn, kUnknownId, "").find("</svg>"), std::string::npos);
}

TEST(TickStep, GivesTwoToFiveTicks) {
  EXPECT_DOUBLE_EQ(tick_step(1.0), 0.2);
  EXPECT_DOUBLE_EQ(tick_step(4.0), 1.0);
  EXPECT_DOUBLE_EQ(tick_step(240.0), 50.0);
  for (double range = 0.01; range < 1e4; range *= 1.1) {
    const double ticks = range / tick_step(range);
    EXPECT_GE(ticks, 2.0) << range;
    EXPECT_LE(ticks, 5.0 + 1e-9) << range;
  }
}

}  // namespace
}  // namespace touchline::replay
