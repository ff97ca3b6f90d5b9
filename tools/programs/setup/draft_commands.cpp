#include <algorithm>
#include <cstring>
#include <filesystem>

#include "tools/programs/setup/page_state.h"
#include "tools/programs/setup/robots_state.h"
#include "tools/programs/setup/saving.h"
#include "tools/programs/setup/setup_archive.h"
#include "tools/programs/setup/setup_program.h"
#include "tools/programs/setup/unified_difference.h"

// Commands that concern the draft as a whole.
namespace touchline::setup {
namespace {

namespace fs = std::filesystem;

using Answer = Result<nlohmann::json>;

// A setup has at most 1 MiB and arrives in pieces of 1 to 3000 bytes.
constexpr double kMaxParts = 4096;

// Saved files that have changed since the draft began.
Result<std::vector<std::string>> conflicts_of(const Draft& draft, const std::string& board) {
  TOUCHLINE_TRY_ASSIGN(const SetupFiles present, read_setup(board));
  return changed_files(draft.saved(), present);
}

}  // namespace

Answer SetupProgram::state(const Arguments&) {
  send_state();
  return nlohmann::json(nullptr);
}

Answer SetupProgram::begin(const Arguments&) {
  if (!draft_.is_open()) TOUCHLINE_TRY(draft_.begin(options_.board));
  use(true);
  send_state();
  return nlohmann::json(nullptr);
}

Answer SetupProgram::discard(const Arguments&) {
  draft_.close();
  error_.clear();
  use(false);
  send_state();
  return nlohmann::json(nullptr);
}

// Makes `next` the draft's new state. With `replaces_last`, undo leads to the state before the last one.
Answer SetupProgram::change(DraftState next, bool replaces_last) {
  TOUCHLINE_TRY(replaces_last ? draft_.replace(std::move(next)) : draft_.add(std::move(next)));
  if (uses_draft_) use(true);
  return nlohmann::json(nullptr);
}

Answer SetupProgram::undo(const Arguments&) {
  TOUCHLINE_TRY(draft_.undo());
  if (uses_draft_) use(true);
  send_state();
  return nlohmann::json(nullptr);
}

Answer SetupProgram::redo(const Arguments&) {
  TOUCHLINE_TRY(draft_.redo());
  if (uses_draft_) use(true);
  send_state();
  return nlohmann::json(nullptr);
}

Answer SetupProgram::cancel(const Arguments&) {
  if (!running_) return Error{ErrorCode::kNotFound, "nothing is running"};
  const Asker asker = asker_;
  end_job(running_->job.command + " was cancelled");
  asker_ = asker;
  return nlohmann::json(nullptr);
}

Answer SetupProgram::differences(const Arguments&) {
  const SetupFiles& files = draft_.now().files;
  nlohmann::json list = nlohmann::json::array();
  for (const std::string& name : changed_files(draft_.saved(), files)) {
    // Saving deletes no file, so a file that the setup no longer uses is not a difference.
    if (files.content.count(name) == 0) continue;
    const bool is_text = name.ends_with(".toml");
    list.push_back(
        {{"name", name},
         {"diff", is_text ? unified_difference(name, draft_.saved().text(name), files.text(name)) : std::string()}});
  }
  TOUCHLINE_TRY_ASSIGN(const std::vector<std::string> conflicts, conflicts_of(draft_, options_.board));
  return nlohmann::json{
      {"files", list}, {"conflicts", conflicts}, {"problems", problems_of(files, draft_.files_folder())}};
}

Answer SetupProgram::save(const Arguments& arguments) {
  TOUCHLINE_TRY_ASSIGN(const bool overwrite, arguments.flag("overwrite", false));
  const SetupFiles& files = draft_.now().files;
  TOUCHLINE_TRY_ASSIGN(const std::vector<std::string> conflicts, conflicts_of(draft_, options_.board));
  if (!conflicts.empty() && !overwrite) {
    std::string names;
    for (const std::string& name : conflicts) names += (names.empty() ? "" : ", ") + name;
    return failure(ErrorCode::kInconsistent,
                   "nothing was saved: somebody else has changed %s meanwhile; save with \"overwrite\" to replace that",
                   names.c_str());
  }
  std::vector<std::string> names = changed_files(draft_.saved(), files);
  names.insert(names.end(), conflicts.begin(), conflicts.end());
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  Result<void> saved =
      save_files(files, names, fs::path(options_.board).parent_path().string(), options_.folder + "/saving.json");
  if (!saved.ok()) return prefixed("nothing was saved", std::move(saved).error());
  draft_.close();
  use(false);
  send_state();
  return nlohmann::json{{"files", names}};
}

Answer SetupProgram::export_setup(const Arguments&) {
  return nlohmann::json{{"name", "touchline-setup.json"}, {"text", archive_of(draft_.now().files)}};
}

Answer SetupProgram::import_setup(const Arguments& arguments) {
  TOUCHLINE_TRY_ASSIGN(const double parts, arguments.number("parts", 1, kMaxParts));
  TOUCHLINE_TRY_ASSIGN(const double part, arguments.number("part", 0, parts - 1));
  TOUCHLINE_TRY_ASSIGN(const std::string text, arguments.text("text"));
  if (part == 0) import_.clear();
  if (import_.size() != static_cast<std::size_t>(part)) {
    import_.clear();
    return Error{ErrorCode::kInconsistent, "the pieces did not arrive in order: import the file again"};
  }
  import_.push_back(text);
  if (part + 1 < parts) return nlohmann::json(nullptr);
  std::string whole;
  for (const std::string& one : import_) whole += one;
  import_.clear();
  TOUCHLINE_TRY_ASSIGN(SetupFiles files, read_archive(whole));
  // An imported board file gets the name of this board's file, by which the service knows it.
  const std::string name = fs::path(options_.board).filename().string();
  if (files.board != name) {
    files.content[name] = files.content[files.board];
    files.content.erase(files.board);
    files.board = name;
  }
  TOUCHLINE_TRY(keep_saved_pictures(draft_.saved(), files));
  DraftState next;
  next.name = "import";
  next.files = std::move(files);
  Answer changed = change(std::move(next));
  send_state();
  return changed;
}

Answer SetupProgram::picture(const Arguments& arguments) {
  TOUCHLINE_TRY_ASSIGN(const double id, arguments.number("id", 1, 4294967295.0));
  const auto& pictures = draft_.now().pictures;
  const auto picture = pictures.find(static_cast<std::uint32_t>(id));
  if (picture == pictures.end()) return failure(ErrorCode::kNotFound, "there is no picture %.0f any more", id);
  send_picture(picture->first, picture->second, asker_.client);
  return nlohmann::json(nullptr);
}

Answer SetupProgram::use_files(const Arguments& arguments) {
  TOUCHLINE_TRY_ASSIGN(const std::string source, arguments.text("source"));
  if (source != "draft" && source != "saved") {
    return Error{ErrorCode::kInconsistent, "\"source\" must be draft or saved"};
  }
  use(source == "draft");
  return nlohmann::json(nullptr);
}

Answer SetupProgram::try_draft(const Arguments& arguments) {
  TOUCHLINE_TRY_ASSIGN(trying_, arguments.flag("on", false));
  // Starting a session cancels a running try, so the newest draft is used.
  try_waits_ = trying_ && use_runs_;
  if (!try_waits_) ask_to_try();
  send_state();
  return nlohmann::json(nullptr);
}

Answer SetupProgram::confirm(const Arguments& arguments) {
  TOUCHLINE_TRY_ASSIGN(const std::string step, arguments.text("step"));
  if (step != "camera" && step != "robots" && step != "radio") {
    return Error{ErrorCode::kInconsistent, "\"step\" must be camera, robots or radio"};
  }
  DraftState next = draft_.now();
  if (step == "robots") {
    const nlohmann::json robots = robots_state(draft_.files_folder() + "/" + next.files.team, {});
    if (!robots["problems"].empty()) {
      return failure(ErrorCode::kInconsistent, "%s", robots["problems"][0].get_ref<const std::string&>().c_str());
    }
  }
  next.name = step + " confirmed";
  next.measured[step]["done"] = true;
  Answer changed = change(std::move(next));
  send_state();
  return changed;
}

// Changes the text of one file of the draft, as a step.
Answer SetupProgram::change_text(const std::string& step, const std::string& file, Result<std::string> text,
                                 bool replaces_last, nlohmann::json radio) {
  if (!text.ok()) return prefixed(file, std::move(text).error());
  DraftState next = draft_.now();
  if (!radio.is_null()) next.measured["radio"] = std::move(radio);
  next.name = step;
  next.files.content[file] = std::make_shared<const std::string>(std::move(text).value());
  // A confirmation applied to the former text, or to the former camera with its exposure.
  for (const char* confirmed : {"robots", "radio", "camera "}) {
    const auto measured = next.measured.find(std::string(confirmed, std::strcspn(confirmed, " ")));
    if (measured != next.measured.end() && step.starts_with(confirmed)) measured->erase("done");
  }
  TOUCHLINE_TRY_ASSIGN(next.files, setup_of(next.files.board, next.files.content));
  const std::string check = options_.folder + "/check";
  TOUCHLINE_TRY(write_folder(next.files, check));
  TOUCHLINE_TRY(check_file(next.files, file, check));
  Answer changed = change(std::move(next), replaces_last);
  send_state();
  return changed;
}

Answer SetupProgram::drive(const Arguments& arguments) {
  TOUCHLINE_TRY_ASSIGN(const bool on, arguments.flag("on", false));
  send({{"type", "drive"}, {"on", on}});
  return nlohmann::json(nullptr);
}

}  // namespace touchline::setup
