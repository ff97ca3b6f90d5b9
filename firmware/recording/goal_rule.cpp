#include "firmware/recording/goal_rule.h"

#include <cmath>

namespace touchline::recording {
namespace {

// A wrong sighting lasts one frame, seldom two. A ball of 5 m/s needs as many frames at 60 Hz to cross the goals of the
// preset fields (0.15 m and deeper), and then lies in them.
constexpr int kFrames = 3;

}  // namespace

GoalRule::GoalRule(const FieldParameters& field, float ball_radius_m)
    : line_m_(field.length_m / 2), mouth_m_(field.goal_width_m / 2), radius_m_(ball_radius_m) {}

std::optional<Team> GoalRule::add(const BallTrack& ball, bool own_on_positive_half) {
  // A predicted ball may have bounced off a post.
  if (ball.state != TrackState::kSeen) return std::nullopt;
  const auto [x, y] = ball.position;
  if (std::abs(x) < line_m_ - radius_m_) is_counted_ = false;
  const bool is_in = std::abs(x) > line_m_ + radius_m_ && std::abs(y) < mouth_m_;
  frames_ = is_in ? frames_ + 1 : 0;
  if (frames_ < kFrames || is_counted_) return std::nullopt;
  is_counted_ = true;
  return (x > 0) == own_on_positive_half ? Team::kOpponent : Team::kOwn;
}

}  // namespace touchline::recording
