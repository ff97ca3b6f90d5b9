#include "hal/mock/strategies/follow.h"

#include <algorithm>

#include "hal/mock/strategies/drive_law.h"

namespace touchline::hal::mock {
namespace {

constexpr DriveLaw kFollowLaw{0.35, 4.0, 4.0, 0.1};

}  // namespace

void Follow::begin(const Scene& scene) {
  wanderers_.keep(scene.players);
  nearest_ = kUnknownId;
  double least = 0.0;
  for (const Player& player : scene.players) {
    if (!scene.ball_known || player.id == roles().goalkeeper()) continue;
    const double way = distance(position(player.pose), scene.ball);
    if (nearest_ != kUnknownId && way >= least) continue;
    nearest_ = player.id;
    least = way;
  }
}

Twist Follow::move(const Player& player, const Scene& scene) {
  Wanderer& wanderer = wanderers_.of(player.id);
  wanderer.decide_in_s -= scene.frame_s;
  if (wanderer.decide_in_s <= 0.0) {
    wanderer.decide_in_s = random_.uniform(1.0, 3.0);
    const double x = random_.uniform(-0.4, 0.1), y = random_.uniform(-0.4, 0.4);
    wanderer.place = {x * static_cast<double>(field().length_m), y * static_cast<double>(field().width_m)};
  }
  return drive_to(player.pose, player.id == nearest_ ? scene.ball : wanderer.place, kFollowLaw);
}

Twist Follow::keep(const Player& player, const Scene& scene) {
  const double y = scene.ball_known ? std::clamp(scene.ball.y, -half_goal_m(), half_goal_m()) : 0.0;
  return drive_to(player.pose, {-half_length_m() + 2.0 * radius_m(), y}, kFollowLaw);
}

}  // namespace touchline::hal::mock
