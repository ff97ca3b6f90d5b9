#include "hal/mock/game.h"

#include "hal/mock/simulated_side.h"

namespace touchline::hal::mock {

Game::Game(const ArenaParameters& parameters, const RadioSettings& radio, std::uint64_t seed, Instant begin)
    : world_(parameters, seed),
      rules_(parameters, world_, seed),
      channels_{RadioChannel(parameters, radio.baud, seed, from_seconds(radio.pause_s), Side::kOwn),
                RadioChannel(parameters, radio.baud, seed, from_seconds(radio.pause_s), Side::kOpponent)},
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
  const std::uint32_t placements = rules_.placements();
  rules_.update();
  const bool returned = rules_.placements() != placements || jumped_;
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
