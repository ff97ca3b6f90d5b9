#pragma once

#include <memory>
#include <optional>
#include <string>

#include "firmware/network/messages.h"
#include "firmware/network/publisher.h"
#include "firmware/recording/step_message.h"
#include "firmware/snapshot.h"
#include "hal/result.h"
#include "tools/programs/log/recorded_messages.h"

namespace touchline::log {

/// The results of a recorded frame as other programs get them.
struct RecordedFrame {
  const network::OutputFrame& output;
  const Commands& commands;
  std::uint32_t session = 0;
  std::int64_t time_ns = 0;  // Unix time of the step
  const config::Configuration& configuration;

  /// Returns the name of a team's color, which a referee may have exchanged.
  [[nodiscard]] const std::string& color_of(Team team) const;
};

/// Reads the frames of a recording. Sessions without calibration have none.
class RecordedFrames {
 public:
  /// Errors of RecordedMessages.
  Result<void> open(const std::string& path) { return messages_.open(path); }
  /// Returns the next frame, which is valid until the next call; nullopt: there is none.
  Result<std::optional<RecordedFrame>> next();
  [[nodiscard]] const RecordedMessages& messages() const { return messages_; }

 private:
  Result<void> take(const recording::ConfigurationText& text);

  RecordedMessages messages_;
  bool is_calibrated_ = true;
  std::unique_ptr<LoadedConfiguration> loaded_;
  network::PublishedScene scene_;
  std::unique_ptr<Snapshot> snapshot_ = std::make_unique<Snapshot>();
  std::unique_ptr<Sightings> sightings_ = std::make_unique<Sightings>();
  std::optional<network::OutputFrame> output_;
};

}  // namespace touchline::log
