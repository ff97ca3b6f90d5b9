#include "hal/mock/strategies/pusher.h"

#include "hal/mock/strategies/ball_push.h"

namespace touchline::hal::mock {

Twist Pusher::move(const Player& player, const Scene& scene) {
  if (!scene.ball_known) return {};
  return push_ball(player.pose, scene.ball, field(), radius_m(), fast_law());
}

}  // namespace touchline::hal::mock
