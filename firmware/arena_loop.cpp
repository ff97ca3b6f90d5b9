#include "firmware/arena_loop.h"

#include <array>
#include <cinttypes>
#include <cstdio>
#include <mutex>

namespace touchline {
namespace {

// Reads the game of an arena, which the console's thread may change at the same time (ArenaObjects).
template <class Read>
auto read_game(void* context, const Read& read) {
  auto& arena = *static_cast<hal::mock::Arena*>(context);
  const std::scoped_lock lock(arena.mutex());
  return read(arena.game());
}

}  // namespace

ScoreSource score_of(hal::mock::Arena& arena) {
  return {[](void* context) {
            return read_game(context, [](hal::mock::Game& game) {
              return Score{game.statistics().goals_own, game.statistics().goals_opponent};
            });
          },
          &arena};
}

JumpSource jumps_of(hal::mock::Arena& arena) {
  return {[](void* context) { return read_game(context, [](hal::mock::Game& game) { return game.last_jump(); }); },
          &arena};
}

RefereeSource referee_of(hal::mock::Arena& arena) {
  return {
      [](void* context) { return read_game(context, [](hal::mock::Game& game) { return game.rules().referee(); }); },
      &arena};
}

std::string summary_of(const hal::mock::Arena& arena) {
  const hal::mock::GameStatistics& game = arena.game().statistics();
  const hal::mock::ChannelStatistics& air = arena.channel().statistics();
  std::array<char, 512> text{};
  std::snprintf(text.data(), text.size(),
                "arena: ball touched %" PRIu64 " times and moved %.1f m, goals %" PRIu32 " : %" PRIu32
                ", free balls %" PRIu32
                "\n"
                "robots' radio: %" PRIu64 " packets obeyed, %" PRIu64 " lost, %" PRIu64 " damaged, %" PRIu64
                " out of order, %" PRIu64
                " time-outs\n"
                "arena state: %016" PRIx64 "\n",
                game.touches[0], game.ball_path_m, game.goals_own, game.goals_opponent, game.free_balls, air.obeyed,
                air.lost, air.corrupted, air.ignored, air.timeouts, arena.game().hash());
  return text.data();
}

ArenaLoop::ArenaLoop(hal::mock::Arena& arena, hal::Clock& clock)
    : arena_(arena), clock_(clock), camera_(arena, clock), radio_(arena, clock), gpio_(arena, clock) {}

Result<void> ArenaLoop::open(const config::BoardFile& board, const PipelineParameters& pipeline, Strategy* strategy,
                             Mailbox<ExternalCommands>* commands, LoopObserver observer) {
  pipeline_->set_strategy(strategy);
  if (const Status status = pipeline_->configure(pipeline); !status.ok()) {
    return failure(status.code(), "the pipeline refuses the settings of the venue and team file");
  }
  LoopSettings settings;
  settings.faults = board.faults;
  settings.radio_delay = from_seconds(board.radio.delay_s);
  settings.radio_line = hal::line_time(board.radio);
  settings.external.commands = commands;
  settings.external.simulated_referee = referee_of(arena_);
  settings.score = score_of(arena_);
  settings.jumps = jumps_of(arena_);
  loop_ = std::make_unique<Loop>(HalDevices{camera_, radio_, gpio_, clock_, true}, *pipeline_, settings, *reports_,
                                 observer);
  return loop_->open();
}

Result<void> ArenaLoop::iterate() {
  if (!loop_->iterate()) return {};
  return failure(loop_->last_fault().code, "the game ended early: %s", loop_->last_fault().reason.c_str());
}

Result<void> ArenaLoop::run_until(Instant end) {
  while (arena_.now() < end) TOUCHLINE_TRY(iterate());
  return {};
}

}  // namespace touchline
