#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"
#include "tools/programs/setup/setup_files.h"

namespace touchline::setup {

/// A PNG or JPEG for the page.
struct ShownPicture {
  std::uint32_t width_px = 0, height_px = 0;
  FileContent bytes;
  std::string owner;  // the step whose next measurement replaces it
};

/// A state of the draft: its files, and what the steps have measured.
struct DraftState {
  std::string name;  // of the step that led here
  SetupFiles files;
  nlohmann::json measured = nlohmann::json::object();  // by step, as in the page's state
  std::map<std::uint32_t, ShownPicture> pictures;      // by id; those that `measured` names
  // Pictures of robots and ball that the colors were learned from, in the order of measured["colors"]["pictures"].
  std::vector<std::shared_ptr<const calibrate::CameraPicture>> color_frames;
};

/// The draft with its undo and redo. The state folder has the current state, so that it survives the end of the
/// program; the steps before it do not.
class Draft {
 public:
  explicit Draft(std::string folder) : folder_(std::move(folder)) {}

  [[nodiscard]] bool is_open() const { return !states_.empty(); }
  /// Only if is_open().
  [[nodiscard]] const DraftState& now() const { return states_[current_]; }
  [[nodiscard]] const SetupFiles& saved() const { return saved_; }
  /// Where the files are, for the firmware.
  [[nodiscard]] std::string files_folder() const { return folder_ + "/draft"; }
  [[nodiscard]] std::vector<std::string> undo_names() const;
  [[nodiscard]] std::vector<std::string> redo_names() const;

  /// Begins with the saved files, or continues the draft of the state folder. Errors of read_setup() and
  /// hal::OutputFile.
  Result<void> begin(const std::string& board_path);
  /// Drops the draft, also on the disk.
  void close();
  /// Adds a step after the current one and drops those that could be redone. On error nothing changes. Errors of
  /// hal::OutputFile.
  Result<void> add(DraftState state);
  /// As add(), but takes the place of the current step.
  Result<void> replace(DraftState state);
  /// kNotFound: there is no such step. Errors of hal::OutputFile.
  Result<void> undo();
  Result<void> redo();

 private:
  Result<void> store(const DraftState& state) const;
  /// Keeps what a person has entered for the field beyond saving and the end of the program: no file of the setup has
  /// the height as it was measured. It counts as long as the venue file is the one that it led to.
  void keep_entries(const DraftState& state) const;
  void restore_entries(DraftState& state) const;
  Result<void> move_to(std::size_t index);

  std::string folder_;
  SetupFiles saved_;  // as they were at begin()
  std::vector<DraftState> states_;
  std::size_t current_ = 0;
};

}  // namespace touchline::setup
