#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/result.h"

namespace touchline::setup {

/// Identifies the content of a file without reading it; every writer changes the time stamp.
struct FileState {
  std::int64_t modified_ns = 0, bytes = 0;
  bool operator==(const FileState&) const = default;
};

/// Returns the file's state; empty if it does not exist.
std::optional<FileState> state_of(const std::string& path);

/// One file that a save replaces. While `temporary` exists, the rename is due; afterwards the file is no longer part of
/// the save.
struct PendingRename {
  std::string path, temporary;      // absolute; if `temporary` is "", the file is removed instead
  std::optional<FileState> former;  // state of the file to be replaced; empty: there was none
};

/// Writes the renames of a save, in their order, to a file. It contains only names, so it is small whatever the size of
/// the saved files. kInconsistent: a path is not UTF-8. Errors of hal::write_file().
Result<void> write_journal(const std::string& journal, const std::vector<PendingRename>& renames);
/// Errors of hal::read_file(). kInconsistent: the journal is damaged or has another version.
Result<std::vector<PendingRename>> read_journal(const std::string& journal);

/// Carries out the renames that are due, and syncs the folders. Returns the files whose state differs from `former`:
/// they and their temporary files stay as they are. Errors of rename(); the remaining renames stay due.
Result<std::vector<std::string>> complete(const std::vector<PendingRename>& renames);

}  // namespace touchline::setup
