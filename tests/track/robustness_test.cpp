// For any input, the output is finite, ordered and reproducible.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "core/track/tracker.h"
#include "tests/track/simulated_robot.h"

namespace touchline {
namespace {

bool finite(const Pose& p) {
  return std::isfinite(p.position.x_m) && std::isfinite(p.position.y_m) && std::isfinite(p.theta_rad);
}
bool finite(const Twist& t) { return std::isfinite(t.v_mps) && std::isfinite(t.w_radps); }
bool finite(FieldPoint p) { return std::isfinite(p.x_m) && std::isfinite(p.y_m); }

void expect_sound(const Tracks& tracks) {
  ASSERT_TRUE(finite(tracks.ball.position) && finite(tracks.ball.velocity));
  ASSERT_TRUE(finite(tracks.ball.position_at_action) && finite(tracks.ball.velocity_at_action));
  ASSERT_TRUE(std::isfinite(tracks.ball.sigma_m));
  ASSERT_GE(tracks.action_time, tracks.capture_time);
  for (std::size_t i = 0; i < tracks.robots.size(); ++i) {
    const RobotTrack& r = tracks.robots[i];
    ASSERT_TRUE(finite(r.pose) && finite(r.pose_at_action) && finite(r.twist) && finite(r.twist_at_action));
    for (const float sigma : r.sigma) ASSERT_TRUE(std::isfinite(sigma) && sigma >= 0.0f);
    ASSERT_NE(r.state, TrackState::kLost);
    ASSERT_LE(std::abs(static_cast<double>(r.pose.theta_rad)), std::numbers::pi);
    for (std::size_t k = 0; k < i; ++k) {
      const RobotTrack& before = tracks.robots[k];
      ASSERT_LE(before.team, r.team);
      ASSERT_FALSE(before.team == r.team && before.id == r.id && r.id != kUnknownId)
          << "an id must have only one track";
    }
  }
}

// Random sightings and commands, including NaN and infinity.
class Chaos {
 public:
  explicit Chaos(unsigned seed) : random_(seed) {}
  float number() {
    switch (dice(12)) {
      case 0:
        return std::numeric_limits<float>::quiet_NaN();
      case 1:
        return std::numeric_limits<float>::infinity();
      case 2:
        return -std::numeric_limits<float>::max();
      case 3:
        return 1e30f;
      case 4:
        return std::numeric_limits<float>::denorm_min();
      default:
        return std::uniform_real_distribution<float>(-1.5f, 1.5f)(random_);
    }
  }
  int dice(int sides) { return std::uniform_int_distribution<int>(0, sides - 1)(random_); }
  Sightings sightings() {
    Sightings s;
    s.ball.seen = dice(3) > 0;
    s.ball.position = {number(), number()};
    const int count = dice(23);
    for (int i = 0; i < count; ++i) {
      RobotSighting r;
      r.team = dice(2) == 0 ? Team::kOwn : Team::kOpponent;
      r.id = static_cast<RobotId>(dice(20) - 4);
      r.has_heading = dice(2) == 0;
      r.pose = {{number(), number()}, number()};
      r.residual_m = number();
      s.robots.push_back(r);
    }
    return s;
  }
  Commands commands() {
    Commands c;
    c.stop = dice(10) == 0;
    const int count = dice(12);
    for (int i = 0; i < count; ++i) c.robots.push_back({static_cast<RobotId>(i), {number(), number()}, {}});
    return c;
  }

