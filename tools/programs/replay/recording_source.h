#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "firmware/live_settings_builder.h"
#include "firmware/recording/configuration_text.h"
#include "firmware/recording/recording_hash.h"
#include "firmware/recording/step_message.h"
#include "hal/linux/v4l2/mjpg_decoder.h"
#include "hal/recording/mcap_reader.h"
#include "hal/result.h"

namespace touchline::replay {

/// Feeds a pipeline with the inputs of a recording (docs/recordings.md), step by step, and compares its results with
/// the recorded ones. It opens no device.
///
/// As long as all pictures of a session are recorded, the pipeline gets pictures. From the first missing one on, it
/// gets the recorded sightings until the session's end, because the adaptation to the light has missed a picture: then
/// tracks, commands and packets are reproduced, and recognition is not repeated. After a step that was lost, tracks
/// begin anew, until a step has the state after it; from the next one on, all is reproduced from recorded sightings.
class RecordingSource {
 public:
  /// A step that the pipeline has made.
  struct Step {
    const recording::StepHeader& header;
    const StepTrace* trace = nullptr;  // null: a stop
    bool has_picture = false;          // the frame's pixels are valid
    std::array<bool, recording::kResultParts> differs{};
    bool is_compared = true;  // false: a step before it was lost, and no state was recorded since
  };

  /// `overrides`: "key=value" that replace the recorded ones, also those of reloads.
  explicit RecordingSource(std::vector<std::string> overrides) : overrides_(std::move(overrides)) {}

  /// Errors of McapReader::open().
  Result<void> open(const std::string& path);
  /// Makes the next step; nullopt: there is none. The result is valid until the next call. Errors name the file.
  Result<std::optional<Step>> next();
  /// The configuration in use.
  [[nodiscard]] const config::Configuration& configuration() const { return *running_; }
  [[nodiscard]] std::uint32_t session() const { return session_; }
  [[nodiscard]] const recording::RecordingHash& hash() const { return hash_; }
  /// Returns what a person should know, one line each: sessions, reloads, gaps, the file's end. Clears them.
  std::vector<std::string> take_notes() { return std::exchange(notes_, {}); }

 private:
  Result<void> take_configuration(std::span<const std::byte> json);
  Result<void> begin_session(const recording::ConfigurationText& text);
  Result<void> prepare_reload(const recording::ConfigurationText& text);
  Result<std::optional<Step>> run(std::span<const std::byte> bytes);
  void note_gap();
  Result<void> restore_state();
  Result<void> fill_frame(Frame& frame);
  Result<bool> decode_picture(Frame& frame);
  Result<bool> take_reload();
  void finish_reload();
  void note_end();
  [[nodiscard]] Error error_of(const Error& error) const {
    return prefixed(path_ + ": byte " + std::to_string(reader_.offset()), error);
  }

  const std::vector<std::string> overrides_;
  std::string path_;
  hal::mcap::McapReader reader_;
  std::unique_ptr<config::Configuration> running_, next_;  // next_: with the reload that was read last
  std::unique_ptr<Pipeline> pipeline_;
  LiveSettingsBuilder live_settings_;
  std::uint32_t session_ = 0, prepared_reload_ = 0;
  std::optional<std::uint32_t> applied_reload_;  // nullopt: before the session's first step
  bool is_calibrated_ = true, uses_pictures_ = true, had_gap_ = false, was_restored_ = false;
  std::uint64_t next_number_ = 0;
  std::unique_ptr<recording::StepMessage> message_ = std::make_unique<recording::StepMessage>();
  std::unique_ptr<Sightings> sightings_ = std::make_unique<Sightings>();
  std::unique_ptr<Sightings> seen_ = std::make_unique<Sightings>();
  recording::StepResults results_;
  // The picture before the step's message.
  recording::PictureKind picture_kind_ = recording::PictureKind::kNone;
  std::uint32_t picture_sequence_ = 0;
  std::vector<std::byte> picture_;
  hal::MjpgDecoder decoder_;
  std::uint16_t decoder_width_px_ = 0, decoder_height_px_ = 0;
  std::vector<std::uint8_t> decoded_;
  recording::RecordingHash hash_;
  std::vector<std::string> notes_;
};

}  // namespace touchline::replay
