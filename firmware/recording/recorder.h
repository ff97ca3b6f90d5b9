#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "firmware/config/configuration.h"
#include "firmware/console/recordings.h"
#include "firmware/recording/step_tap.h"
#include "firmware/session.h"
#include "hal/result.h"

namespace touchline::recording {

/// Where and how a run is recorded.
struct RecordingPlan {
  std::string folder;  // empty: nothing is recorded
  config::RecordingSettings settings;
};
/// `folder`: of --record; empty: the board file decides.
RecordingPlan plan_recording(const config::Configuration& configuration, const std::string& folder);

/// Records a run, with all of its sessions, into one file, or parts of it into several: `recording.automatic` and a
/// person decide. It has a thread of its own and a fixed memory for the loop's steps; the loop never waits for it,
/// except in simulated time. When the disk is full or fails, the recording ends and the run goes on.
class Recorder {
 public:
  using Print = std::function<void(const std::string& line)>;

  /// If the whole run is to be recorded, creates the file, after the quota's deletions. Errors of McapWriter::create();
  /// kNotFound: the folder does not exist; kPermission, kIo: it cannot be reached; kInconsistent: it is no folder;
  /// kFull: the disk has less free space than the reserve, or there is not enough memory.
  static Result<std::unique_ptr<Recorder>> open(const RecordingPlan& plan, const std::string& version);
  /// Calls finish(). If start() was never called, there is nothing to keep, and the file is removed.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// The loop's side; it exists as long as the recorder.
  [[nodiscard]] StepTap& tap();
  /// Starts the thread, once, before the calling thread gets its real-time priority. `print` is called on it when a
  /// recording begins or ends while the run goes on, and for each file that the quota deletes.
  void start(const Print& print);
  /// Call it before the session's loop runs, and after Session::open(). `waits`: the session has simulated time, which
  /// waits for the recorder.
  void begin_session(const Session& session, bool waits);
  /// Call it before the loop gets the settings of these new files.
  void add_reload(const config::Configuration& files);
  /// Adds a line of the log; any thread except the loop's may call it. Lines that do not fit are lost.
  void add_line(const std::string& level, const std::string& line);
  /// Writes the rest and ends the file; call it when the last loop has ended. A disk that blocks is left alone after
  /// some seconds: then the file has no end, and is readable nevertheless.
  void finish();

  /// Returns lines about the recording that ended with the run, or early, the last of them "recording hash: ...";
  /// empty: there was none. Call it after finish().
  [[nodiscard]] std::string summary() const;

  // These functions are for any thread, and may outlive this object.
  [[nodiscard]] std::function<console::RecordingStatus()> status_reader() const;
  /// Returns a function that begins or ends a recording; its text says who has ended it.
  [[nodiscard]] std::function<void(bool, const std::string&)> control() const;

 private:
  struct Shared;
  explicit Recorder(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}
  static void work(const std::shared_ptr<Shared>& shared, const Print& print);

  // Shared with the thread, which outlives this object if the disk blocks it.
  const std::shared_ptr<Shared> shared_;
};

}  // namespace touchline::recording