 private:
  std::mt19937 random_;
};

std::uint64_t run_chaos(unsigned seed, int frames) {
  Chaos chaos(seed);
  Tracker tracker;
  EXPECT_TRUE(tracker.configure({}).ok());
  Tracks tracks;
  std::uint64_t hash = 14695981039346656037ull;
  double t = 10.0;
  for (int k = 0; k < frames; ++k) {
    switch (chaos.dice(20)) {
      case 0:
        t -= 0.01;
        break;  // backwards
      case 1:
        break;  // the same frame again
      case 2:
        t += 30.0;
        break;  // a pause
      case 3:
        t -= 5.0;
        break;  // the clock was set
      default:
        t += 1.0 / 60.0;
        break;
    }
    tracker.update(chaos.sightings(), at(t), at(t + 0.05 * (chaos.dice(40) - 4)), tracks);
    expect_sound(tracks);
    if (::testing::Test::HasFatalFailure()) return 0;
    tracker.add_commands(chaos.commands(), at(t + 0.02 * chaos.dice(5)));
    for (const RobotTrack& r : tracks.robots) {
      for (const float value :
           {r.pose.position.x_m, r.pose.theta_rad, r.twist.w_radps, r.pose_at_action.position.y_m}) {
        std::uint32_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        hash = (hash ^ bits) * 1099511628211ull;
      }
    }
  }
  return hash;
}

TEST(TrackerRobustness, AnyInputGivesFiniteOutput) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    run_chaos(seed, 800);
    if (HasFatalFailure()) return;
  }
}

TEST(TrackerRobustness, SameInputGivesTheSameBits) {
  EXPECT_EQ(run_chaos(5, 500), run_chaos(5, 500));
  EXPECT_NE(run_chaos(5, 500), run_chaos(6, 500)) << "otherwise the hash does not depend on the input";
}

TEST(TrackerRobustness, FramesWithOldStampsAreIgnored) {
  Tracker tracker;
  ASSERT_TRUE(tracker.configure({}).ok());
  Tracks tracks, again;
  Sightings sightings;
  sightings.robots.push_back(sighting_of(Team::kOwn, 1, {{0.1f, 0.2f}, 0.3f}));
  for (int k = 0; k < 10; ++k) tracker.update(sightings, at(1.0 + 0.02 * k), at(1.0 + 0.02 * k), tracks);
  sightings.robots[0].pose.position.x_m = 0.101f;
  for (const double t : {1.18, 1.1, 1.18}) {
    tracker.update(sightings, at(t), at(t + 0.05), again);
    ASSERT_EQ(again.robots.size(), 1u);
    EXPECT_EQ(again.robots[0].pose.position.x_m, tracks.robots[0].pose.position.x_m);
    EXPECT_EQ(again.robots[0].sigma, tracks.robots[0].sigma);
    EXPECT_EQ(again.capture_time, at(1.18));
  }
  // One hour back: a different clock. The old tracks are invalid.
  tracker.update(sightings, at(-3600.0), at(-3600.0), again);
  ASSERT_EQ(again.robots.size(), 1u);
  EXPECT_EQ(again.robots[0].state, TrackState::kNew);
  EXPECT_EQ(again.capture_time, at(-3600.0));
}

TEST(TrackerRobustness, MoreRobotsThanTracksAreCounted) {
  Tracker tracker;
  ASSERT_TRUE(tracker.configure({}).ok());
  Tracks tracks;
  const auto row = [](double y) {
    Sightings s;
    for (int i = 0; i < 22; ++i) s.robots.push_back(patch_alone(Team::kOpponent, -1.0 + 0.09 * i, y));
    return s;
  };
  tracker.update(row(0.0), at(1.0), at(1.0), tracks);
  EXPECT_EQ(tracks.robots.size(), 22u);
  EXPECT_EQ(tracker.dropped(), 0u);
  // All robots elsewhere in the next frame: tracks without a sighting are replaced, and the counter shows it.
  tracker.update(row(0.5), at(1.02), at(1.02), tracks);
  EXPECT_EQ(tracks.robots.size(), 22u);
  EXPECT_EQ(tracker.dropped(), 22u);
  for (const RobotTrack& robot : tracks.robots) EXPECT_FLOAT_EQ(robot.pose.position.y_m, 0.5f);
}

}  // namespace
}  // namespace touchline
