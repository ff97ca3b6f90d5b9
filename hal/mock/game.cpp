#include "hal/mock/game.h"

#include "hal/mock/simulated_side.h"

namespace touchline::hal::mock {

Game::Game(const ArenaParameters& parameters, int baud, std::uint64_t seed, Instant begin, Duration pause)
    : world_(parameters, seed),
      rules_(parameters, world_, seed),
      channels_{RadioChannel(parameters, baud, seed, pause, Side::kOwn),
                RadioChannel(parameters, baud, seed, {}, Side::kOpponent)},
      begin_(begin),
      now_(begin),
      last_jump_(begin) {}

void Game::restart(std::uint64_t seed) {
  world_.restart(seed);
  rules_.restart(seed);
  note_jump();
}

void Game::step() {
  now_ += kStep;
  world_.step();
  const std::uint32_t restarts = rules_.restarts();
  rules_.update();
  const bool returned = (rules_.is_stopped() && rules_.restarts() != restarts) || jumped_;
  jumped_ = false;
  if (returned) last_jump_ = now_;
  for (const Side side : {Side::kOwn, Side::kOpponent}) {
    const auto index = static_cast<std::size_t>(side);
    channels_[index].deliver(now_, world_);
    if (sides_[index] == nullptr) continue;
    sides_[index]->hold(rules_.is_stopped(), returned);
    sides_[index]->set_referee(rules_.situation(side), rules_.sides_exchanged());
    sides_[index]->advance(now_, world_, channels_[index]);
  }
}

}  // namespace touchline::hal::mock
