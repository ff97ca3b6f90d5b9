#include "tools/programs/setup/saving.h"

#include <algorithm>
#include <filesystem>
#include <list>
#include <optional>

#include "firmware/config/file_backup.h"
#include "hal/files/input_file.h"
#include "hal/files/output_file.h"
#include "tools/programs/setup/setup_archive.h"

namespace touchline::setup {
namespace {

namespace fs = std::filesystem;

// Pictures first: a file is replaced after those that it names.
std::vector<std::string> in_order(const SetupFiles& draft, std::vector<std::string> names) {
  const auto rank = [&](const std::string& name) {
    return name == draft.board ? 3 : name == draft.venue ? 2 : name == draft.team ? 1 : 0;
  };
  std::stable_sort(names.begin(), names.end(),
                   [&](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
  return names;
}

// Undoes the first renames after a later one has failed. An error names the first file that cannot be undone either.
Result<void> restore(const std::vector<std::string>& paths, const std::vector<std::optional<std::string>>& former,
                     std::size_t count) {
  Result<void> restored;
  for (std::size_t i = count; i-- > 0;) {
    Result<void> one;
    if (former[i]) {
      one = hal::write_file(paths[i], *former[i]);
    } else if (std::error_code error; !fs::remove(paths[i], error) && error) {
      one = failure(ErrorCode::kIo, "%s: cannot be removed: %s", paths[i].c_str(), error.message().c_str());
    }
    if (!one.ok()) restored = std::move(one);
  }
  return restored;
}

}  // namespace

Result<void> save_files(const SetupFiles& draft, const std::vector<std::string>& names, const std::string& folder,
                        const std::string& journal) {
  SetupFiles written;
  written.board = draft.board;
  std::list<hal::OutputFile> files;
  std::vector<std::string> order;
  for (const std::string& name : in_order(draft, names)) {
    const auto file = draft.content.find(name);
    if (file == draft.content.end()) continue;
    const std::string path = (fs::path(folder) / name).string();
    hal::OutputFile& output = files.emplace_back();
    TOUCHLINE_TRY(output.open(path));
    TOUCHLINE_TRY(output.write(*file->second));
    TOUCHLINE_TRY(output.sync());
    written.content[name] = file->second;
    order.push_back(path);
  }
  std::vector<std::optional<std::string>> former;
  for (const std::string& path : order) {
    TOUCHLINE_TRY_ASSIGN(former.emplace_back(), config::read_text(path));
    TOUCHLINE_TRY(config::back_up(path));
  }
  // The journal needs the board file to name the others.
  written.content[draft.board] = draft.content.at(draft.board);
  TOUCHLINE_TRY(hal::write_file(journal, archive_of(written)));
  // Everything is on the disk already; what remains are renames.
  Result<void> committed;
  std::size_t done = 0;
  for (hal::OutputFile& output : files) {
    committed = output.commit();
    if (!committed.ok()) break;
    ++done;
  }
  if (!committed.ok()) {
    // With the journal, finish_saving() replaces all files, so that they fit each other again.
    if (const Result<void> restored = restore(order, former, done); !restored.ok()) {
      return Error{committed.code(), committed.text() + "; and the files before it cannot be restored (" +
                                         restored.text() + "): the next start of touchline-setup finishes this save"};
    }
  }
  std::error_code error;
  fs::remove(journal, error);
  return committed;
}

Result<void> finish_saving(const std::string& folder, const std::string& journal) {
  const Result<std::string> text = hal::read_file(journal, hal::kMaxTextFileBytes);
  if (text.code() == ErrorCode::kNotFound) return {};
  if (!text.ok()) return text.error();
  std::error_code error;
  const Result<SetupFiles> files = read_archive(text.value());
  if (!files.ok()) {
    fs::remove(journal, error);
    return prefixed(journal + ": an interrupted save cannot be finished", files.error());
  }
  for (const std::string& name : in_order(files.value(), [&] {
         std::vector<std::string> names;
         for (const auto& [each, content] : files.value().content) names.push_back(each);
         return names;
       }())) {
    TOUCHLINE_TRY(hal::write_file((fs::path(folder) / name).string(), files.value().text(name)));
  }
  fs::remove(journal, error);
  return {};
}

}  // namespace touchline::setup
