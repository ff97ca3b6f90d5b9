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

/// A PNG or JPEG that the page shows.
struct ShownPicture {
  std::uint32_t width_px = 0, height_px = 0;
  FileContent bytes;
  std::string owner;  // step whose next measurement replaces the picture
};

/// A state of the draft: its files, and the measurements of the steps.
struct DraftState {
  std::string name;  // name of the step that led to this state
  SetupFiles files;
  nlohmann::json measured = nlohmann::json::object();  // by step, as in the state sent to the page
  std::map<std::uint32_t, ShownPicture> pictures;      // by id; the pictures that `measured` names
  // Pictures of robots and ball that the colors were learned from, in the order of measured["colors"]["pictures"].
  std::vector<std::shared_ptr<const calibrate::CameraPicture>> color_frames;
};

/// The draft with its undo and redo. The state folder holds the current state, which so survives the end of the
/// program; earlier states are lost.
class Draft {
 public:
  explicit Draft(std::string folder) : folder_(std::move(folder)) {}

  [[nodiscard]] bool is_open() const { return !states_.empty(); }
  /// Returns the current state; requires is_open().
  [[nodiscard]] const DraftState& now() const { return states_[current_]; }
  [[nodiscard]] const SetupFiles& saved() const { return saved_; }
  /// Returns the folder of the files, for the firmware.
  [[nodiscard]] std::string files_folder() const { return folder_ + "/draft"; }
  [[nodiscard]] std::vector<std::string> undo_names() const;
  [[nodiscard]] std::vector<std::string> redo_names() const;

  /// Begins with the saved files, or continues the draft in the state folder. Errors of read_setup() and
  /// hal::OutputFile.
  Result<void> begin(const std::string& board_path);
  /// Drops the draft, also on the disk.
  void close();
  /// Adds a state after the current one, and drops the states that could be redone. On error nothing changes. Errors of
  /// hal::OutputFile.
  Result<void> add(DraftState state);
  /// As add(), but replaces the current state.
  Result<void> replace(DraftState state);
  /// kNotFound: there is no such step. Errors of hal::OutputFile.
  Result<void> undo();
  Result<void> redo();

 private:
  Result<void> store(const DraftState& state) const;
  Result<void> move_to(std::size_t index);

  std::string folder_;
  SetupFiles saved_;  // files as they were at begin()
  std::vector<DraftState> states_;
  std::size_t current_ = 0;
};

}  // namespace touchline::setup
