#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/result.h"

namespace touchline::setup {

/// Identifies the content of a file without reading it: whoever writes a file changes its time stamp.
struct FileState {
  std::int64_t modified_ns = 0, bytes = 0;
  bool operator==(const FileState&) const = default;
};

/// The file's state; empty: there is none.
std::optional<FileState> state_of(const std::string& path);

/// One file that a save replaces. While `temporary` exists, the rename is due; afterwards the file is none of the
/// save's business.
struct PendingRename {
  std::string path, temporary;      // absolute; "" as temporary: the file is removed instead
  std::optional<FileState> former;  // of the file that is replaced; empty: there was none
};

/// The renames of a save, in their order, as a file. It has names only, so it is small whatever the files contain.
/// kInconsistent: a path is not UTF-8. Errors of hal::write_file().
Result<void> write_journal(const std::string& journal, const std::vector<PendingRename>& renames);
/// Errors of hal::read_file(). kInconsistent: damaged, or of another version.
Result<std::vector<PendingRename>> read_journal(const std::string& journal);

/// Does the renames that are due, and syncs the folders. Returns the files that are not as `former` says: they are left
/// as they are, and so are their temporary files. Errors: those of rename(); the rest stays due.
Result<std::vector<std::string>> complete(const std::vector<PendingRename>& renames);

}  // namespace touchline::setup
