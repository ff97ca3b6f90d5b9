#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hal/result.h"

namespace touchline::console {

/// What the recorder does.
struct RecordingStatus {
  bool is_on = false;
  std::string file;  // the one that is being written, else the last one of this run; "": none yet
  double duration_s = 0.0;
  std::uint64_t frames = 0, pictures = 0, bytes = 0, lost_frames = 0, lost_pictures = 0;
  std::string ended;  // why the last one ended; "": it has not
};

/// Frames of a recording: `count` frames from number `from` on, each `step` frames after the former one.
struct FrameRange {
  std::uint64_t from = 0, count = 1, step = 1;
};

/// The recordings of a run. The console shows and controls them; firmware/recording implements it.
class Recordings {
 public:
  Recordings() = default;
  virtual ~Recordings() = default;
  Recordings(const Recordings&) = delete;
  Recordings& operator=(const Recordings&) = delete;

  // These never wait for a disk.
  /// Returns nullopt if nothing can be recorded.
  [[nodiscard]] virtual std::optional<RecordingStatus> status() const = 0;
  /// Begins or ends a recording; the status tells when it has happened, or why not. kUnsupported: nothing can be
  /// recorded; `who`: for the status.
  virtual Result<void> set_on(bool on, const std::string& who) = 0;

  // The rest reads the disk: one call at a time, on a thread of its own. `name` is that of a file in the folder;
  // kNotFound: there is no such recording; kCorruptFrame: it is damaged; kIo, kPermission.
  /// Returns JSON: the recordings in the folder, newest first.
  virtual Result<std::string> list() = 0;
  /// Returns JSON: what the recording holds, with the scenes of its sessions and its events.
  virtual Result<std::string> describe(const std::string& name) = 0;
  /// Returns the frames with their pictures (docs/console-protocol.md), at least one and at most a few megabytes.
  /// kOutOfRange: there is no frame `from`.
  virtual Result<std::string> frames(const std::string& name, const FrameRange& range) = 0;
  /// Returns the size of the file in bytes.
  virtual Result<std::uint64_t> size(const std::string& name) = 0;
  /// Returns a part of the file; shorter at its end.
  virtual Result<std::string> read(const std::string& name, std::uint64_t offset, std::uint64_t bytes) = 0;
  /// Deletes the file. kBusy: it is being written.
  virtual Result<void> remove(const std::string& name) = 0;
};

}  // namespace touchline::console
