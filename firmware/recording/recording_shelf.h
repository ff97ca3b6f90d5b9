#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "firmware/console/recordings.h"
#include "firmware/recording/recording_view.h"

namespace touchline::recording {

class Recorder;

/// The recordings in a folder, as the console shows them. A name that could lead out of the folder, and a link, are not
/// found.
class RecordingShelf final : public console::Recordings {
 public:
  /// `recorder`: null: nothing can be recorded.
  RecordingShelf(std::string folder, const Recorder* recorder);

  [[nodiscard]] std::optional<console::RecordingStatus> status() const override;
  Result<void> set_on(bool on, const std::string& who) override;
  Result<std::string> list() override;
  Result<std::string> describe(const std::string& name) override;
  Result<std::string> frames(const std::string& name, const console::FrameRange& range) override;
  Result<std::uint64_t> size(const std::string& name) override;
  Result<std::string> read(const std::string& name, std::uint64_t offset, std::uint64_t bytes) override;
  Result<void> remove(const std::string& name) override;

 private:
  Result<std::string> path_of(const std::string& name) const;
  Result<RecordingView*> view_of(const std::string& name, bool is_fresh);

  const std::string folder_;
  std::function<console::RecordingStatus()> status_;
  std::function<void(bool, const std::string&)> control_;
  std::map<std::string, RecordingFacts> known_;  // of files that no longer grow
  std::string shown_;                            // name of the recording in `view_`
  std::unique_ptr<RecordingView> view_;
};

}  // namespace touchline::recording
