#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/types.h"
#include "firmware/report/trace_json.h"
#include "firmware/snapshot.h"
#include "hal/result.h"

namespace touchline::latency {

/// Keeps the pictures and results of the frames with the longest latencies while the loop runs, and writes them
/// afterwards: a picture for each frame, and `trace.jsonl` with a line for each picture, as touchline-replay writes
/// them.
class WorstFrameRecorder {
 public:
  /// Keeps `count` frames. An empty `folder` keeps none.
  WorstFrameRecorder(std::string folder, std::size_t count);
  [[nodiscard]] bool is_on() const { return !slots_.empty(); }
  /// kInconsistent: the folder contains files, which a replay would mix with the new ones; kPermission: the folder, or
  /// the folder in which it will be created, cannot be written.
  [[nodiscard]] Result<void> check() const;

  /// Allocates memory for frames like this one. Call it before add().
  void prepare(const Frame& frame);
  /// Copies the frame if it is one of the slowest so far; copying takes as long as reading a picture. Never allocates.
  /// Frames larger than the prepared one are not kept. `number` counts from 1.
  void add(const StepTrace& trace, std::uint64_t number, Duration latency);

  /// Writes the files; creates the folder. kIo, kPermission: the message names the file.
  [[nodiscard]] Result<void> write(const report::TraceNames& names) const;

 private:
  struct Slot {
    std::uint64_t number = 0;  // number of the frame; 0: the entry is empty
    Duration latency{};
    Frame frame;
    std::vector<std::uint8_t> pixels;
    Snapshot results;
  };
  static void copy_pixels(const Frame& frame, Slot& slot);

  std::string folder_;
  std::vector<Slot> slots_;
};

}  // namespace touchline::latency
