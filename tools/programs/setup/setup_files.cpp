#include "tools/programs/setup/setup_files.h"

#include <toml++/toml.h>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <functional>
#include <set>

#include "firmware/config/section_writer.h"
#include "hal/files/input_file.h"
#include "hal/files/output_file.h"

namespace touchline::setup {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxNameBytes = 64;
// Keys of [light] that name pictures.
constexpr const char* kPictureKeys[] = {"map", "reference"};

Result<toml::table> parsed(const std::string& text, const std::string& name) {
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& fault) {
    return failure(ErrorCode::kInconsistent, "%s:%u: %s", name.c_str(), fault.source().begin.line,
                   std::string(fault.description()).c_str());
  }
}

Result<std::string> named_file(const toml::table& board, const std::string& path, const char* key) {
  const std::string name = board[key].value_or(std::string());
  if (is_file_name(name)) return name;
  return failure(ErrorCode::kInconsistent,
                 "%s: %s: the guided setup needs a file beside the board file, as %s = \"%s.toml\"", path.c_str(), key,
                 key, key);
}

using ReadFile = std::function<Result<FileContent>(const std::string& name)>;

// Collects the files that are named, directly or indirectly, by the board file. Missing files are skipped.
Result<SetupFiles> follow(const std::string& board, const std::string& path, const ReadFile& read) {
  SetupFiles out;
  out.board = board;
  TOUCHLINE_TRY_ASSIGN(out.content[board], read(board));
  TOUCHLINE_TRY_ASSIGN(const toml::table table, parsed(out.text(board), path));
  TOUCHLINE_TRY_ASSIGN(out.venue, named_file(table, path, "venue"));
  TOUCHLINE_TRY_ASSIGN(out.team, named_file(table, path, "team"));
  const auto read_if_present = [&](const std::string& name) -> Result<void> {
    Result<FileContent> content = read(name);
    if (content.code() == ErrorCode::kNotFound) return {};
    if (!content.ok()) return std::move(content).error();
    out.content[name] = std::move(content).value();
    return {};
  };
  TOUCHLINE_TRY(read_if_present(out.venue));
  TOUCHLINE_TRY(read_if_present(out.team));
  // A venue file with an error is not reported here, because it can be shown and replaced.
  const Result<toml::table> venue = parsed(out.text(out.venue), out.venue);
  for (const char* key : kPictureKeys) {
    const std::string name = venue.ok() ? venue.value()["light"][key].value_or(std::string()) : std::string();
    if (is_file_name(name)) TOUCHLINE_TRY(read_if_present(name));
  }
  return out;
}

}  // namespace

const std::string& SetupFiles::text(const std::string& name) const {
  static const std::string none;
  const auto file = content.find(name);
  return file == content.end() ? none : *file->second;
}

bool is_file_name(std::string_view name) {
  const auto allowed = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_' || c == '-';
  };
  return !name.empty() && name.size() <= kMaxNameBytes && name[0] != '.' &&
         std::all_of(name.begin(), name.end(), allowed) && (name.ends_with(".toml") || name.ends_with(".png"));
}

Result<FileContent> read_setup_file(const std::string& path) {
  const std::size_t limit_bytes = path.ends_with(".png") ? hal::kMaxDataFileBytes : hal::kMaxTextFileBytes;
  TOUCHLINE_TRY_ASSIGN(std::string content, hal::read_file(path, limit_bytes));
  return std::make_shared<const std::string>(std::move(content));
}

Result<SetupFiles> read_setup(const std::string& board_path) {
  const fs::path path(board_path);
  if (!is_file_name(path.filename().string())) {
    return failure(ErrorCode::kInconsistent,
                   "%s: the name of a board file has letters, digits, '.', '_', '-' and ends with .toml",
                   board_path.c_str());
  }
  const auto read = [&](const std::string& name) { return read_setup_file((path.parent_path() / name).string()); };
  return follow(path.filename().string(), board_path, read);
}

Result<SetupFiles> setup_of(const std::string& board, const std::map<std::string, FileContent>& content) {
  const auto read = [&](const std::string& name) -> Result<FileContent> {
    const auto file = content.find(name);
    if (file == content.end()) return failure(ErrorCode::kNotFound, "%s is missing", name.c_str());
    return file->second;
  };
  return follow(board, board, read);
}

Result<void> write_folder(const SetupFiles& files, const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return failure(ErrorCode::kIo, "%s: cannot be made: %s", folder.c_str(), error.message().c_str());
  std::vector<std::string> names;
  for (const auto& [name, content] : files.content) names.push_back(name);
  const auto is_picture = [](const std::string& name) { return name.ends_with(".png"); };
  std::stable_partition(names.begin(), names.end(), is_picture);
  for (const std::string& name : names) {
    const std::string path = (fs::path(folder) / name).string();
    const Result<FileContent> former = read_setup_file(path);
    if (former.ok() && *former.value() == files.text(name)) continue;
    TOUCHLINE_TRY(hal::write_file(path, files.text(name)));
  }
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (files.content.count(entry.path().filename().string()) > 0) continue;
    std::error_code ignored;
    fs::remove_all(entry.path(), ignored);
  }
  return {};
}

bool same_file(const SetupFiles& a, const SetupFiles& b, const std::string& name) {
  const auto x = a.content.find(name), y = b.content.find(name);
  if (x == a.content.end() || y == b.content.end()) return x == a.content.end() && y == b.content.end();
  return x->second == y->second || *x->second == *y->second;
}

std::vector<std::string> changed_files(const SetupFiles& before, const SetupFiles& after) {
  std::set<std::string> names;
  for (const auto& [name, content] : before.content) names.insert(name);
  for (const auto& [name, content] : after.content) names.insert(name);
  std::vector<std::string> out;
  std::copy_if(names.begin(), names.end(), std::back_inserter(out),
               [&](const std::string& name) { return !same_file(before, after, name); });
  return out;
}

Result<void> keep_saved_pictures(const SetupFiles& saved, SetupFiles& draft) {
  std::string text = draft.text(draft.venue);
  TOUCHLINE_TRY_ASSIGN(toml::table venue, parsed(text, draft.venue));
  toml::table* light = venue["light"].as_table();
  if (light == nullptr) return {};
  bool renamed = false;
  for (const char* key : kPictureKeys) {
    const std::string name = (*light)[key].value_or(std::string());
    const auto file = draft.content.find(name);
    if (file == draft.content.end() || saved.content.count(name) == 0 || same_file(saved, draft, name)) continue;
    const std::string stem = fs::path(name).stem().string();
    constexpr std::string_view kSecond = "-2";
    const std::string other =
        (stem.ends_with(kSecond) ? stem.substr(0, stem.size() - kSecond.size()) : stem + "-2") + ".png";
    const FileContent content = file->second;
    draft.content.erase(file);
    draft.content[other] = content;
    light->insert_or_assign(key, other);
    renamed = true;
  }
  if (!renamed) return {};
  std::ostringstream section;
  section << "[light]\n" << *light << "\n";
  TOUCHLINE_TRY_ASSIGN(text, config::replace_section(text, "light", section.str()));
  draft.content[draft.venue] = std::make_shared<const std::string>(std::move(text));
  return {};
}

}  // namespace touchline::setup
