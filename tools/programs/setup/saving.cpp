#include "tools/programs/setup/saving.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>

#include "firmware/config/file_backup.h"
#include "hal/files/output_file.h"
#include "tools/programs/setup/saving_journal.h"

namespace touchline::setup {
namespace {

namespace fs = std::filesystem;

// Returns the files in the order of replacing: a file comes after the files that it names, so pictures come first.
std::vector<std::string> in_order(const SetupFiles& draft, std::vector<std::string> names) {
  const auto rank = [&](const std::string& name) {
    return name == draft.board ? 3 : name == draft.venue ? 2 : name == draft.team ? 1 : 0;
  };
  std::stable_sort(names.begin(), names.end(),
                   [&](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
  return names;
}

// Writes new contents under temporary names. The destructor removes the temporary files that were not renamed, unless a
// journal names them.
class PreparedFiles {
 public:
  PreparedFiles() = default;
  ~PreparedFiles() {
    std::error_code ignored;
    for (const PendingRename& rename : renames_) fs::remove(rename.temporary, ignored);
  }
  PreparedFiles(const PreparedFiles&) = delete;
  PreparedFiles& operator=(const PreparedFiles&) = delete;

  Result<void> add(const std::string& path, std::string_view content) {
    hal::OutputFile file;
    TOUCHLINE_TRY(file.open(path));
    TOUCHLINE_TRY(file.write(content));
    TOUCHLINE_TRY_ASSIGN(const hal::PreparedFile prepared, file.prepare());
    renames_.push_back({fs::absolute(prepared.path).string(), fs::absolute(prepared.temporary).string(), {}});
    renames_.back().former = state_of(renames_.back().path);
    return {};
  }
  void remove(const std::string& path) { renames_.push_back({path, "", state_of(path)}); }
  /// Syncs the temporary files, so that a power failure does not lose them.
  Result<void> sync() const {
    std::set<fs::path> folders;
    for (const PendingRename& rename : renames_) folders.insert(fs::path(rename.path).parent_path());
    for (const fs::path& folder : folders) TOUCHLINE_TRY(hal::sync_folder(folder.string()));
    return {};
  }
  [[nodiscard]] const std::vector<PendingRename>& renames() const { return renames_; }
  /// Keeps the temporary files, because the next start finishes the journal.
  void keep() { renames_.clear(); }

 private:
  std::vector<PendingRename> renames_;
};

using Contents = std::vector<std::optional<std::string>>;

// Undoes the renames that are already done, by saving the former contents. `former` holds these contents in the same
// order.
Result<void> undo(const std::vector<PendingRename>& done, const Contents& former, const std::string& journal) {
  PreparedFiles files;
  for (std::size_t i = done.size(); i-- > 0;) {
    std::error_code ignored;
    if (fs::exists(done[i].temporary, ignored)) continue;
    if (former[i]) {
      TOUCHLINE_TRY(files.add(done[i].path, *former[i]));
    } else {
      files.remove(done[i].path);
    }
  }
  TOUCHLINE_TRY(files.sync());
  TOUCHLINE_TRY(write_journal(journal, files.renames()));
  const Result<std::vector<std::string>> completed = complete(files.renames());
  if (completed.ok()) return {};
  files.keep();
  return completed.error();
}

}  // namespace

Result<void> save_files(const SetupFiles& draft, const std::vector<std::string>& names, const std::string& folder,
                        const std::string& journal) {
  PreparedFiles files;
  Contents former;
  for (const std::string& name : in_order(draft, names)) {
    const auto file = draft.content.find(name);
    if (file == draft.content.end()) continue;
    const std::string path = (fs::path(folder) / name).string();
    TOUCHLINE_TRY(files.add(path, *file->second));
    TOUCHLINE_TRY_ASSIGN(former.emplace_back(), config::read_data(path));
    TOUCHLINE_TRY(config::back_up(path));
  }
  TOUCHLINE_TRY(files.sync());
  TOUCHLINE_TRY(write_journal(journal, files.renames()));
  // Now everything is on the disk, and only renames remain.
  Result<std::vector<std::string>> completed = complete(files.renames());
  Result<void> saved;
  if (!completed.ok()) {
    saved = std::move(completed).error();
  } else if (!completed.value().empty()) {
    saved = failure(ErrorCode::kInconsistent, "%s: somebody has changed it meanwhile: save again",
                    completed.value()[0].c_str());
  }
  if (!saved.ok()) {
    if (const Result<void> undone = undo(files.renames(), former, journal); !undone.ok()) {
      files.keep();
      return Error{saved.code(), saved.text() + "; and the files before it cannot be restored (" + undone.text() +
                                     "): the next start of touchline-setup makes the files fit each other again"};
    }
  }
  std::error_code error;
  fs::remove(journal, error);
  return saved;
}

Result<std::vector<std::string>> finish_saving(const std::string& journal) {
  const Result<std::vector<PendingRename>> renames = read_journal(journal);
  if (renames.code() == ErrorCode::kNotFound) return std::vector<std::string>();
  std::error_code error;
  if (renames.code() == ErrorCode::kInconsistent) fs::remove(journal, error);
  if (!renames.ok()) return renames.error();
  TOUCHLINE_TRY_ASSIGN(std::vector<std::string> left, complete(renames.value()));
  // Temporary files of the files that were left unchanged.
  for (const PendingRename& rename : renames.value()) fs::remove(rename.temporary, error);
  fs::remove(journal, error);
  return left;
}

}  // namespace touchline::setup
