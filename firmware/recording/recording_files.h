#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/result.h"

// Files in a folder of recordings. Their names begin with a number that counts up, which is right on boards without a
// clock: touchline-0042.mcap, with the date if the computer's clock is synchronized:
// touchline-0042-20261128-173005.mcap (UTC). A file with any other name, such as a renamed one, is not ours.
namespace touchline::recording {

struct RecordingFile {
  std::string name;  // without the folder
  std::uint64_t number = 0, bytes = 0;
};

/// Returns the recordings in the folder, oldest first; all other files are left out. Empty if it cannot be read.
std::vector<RecordingFile> recordings_in(const std::string& folder);
/// Returns the name of the next recording.
std::string next_name(const std::vector<RecordingFile>& recordings);
struct QuotaRemovals {
  std::vector<std::string> deleted;  // names
  std::string failure;               // the first file that could not be deleted, and why; empty: none
};

/// Deletes the oldest recordings until all together have at most `quota_bytes`, but neither `current` nor one that
/// another program is writing (McapWriter locks it).
QuotaRemovals keep_quota(const std::string& folder, const std::string& current, std::uint64_t quota_bytes);

}  // namespace touchline::recording
