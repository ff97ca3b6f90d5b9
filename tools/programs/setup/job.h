#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"
#include "tools/programs/setup/draft.h"
#include "tools/programs/setup/tested_robot.h"
#include "tools/programs/setup/worker.h"

namespace touchline::setup {

using CameraFrame = std::shared_ptr<const calibrate::CameraPicture>;

/// Input of a job's work. The work runs in a process of its own.
struct JobInput {
  std::string folder;  // folder with the files of the draft, which the work changes
  DraftState state;
  std::vector<CameraFrame> frames;  // as many as the job has asked for

  /// Returns the path of a file of the draft.
  [[nodiscard]] std::string path(const std::string& name) const { return folder + "/" + name; }
};

/// Output of a job's work, in addition to the changed files.
class JobOutput {
 public:
  explicit JobOutput(const Worker::Reporter& reporter) : reporter_(&reporter) {}
  void progress(std::string_view text, double share = -1) const { reporter_->progress(text, share); }
  /// Sets state.measured[step]; the former value's pictures are dropped.
  void measured(const nlohmann::json& value) const { reporter_->send({{"type", "measured"}, {"value", value}}); }
  /// Sets the `result` of the answer.
  void result(const nlohmann::json& value) const { reporter_->send({{"type", "result"}, {"value", value}}); }
  /// Sends a picture to the page, after measured(): its id is stored in measured[member], or in the result if the job
  /// does not change the draft. With `is_list`, the id is appended to a list. Errors of the encoder.
  Result<void> picture(const std::string& member, const hal::Picture& picture, bool is_list = false) const;
  /// As picture(), for an encoded picture.
  void encoded_picture(const std::string& member, std::uint32_t width_px, std::uint32_t height_px,
                       std::string_view bytes, bool is_list = false) const;

 private:
  const Worker::Reporter* reporter_;
};

/// A command that takes longer than the loop may wait.
struct Job {
  std::string command;
  std::string text;       // text that the page shows at the start
  std::string step;       // name of the step, such as "field"
  std::string undo_name;  // name of the draft's new state; empty: the draft does not change
  std::size_t frame_count = 0;
  double frame_interval_s = 0;
  bool keeps_frames = false;  // adds the frames to DraftState::color_frames
  /// Takes each frame as it arrives, in place of JobInput::frames, because there is memory for only a few. An error
  /// ends the job.
  std::function<Result<void>(const Frame&)> take_frame;
  // If set, the job first drives the robot `robot`, until the order is done; then the work begins.
  DriveRobot drive;
  RobotId robot = kUnknownId;
  std::function<Result<void>(const JobInput&, const JobOutput&)> work;
};

}  // namespace touchline::setup
