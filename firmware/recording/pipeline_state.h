#pragma once

#include <cstddef>
#include <span>

#include "core/pipeline.h"
#include "firmware/recording/field_archive.h"
#include "hal/result.h"

namespace touchline::recording {

// 22 tracks, and commands of 11 robots for a second at 240 Hz, have 56 KB; they are written in 14 us. A game of five
// robots a side has 14 KB (4 us).
inline constexpr std::size_t kMaxStateBytes = std::size_t{64} << 10;
using StateBytes = FixedBytes<kMaxStateBytes>;

/// Writes what tracks, commands and packets of the next steps depend on (Pipeline::visit_state()). Allocates nothing.
void write_state(const Pipeline& pipeline, StateBytes& out);

/// Gives this state to a pipeline with the same configuration. kCorruptFrame: the bytes are no such state; then the
/// pipeline cannot be used any more.
Result<void> read_state(std::span<const std::byte> bytes, Pipeline& pipeline);

}  // namespace touchline::recording
