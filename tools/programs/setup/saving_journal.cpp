#include "tools/programs/setup/saving_journal.h"

#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "hal/files/input_file.h"
#include "hal/files/output_file.h"
#include "hal/linux/system_error.h"

namespace touchline::setup {
namespace {

namespace fs = std::filesystem;

constexpr const char* kJournalFormat = "touchline-setup-saving";
constexpr int kJournalVersion = 1;

std::vector<PendingRename> renames_of(const nlohmann::json& in) {
  std::vector<PendingRename> renames;
  for (const nlohmann::json& one : in.at("renames")) {
    PendingRename rename{one.at("path"), one.at("temporary"), {}};
    if (const nlohmann::json& former = one.at("former"); !former.is_null()) {
      rename.former = {former.at("modified_ns").get<std::int64_t>(), former.at("bytes").get<std::int64_t>()};
    }
    renames.push_back(std::move(rename));
  }
  return renames;
}

Result<void> do_rename(const PendingRename& rename) {
  const bool is_removal = rename.temporary.empty();
  const int result =
      is_removal ? std::remove(rename.path.c_str()) : std::rename(rename.temporary.c_str(), rename.path.c_str());
  if (result == 0) return {};
  return failure(errno == EACCES || errno == EPERM || errno == EROFS ? ErrorCode::kPermission : ErrorCode::kIo,
                 "%s: cannot be %s: %s", rename.path.c_str(), is_removal ? "removed" : "replaced",
                 hal::system_text(errno));
}

}  // namespace

std::optional<FileState> state_of(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return {};
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  return FileState{std::int64_t{status.st_mtim.tv_sec} * kSecond_ns + status.st_mtim.tv_nsec,
                   std::int64_t{status.st_size}};
}

Result<void> write_journal(const std::string& journal, const std::vector<PendingRename>& renames) {
  nlohmann::json list = nlohmann::json::array();
  for (const PendingRename& rename : renames) {
    nlohmann::json former;
    if (rename.former) former = {{"modified_ns", rename.former->modified_ns}, {"bytes", rename.former->bytes}};
    list.push_back({{"path", rename.path}, {"temporary", rename.temporary}, {"former", former}});
  }
  const nlohmann::json out = {{"format", kJournalFormat}, {"version", kJournalVersion}, {"renames", list}};
  try {
    return hal::write_file(journal, out.dump(1) + "\n");
  } catch (const nlohmann::json::exception&) {
    return failure(ErrorCode::kInconsistent, "%s: the name of a file or folder is not UTF-8", journal.c_str());
  }
}

Result<std::vector<PendingRename>> read_journal(const std::string& journal) {
  TOUCHLINE_TRY_ASSIGN(const std::string text, hal::read_file(journal, hal::kMaxTextFileBytes));
  const nlohmann::json in = nlohmann::json::parse(text, nullptr, false);
  try {
    if (in.at("format") == kJournalFormat && in.at("version") == kJournalVersion) return renames_of(in);
  } catch (const nlohmann::json::exception&) {  // the error below reports it
  }
  return failure(ErrorCode::kInconsistent,
                 "%s: an interrupted save cannot be finished, because its journal is damaged or of another version: "
                 "compare the saved files with their .bak",
                 journal.c_str());
}

Result<std::vector<std::string>> complete(const std::vector<PendingRename>& renames) {
  std::vector<std::string> left;
  std::set<fs::path> folders;
  for (const PendingRename& rename : renames) {
    const std::string& due = rename.temporary.empty() ? rename.path : rename.temporary;
    std::error_code error;
    const bool is_due = fs::exists(due, error);
    if (error) return failure(ErrorCode::kIo, "%s: %s", due.c_str(), error.message().c_str());
    if (!is_due) continue;
    if (state_of(rename.path) == rename.former) {
      TOUCHLINE_TRY(do_rename(rename));
      folders.insert(fs::path(rename.path).parent_path());
    } else {
      left.push_back(rename.path);
    }
  }
  for (const fs::path& folder : folders) TOUCHLINE_TRY(hal::sync_folder(folder.string()));
  return left;
}

}  // namespace touchline::setup
