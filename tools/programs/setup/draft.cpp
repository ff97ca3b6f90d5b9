#include "tools/programs/setup/draft.h"

#include <filesystem>

#include "firmware/config/section_writer.h"

namespace touchline::setup {
namespace {

namespace fs = std::filesystem;

// Number of states that can be undone; each has its own texts and pictures, up to 1 MB.
constexpr std::size_t kMaxStates = 64;

}  // namespace

std::vector<std::string> Draft::undo_names() const {
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= current_ && i < states_.size(); ++i) names.push_back(states_[i].name);
  return names;
}

std::vector<std::string> Draft::redo_names() const {
  std::vector<std::string> names;
  for (std::size_t i = states_.size(); i-- > current_ + 1;) names.push_back(states_[i].name);
  return names;
}

Result<void> Draft::begin(const std::string& board_path) {
  TOUCHLINE_TRY_ASSIGN(SetupFiles saved, read_setup(board_path));
  DraftState state;
  // An earlier draft exists, with the files that it began with.
  const std::string board = fs::path(board_path).filename().string();
  Result<SetupFiles> left = read_setup((fs::path(files_folder()) / board).string());
  Result<SetupFiles> base = read_setup((fs::path(folder_) / "saved" / board).string());
  if (left.ok() && base.ok()) {
    saved = std::move(base).value();
    state.files = std::move(left).value();
  } else {
    state.files = saved;
    TOUCHLINE_TRY(write_folder(saved, folder_ + "/saved"));
  }
  // The firmware runs without a calibration, but not without a venue file.
  FileContent& venue = state.files.content[state.files.venue];
  if (venue == nullptr) venue = std::make_shared<const std::string>(config::kNewFile);
  TOUCHLINE_TRY(store(state));
  saved_ = std::move(saved);
  states_.clear();
  states_.push_back(std::move(state));
  current_ = 0;
  return {};
}

void Draft::close() {
  states_.clear();
  current_ = 0;
  std::error_code error;
  fs::remove_all(folder_ + "/draft", error);
  fs::remove_all(folder_ + "/saved", error);
}

Result<void> Draft::store(const DraftState& state) const { return write_folder(state.files, files_folder()); }

Result<void> Draft::add(DraftState state) {
  TOUCHLINE_TRY(store(state));
  states_.resize(current_ + 1);
  states_.push_back(std::move(state));
  if (states_.size() > kMaxStates) states_.erase(states_.begin());
  current_ = states_.size() - 1;
  return {};
}

Result<void> Draft::replace(DraftState state) {
  TOUCHLINE_TRY(store(state));
  states_.resize(current_ + 1);
  states_.back() = std::move(state);
  return {};
}

Result<void> Draft::move_to(std::size_t index) {
  TOUCHLINE_TRY(store(states_[index]));
  current_ = index;
  return {};
}

Result<void> Draft::undo() {
  if (current_ == 0) return Error{ErrorCode::kNotFound, "there is nothing to undo"};
  return move_to(current_ - 1);
}

Result<void> Draft::redo() {
  if (current_ + 1 >= states_.size()) return Error{ErrorCode::kNotFound, "there is nothing to redo"};
  return move_to(current_ + 1);
}

}  // namespace touchline::setup
