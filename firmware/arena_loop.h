#pragma once

#include <memory>
#include <string>

#include "firmware/arena_sides.h"
#include "firmware/config/configuration.h"
#include "firmware/loop.h"
#include "hal/mock/arena.h"
#include "hal/mock/mock_devices.h"

namespace touchline {

/// What a loop learns from an arena beside pictures and telemetry. Each call locks the arena, which must outlive the
/// sources.
ScoreSource score_of(hal::mock::Arena& arena);
JumpSource jumps_of(hal::mock::Arena& arena);
RefereeSource referee_of(hal::mock::Arena& arena);
/// Returns the result of the arena's game, several lines.
std::string summary_of(const hal::mock::Arena& arena);

/// The own side of a game with pictures: the firmware's loop with the camera, the radio and the GPIO of an arena, whose
/// time passes as fast as the processor allows. Large: do not put it on the stack.
class ArenaLoop {
 public:
  /// `clock`: the arena's. Both must outlive this object.
  ArenaLoop(hal::mock::Arena& arena, hal::Clock& clock);

  /// Creates and opens the loop. `pipeline`: parameters of the side; `strategy`: plays instead of the built-in play and
  /// must outlive this object, null: the built-in play; `commands`: of other programs, null: there are none. Errors of
  /// Pipeline::configure() and Loop::open().
  Result<void> open(const config::BoardFile& board, const PipelineParameters& pipeline, Strategy* strategy,
                    Mailbox<ExternalCommands>* commands, LoopObserver observer);
  /// Iterates until `end`. An error if the loop ends before.
  Result<void> run_until(Instant end);
  /// Lets the loop wait for a frame or its next due action, and do it. An error if the loop ends.
  Result<void> iterate();

 private:
  hal::mock::Arena& arena_;
  hal::Clock& clock_;
  hal::mock::MockCamera camera_;
  hal::mock::MockRadio radio_;
  hal::mock::MockGpio gpio_;
  std::unique_ptr<Pipeline> pipeline_ = std::make_unique<Pipeline>();
  std::unique_ptr<ReportRing> reports_ = std::make_unique<ReportRing>();  // nobody reads it
  std::unique_ptr<Loop> loop_;  // last, because it must be destroyed before the devices
};

}  // namespace touchline
