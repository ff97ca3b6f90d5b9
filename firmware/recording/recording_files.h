#pragma once

#include <cstdint>
#include <string>
#include <string_view>
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
/// Returns whether a file with this name may be shown: a name of ours or another one of a recording (renamed ones are
/// kept), which does not lead out of its folder.
bool is_recording_name(std::string_view name);
/// Returns the names of all recordings in the folder, ours first, newest first.
std::vector<std::string> names_in(const std::string& folder);
/// Returns the date in a name, "2026-11-28 17:30:05" (UTC); "": it has none.
std::string date_of(std::string_view name);
/// Returns whether a program is writing the file.
bool is_being_written(const std::string& path);

struct QuotaRemovals {
  std::vector<std::string> deleted;  // names
  std::string failure;               // the first file that could not be deleted, and why; empty: none
};

/// Deletes the oldest recordings until all together have at most `quota_bytes`, but neither `current` nor one that
/// another program is writing (McapWriter locks it).
QuotaRemovals keep_quota(const std::string& folder, const std::string& current, std::uint64_t quota_bytes);

}  // namespace touchline::recording
