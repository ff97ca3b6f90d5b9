#include "tools/programs/control/tracking_drill.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/angle.h"
#include "tools/programs/control/tracking_bound.h"
#include "tools/programs/control/trajectory_tracking.h"

namespace touchline::control_evaluation {
namespace {

// The lemniscate (a sin p, b sin 2p), driven at constant speed: the parameter is a table over the way.
class Eight {
 public:
  explicit Eight(double speed_mps) : speed_mps_(speed_mps) {
    double way = 0.0;
    for (std::size_t i = 0; i <= kPoints; ++i) {
      way_.push_back(way);
      way += norm(at(static_cast<double>(i + 1) * kStep) - at(static_cast<double>(i) * kStep));
    }
  }
  [[nodiscard]] double speed() const { return speed_mps_; }
  [[nodiscard]] double round_s() const { return way_.back() / speed_mps_; }
  [[nodiscard]] Vector2 place(double time_s) const { return at(parameter(time_s)); }
  [[nodiscard]] double heading(double time_s) const { return bearing(derivative(parameter(time_s))); }
  [[nodiscard]] double turn_rate(double time_s) const {
    const double p = parameter(time_s);
    const Vector2 d = derivative(p), dd{-kHalfLength * std::sin(p), -4.0 * kHalfWidth * std::sin(2.0 * p)};
    return speed_mps_ * cross(d, dd) / std::pow(norm(d), 3.0);
  }

 private:
  static constexpr std::size_t kPoints = 4000;
  static constexpr double kStep = 2.0 * 3.14159265358979 / static_cast<double>(kPoints);
  static constexpr double kHalfLength = 0.9, kHalfWidth = 0.28;

  static Vector2 at(double p) { return {kHalfLength * std::sin(p), kHalfWidth * std::sin(2.0 * p)}; }
  static Vector2 derivative(double p) { return {kHalfLength * std::cos(p), 2.0 * kHalfWidth * std::cos(2.0 * p)}; }
  [[nodiscard]] double parameter(double time_s) const {
    const double way = std::fmod(std::max(0.0, time_s) * speed_mps_, way_.back());
    const auto next = std::upper_bound(way_.begin(), way_.end(), way);
    const auto i = static_cast<std::size_t>(next - way_.begin()) - 1;
    return kStep * (static_cast<double>(i) + (way - way_[i]) / (way_[i + 1] - way_[i]));
  }

  double speed_mps_;
  std::vector<double> way_;
};

class Follower final : public Strategy {
 public:
  virtual ~Follower() = default;
  explicit Follower(double speed_mps) : eight(speed_mps) {}
  void configure(const ControlParameters& parameters, const FieldParameters&) override { drive_ = parameters.drive; }
  void reset() override {}
  void decide(const Tracks& tracks, const Players& players, Twists& wanted) override {
    const double period = last_ > Instant{} ? seconds(tracks.capture_time - last_) : 1.0 / 60.0;
    last_ = tracks.capture_time;
    const double now = seconds(tracks.action_time - begin);
    const auto point = [&](double t) {
      return TrajectoryPoint{eight.place(t), eight.heading(t), eight.speed(), eight.turn_rate(t + period)};
    };
    for (std::size_t i = 0; i < players.size(); ++i) {
      const Player& player = players[i];
      wanted[i] = track_point(motion_state(player.pose, player.twist, player.wheels), point(now), period, drive_);
    }
  }
  [[nodiscard]] PlayRole role_of(RobotId) const override { return PlayRole::kNone; }

  Eight eight;
  Instant begin{};  // time at which the trajectory begins

 private:
  DriveParameters drive_;
  Instant last_{};
};

}  // namespace

Result<TrackingResult> tracking_drill(const config::Configuration& configuration, const TrackingSettings& settings,
                                      std::uint64_t seed) {
  Follower follower(settings.speed_mps);
  DrillSettings of_drill;
  of_drill.seed = seed;
  of_drill.rate_hz = settings.rate_hz;
  of_drill.true_delay_s = settings.true_delay_s;
  of_drill.believed_delay_s = settings.believed_delay_s;
  of_drill.strategy = &follower;
  TOUCHLINE_TRY_ASSIGN(const std::unique_ptr<Drill> drill, Drill::make(configuration, of_drill));
  follower.begin = drill->begin();
  drill->world().place_ball({0.0, 3.0});
  drill->world().place(0, {0.0, 0.0, follower.eight.heading(0.0)});
  TrackingResult result;
  int count = 0;
  const double begin = settings.settle_s + follower.eight.round_s();
  while (drill->time_s() < begin + 20.0) {
    drill->step();
    if (drill->time_s() < begin) continue;
    const hal::mock::Placement robot = drill->world().snapshot().robots[0];
    const double off = distance({robot.x_m, robot.y_m}, follower.eight.place(drill->time_s()));
    result.rms_mm += off * off;
    result.max_mm = std::max(result.max_mm, 1e3 * off);
    ++count;
  }
  // A packet has an effect when it acts, and the next one a period later.
  result.bound_mm = 1e3 * tracking_bound_m(settings.speed_mps, drill->mean_reaction_s() + 0.5 / settings.rate_hz,
                                           configuration.board.arena.physics);
  result.rms_mm = 1e3 * std::sqrt(result.rms_mm / count);
  return result;
}

}  // namespace touchline::control_evaluation
