#include "tools/programs/simulate/team_game.h"

#include "firmware/arena_loop.h"
#include "hal/mock/arena.h"

namespace touchline::simulate {

using hal::mock::ArenaParameters;
using hal::mock::Game;
using hal::mock::Side;

struct TeamGame::Pictures {
  Pictures(const ArenaParameters& parameters, const config::BoardFile& board, std::uint64_t seed)
      : arena(parameters, board.camera, board.radio, seed), clock(arena), loop(arena, clock) {}

  hal::mock::Arena arena;
  hal::mock::ArenaClock clock;
  ArenaLoop loop;
};

TeamGame::TeamGame() = default;
TeamGame::~TeamGame() = default;

Result<std::unique_ptr<TeamGame>> TeamGame::begin(const ArenaParameters& arena, const Team& own, const Team& opponent,
                                                  std::uint64_t seed, OwnView view) {
  std::unique_ptr<TeamGame> made(new TeamGame());
  const config::Configuration& configuration = *own.configuration;
  Player& own_player = made->players_[0];
  if (view == OwnView::kPictures) {
    TOUCHLINE_TRY_ASSIGN(own_player.strategy, make_strategy(own, seed));
    TOUCHLINE_TRY(made->begin_with_pictures(arena, own, seed));
  } else {
    TOUCHLINE_TRY_ASSIGN(own_player, make_player(own, arena, Side::kOwn, seed));
    made->owned_game_ = std::make_unique<Game>(arena, configuration.board.radio, seed);
    made->game_ = made->owned_game_.get();
    made->game_->set_side(Side::kOwn, own_player.side.get());
  }
  TOUCHLINE_TRY_ASSIGN(made->players_[1], make_player(opponent, arena, Side::kOpponent, seed));
  made->game_->set_side(Side::kOpponent, made->players_[1].side.get());
  made->game_->channel(Side::kOwn).set_layouts(configuration.pipeline.radio, configuration.pipeline.telemetry);
  return made;
}

Result<void> TeamGame::begin_with_pictures(const ArenaParameters& arena, const Team& own, std::uint64_t seed) {
  const config::Configuration& configuration = *own.configuration;
  const config::BoardFile& board = configuration.board;
  if (board.camera.backend != hal::CameraBackend::kMock || board.radio.backend != hal::RadioBackend::kMock) {
    return Error{ErrorCode::kInconsistent,
                 "games with pictures need camera.backend = \"mock\" and radio.backend = \"mock\""};
  }
  pictures_ = std::make_unique<Pictures>(arena, board, seed);
  game_ = &pictures_->arena.game();
  PipelineParameters pipeline = configuration.pipeline;
  pipeline.control = control_of(own);
  return pictures_->loop.open(board, pipeline, players_[0].strategy.get(), nullptr, {});
}

Result<void> TeamGame::advance_to(double time_s) {
  const Instant end = game_->begin() + from_seconds(time_s);
  if (pictures_) return pictures_->loop.run_until(end);
  game_->advance_to(end);
  return {};
}

}  // namespace touchline::simulate
