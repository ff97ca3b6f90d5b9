#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "firmware/config/configuration.h"
#include "firmware/recording/configuration_text.h"
#include "firmware/recording/step_message.h"
#include "hal/recording/mcap_reader.h"
#include "hal/result.h"

namespace touchline::log {

/// A message of a file. What it points to is valid until the next one is read.
struct RecordedMessage {
  hal::mcap::Message message;
  const hal::mcap::Channel* channel = nullptr;
  recording::StepMessage* step = nullptr;                 // null: another message
  recording::ConfigurationText* configuration = nullptr;  // null: another message

  [[nodiscard]] bool is_picture() const;
  [[nodiscard]] bool is_frame() const { return step != nullptr && step->header.kind == recording::StepKind::kFrame; }
};

/// Reads a recording message by message, and decodes its steps and configurations.
class RecordedMessages {
 public:
  /// Errors of McapReader::open().
  Result<void> open(const std::string& path);
  /// Returns the next message; nullopt: there is none, see file(). Errors name file and byte.
  Result<std::optional<RecordedMessage>> next();
  /// Starts again from the beginning.
  void rewind() { reader_.rewind(); }

  [[nodiscard]] const hal::mcap::McapReader& file() const { return reader_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// Returns an error that names the file and the byte of the last message's chunk.
  [[nodiscard]] Error error_of(const Error& error) const;

 private:
  std::string path_;
  hal::mcap::McapReader reader_;
  std::unique_ptr<recording::StepMessage> step_ = std::make_unique<recording::StepMessage>();
  recording::ConfigurationText configuration_;
};

/// A recorded configuration, with the files from which it was read.
struct LoadedConfiguration {
  recording::TemporaryFiles files;
  config::Configuration configuration;
};
/// Loads a recorded configuration. Errors of config::load().
Result<std::unique_ptr<LoadedConfiguration>> load_recorded(const recording::ConfigurationText& text);

/// Returns how the file ends, if that is not as it should: "cut off at byte 1234"; "": it is complete.
std::string end_of(const hal::mcap::McapReader& file);

}  // namespace touchline::log
