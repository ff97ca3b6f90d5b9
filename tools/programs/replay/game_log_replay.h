#pragma once

#include <atomic>
#include <memory>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "hal/result.h"
#include "tools/programs/replay/replay.h"

namespace touchline::replay {

/// Runs the pipeline on the poses of a game log's packets: those of SSL-Vision, or, if there are none, of the first
/// tracker. Times are seconds from the log's first message. Errors name the file and the byte.
Result<ReplaySummary> replay_game_log(const ReplayOptions& options, const Progress& progress,
                                      const std::atomic<bool>& stop);

/// Returns a pipeline with these parameters. Error: the files do not fit together.
Result<std::unique_ptr<Pipeline>> make_pipeline(const ReplayOptions& options,
                                                const config::Configuration& configuration);
/// The error of a replay that a person has stopped.
Error stopped_replay();

}  // namespace touchline::replay
