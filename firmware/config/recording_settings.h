#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "core/parameter.h"

namespace touchline::config {

/// When a run is recorded without a person's request.
enum class AutomaticRecording : std::uint8_t { kOff, kOn, kHalves };
inline constexpr std::array<Choice<AutomaticRecording>, 3> kAutomaticRecordingWords{
    {{"off", AutomaticRecording::kOff}, {"on", AutomaticRecording::kOn}, {"halves", AutomaticRecording::kHalves}}};

/// [recording] of the board file: recordings of whole games (docs/recordings.md).
struct RecordingSettings {
  std::string folder;
  AutomaticRecording automatic = AutomaticRecording::kOn;
  int every = 1;
  int memory_mb = 64;
  int reserve_mb = 500;
  int quota_mb = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text(self.folder, {.name = "folder",
                             .help = "Folder of the recordings, relative to this file; empty: nothing is recorded. "
                                     "--record overrides it"});
    visit.choice(self.automatic, kAutomaticRecordingWords,
                 {.name = "automatic",
                  .help = "on: the whole run; halves: a file for each half that the referee announces; off: only what "
                          "the page's button or --record begins"});
    visit.number(self.every, {.name = "every",
                              .range = {0, 1000},
                              .help = "Every n-th picture is recorded; 0: none. Inputs and results of all frames are "
                                      "recorded"});
    visit.number(self.memory_mb, {.name = "memory_mb",
                                  .range = {8, 4096},
                                  .unit = "MB",
                                  .help = "Memory in which pictures wait for the disk; pictures that do not fit are "
                                          "left out and counted"});
    visit.number(self.reserve_mb, {.name = "reserve_mb",
                                   .range = {0, 1e6},
                                   .unit = "MB",
                                   .help = "The recording ends when the disk has less free space"});
    visit.number(self.quota_mb,
                 {.name = "quota_mb",
                  .range = {0, 1e8},
                  .unit = "MB",
                  .help = "Size of all recordings in the folder; the oldest ones are deleted to keep it. "
                          "0: no limit"});
  }
};

}  // namespace touchline::config
