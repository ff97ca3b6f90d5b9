#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "core/geometry/vector2.h"
#include "core/track/tracker.h"
#include "tests/track/simulated_robot.h"

namespace touchline {

/// Robots of one team that drive around, seen with noise and in random order. The test sets which id a robot shows.
class MovingTeam {
 public:
  MovingTeam(unsigned seed, double rate_hz, std::size_t robots)
      : random_(seed), period_s_(1.0 / rate_hz), robots_(robots) {
    EXPECT_TRUE(tracker_.configure({}).ok());
    for (std::size_t i = 0; i < robots; ++i) {
      // Lanes are 0.2 m wide, so the robots never touch.
      robots_[i].lane_m = 0.2 * static_cast<double>(i) - 0.4;
      robots_[i].phase_rad = uniform(-3.0, 3.0);
      robots_[i].turn_radps = uniform(0.3, 1.0);
      robots_[i].heading = chance(0.5) ? 0.0 : std::numbers::pi;
      shown_.push_back(static_cast<RobotId>(i));
    }
  }

  /// A robot that drives to and fro along x. If it has a speed, it drives straight on.
  struct Robot {
    double lane_m = 0.0, phase_rad = 0.0, turn_radps = 0.0, heading = 0.0;
    Vector2 place;
    std::optional<double> speed_mps;
  };

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
  Robot& robot(std::size_t i) { return robots_[i]; }
  RobotId& shown(std::size_t i) { return shown_[i]; }
  void set_sighting_confidence(float confidence) { sighting_confidence_ = confidence; }
  void hide(std::size_t i, bool hidden) { shown_[i] = hidden ? kHidden : static_cast<RobotId>(i); }
  void stop(std::size_t i) {
    robots_[i].place = {0.5 - 0.3 * static_cast<double>(i), 0.0};
    robots_[i].speed_mps = 0.0;
  }
  [[nodiscard]] double now_s() const { return now_s_; }

  /// Drives all robots along their lanes and tracks them for a frame.
  void frame() {
    for (Robot& robot : robots_) {
      if (robot.speed_mps) {
        robot.place.x += *robot.speed_mps * period_s_;
        continue;
      }
      robot.phase_rad += robot.turn_radps * period_s_;
      robot.place = {0.7 * std::sin(robot.phase_rad), robot.lane_m};
    }
    track();
  }
  void track() {
    Sightings sightings;
    std::vector<std::size_t> order(robots_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random_);
    std::normal_distribution<double> noise(0.0, 0.001);
    for (const std::size_t i : order) {
      if (shown_[i] == kHidden) continue;
      const Robot& robot = robots_[i];
      const Pose seen = pose(robot.place.x + noise(random_), robot.place.y + noise(random_), robot.heading);
      RobotSighting sighting = sighting_of(Team::kOpponent, shown_[i], seen);
      sighting.confidence = sighting_confidence_;
      if (shown_[i] == kUnknownId) sighting = patch_alone(Team::kOpponent, robot.place.x, robot.place.y);
      sightings.robots.push_back(sighting);
    }
    now_s_ += period_s_;
    tracker_.update(sightings, at(now_s_), at(now_s_), tracks_);
    for (std::size_t a = 0; a < tracks_.robots.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const double apart = distance(position(tracks_.robots[a].pose), position(tracks_.robots[b].pose));
        ASSERT_GT(apart, TrackParameters{}.separation_m) << "two tracks at one place at " << now_s_ << " s";
      }
    }
  }
  void run(double time_s) {
    for (const double end_s = now_s_ + time_s; now_s_ < end_s && !::testing::Test::HasFatalFailure();) frame();
  }

  /// Returns the id of the track at a robot's position; kUnknownId if unknown, kHidden without a track.
  [[nodiscard]] RobotId tracked(std::size_t i) const { return track_at(i) == nullptr ? kHidden : track_at(i)->id; }
  [[nodiscard]] double confidence(std::size_t i) const {
    return track_at(i) == nullptr ? 0.0 : static_cast<double>(track_at(i)->confidence);
  }
  /// Return the number of robots whose track has their own id, and of those whose track has another one.
  [[nodiscard]] std::size_t right() const {
    return count([](RobotId id, std::size_t i) { return id == RobotId(i); });
  }
  [[nodiscard]] std::size_t wrong() const {
    return count([](RobotId id, std::size_t i) { return id >= 0 && id != RobotId(i); });
  }
  [[nodiscard]] std::size_t tracks() const { return tracks_.robots.size(); }

  static constexpr RobotId kHidden = -2;

 private:
  [[nodiscard]] const RobotTrack* track_at(std::size_t i) const {
    for (const RobotTrack& track : tracks_.robots) {
      if (distance(position(track.pose), robots_[i].place) < 0.03) return &track;
    }
    return nullptr;
  }
  template <class Condition>
  [[nodiscard]] std::size_t count(Condition condition) const {
    std::size_t n = 0;
    for (std::size_t i = 0; i < robots_.size(); ++i) n += condition(tracked(i), i) ? 1u : 0u;
    return n;
  }

  std::mt19937 random_;
  double period_s_, now_s_ = 1.0;
  float sighting_confidence_ = 0.99f;
  std::vector<Robot> robots_;
  std::vector<RobotId> shown_;
  Tracker tracker_;
  Tracks tracks_;
};

}  // namespace touchline
