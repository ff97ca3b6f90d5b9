#include "tools/programs/evaluate/recorded_game.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "hal/linux/monotonic_clock.h"

namespace touchline::evaluate {
namespace {

constexpr Duration kMillisecond = std::chrono::milliseconds(1);

}  // namespace

void RecordingClock::sleep_until(Instant instant) {
  for (;;) {
    const Instant next = arena_.begin() + static_cast<Duration::rep>(truth_.size()) * kMillisecond;
    if (next > instant) break;
    arena_.advance_to(next);
    truth_.push_back(arena_.world().snapshot());
  }
  arena_.advance_to(instant);
}

bool RecordingClock::covers(Instant instant, Duration margin) const {
  const Instant last = arena_.begin() + static_cast<Duration::rep>(truth_.size() - 1) * kMillisecond;
  return instant - margin >= arena_.begin() && instant + margin <= last;
}

hal::mock::Snapshot RecordingClock::at(Instant instant) const {
  const Duration since = instant - arena_.begin();
  const auto before = static_cast<std::size_t>(since / kMillisecond);
  const double part = seconds(since % kMillisecond) / seconds(kMillisecond);
  hal::mock::Snapshot out = truth_[before];
  if (part == 0.0) return out;
  const hal::mock::Snapshot& after = truth_[before + 1];
  for (std::size_t i = 0; i < out.robots.size(); ++i) {
    out.robots[i] = between(out.robots[i], after.robots[i], part);
  }
  out.ball = between(out.ball, after.ball, part);
  return out;
}

Result<void> RecordedGame::load_arena(const config::FilePaths& files, std::uint64_t seed) {
  TOUCHLINE_TRY(config::load(files, *configuration_));
  const config::BoardFile& board = configuration_->board;
  if (board.camera.backend != hal::CameraBackend::kMock || board.radio.backend != hal::RadioBackend::kMock) {
    return failure(ErrorCode::kInconsistent,
                   "%s: camera.backend and radio.backend must be \"mock\", because only the "
                   "arena knows the truth",
                   files.board.c_str());
  }
  TOUCHLINE_TRY_ASSIGN(opponents_, make_opponents(*configuration_, seed));
  arena_.emplace(board.arena, board.camera, board.radio, seed);
  arena_->game().set_side(hal::mock::Side::kOpponent, opponents_.side.get());
  clock_.emplace(*arena_);
  return {};
}

Result<void> RecordedGame::load_without_pictures(const config::FilePaths& files, std::uint64_t seed) {
  TOUCHLINE_TRY(load_arena(files, seed));
  side_ = std::make_unique<hal::mock::SimulatedSide>(configuration_->board.arena, hal::mock::Side::kOwn, seed);
  const Status status = side_->configure(side_settings(*configuration_, hal::mock::Side::kOwn));
  if (!status.ok()) {
    return failure(status.code(), "%s: its venue and team file cannot be used together", files.board.c_str());
  }
  side_->set_observer([](void* game, const StepTrace& trace) { static_cast<RecordedGame*>(game)->record(trace); },
                      this);
  arena_->game().set_side(hal::mock::Side::kOwn, side_.get());
  return {};
}

Result<void> RecordedGame::load(const config::FilePaths& files, std::uint64_t seed) {
  TOUCHLINE_TRY(load_arena(files, seed));
  loop_.emplace(*arena_, *clock_);
  return loop_->open(configuration_->board, configuration_->pipeline, nullptr, mailbox_.get(),
                     {&RecordedGame::observe, this});
}

void RecordedGame::hide_robots(double for_s, double duration_s) {
  const std::vector<hal::mock::ArenaRobot>& robots = configuration_->board.arena.robot;
  const double begin_s = seconds(arena_->now() - arena_->begin()), period_s = 2.0 * for_s + kSeen_s;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const double first_s = period_s * static_cast<double>(i) / static_cast<double>(robots.size());
    for (double at_s = first_s; at_s + for_s < duration_s; at_s += period_s) {
      arena_->inject({hal::mock::FaultKind::kHideRobot, begin_s + at_s, for_s, robots[i].team, robots[i].id});
    }
  }
}

Result<void> RecordedGame::play(double duration_s, bool record) {
  records_ = record;
  const Instant end = arena_->now() + from_seconds(duration_s);
  while (side_ && arena_->now() < end) {
    side_->set_hidden_robots(arena_->hidden_robots(arena_->now()));
    clock_->sleep_until(std::min(end, arena_->now() + kMillisecond));
  }
  while (arena_->now() < end) {
    if (commands_) {
      ExternalCommands stamped = *commands_;
      // A time in the future is treated as the time at which the loop takes the command.
      for (ExternalCommand& command : stamped) command.received = hal::MonotonicClock::read() + std::chrono::hours(1);
      mailbox_->put(stamped);
    }
    TOUCHLINE_TRY(loop_->iterate());
  }
  return {};
}

void RecordedGame::observe(void* context, const StepTrace& trace, const StepTiming&) {
  static_cast<RecordedGame*>(context)->record(trace);
}

void RecordedGame::record(const StepTrace& trace) {
  if (!records_) return;
  GameFrame frame;
  frame.capture_time = trace.frame.capture_time;
  frame.sightings = trace.sightings.robots;
  frame.ball = trace.sightings.ball;
  frame.tracks = trace.tracks;
  frames_.push_back(frame);
}

}  // namespace touchline::evaluate
