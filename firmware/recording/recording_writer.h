#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/console/messages.h"
#include "firmware/recording/configuration_text.h"
#include "firmware/recording/game_events.h"
#include "firmware/recording/recording_hash.h"
#include "firmware/recording/step_message.h"
#include "firmware/recording/step_tap.h"
#include "hal/recording/mcap_writer.h"
#include "hal/result.h"

namespace touchline::recording {

/// Topics that a replay reads.
inline constexpr std::string_view kStepTopic = "/touchline/steps";
inline constexpr std::string_view kConfigurationTopic = "/touchline/configuration";
inline constexpr std::string_view kJpegTopic = "/camera/jpeg", kRawTopic = "/camera/raw";
/// Topics that the page Recordings reads beside the pictures.
inline constexpr std::string_view kHelloTopic = "/touchline/hello", kEventTopic = "/touchline/events",
                                  kStateTopic = "/state";

/// What a recording holds so far.
struct RecordingCounts {
  std::uint64_t steps = 0, pictures = 0, bytes = 0;
  std::uint64_t duration_ns = 0;  // from the first step to the last one
};

/// Turns the parts of a recording into messages of a file. Errors: those of McapWriter.
class RecordingWriter {
 public:
  /// Creates the file; if not everything that precedes the messages can be written, there is none. `version` of the
  /// program.
  Result<void> create(const std::string& path, std::string_view version);
  /// Writes the configuration of a session or reload. With the session's `scene`, its steps are also written as
  /// messages that other programs show.
  Result<void> add(const ConfigurationText& text);
  void begin_session(std::shared_ptr<const console::Scene> scene);
  Result<void> add_line(std::string_view level, std::string_view line);
  /// Adds what StepTap has put into the ring: its chunk is written when it is full.
  Result<void> add_step(std::span<const std::byte> record);
  /// Writes what was added, and waits for the disk.
  Result<void> save();
  Result<void> close();
  /// Closes the file and removes it.
  void discard() { file_.discard(); }

  /// What is in whole chunks.
  [[nodiscard]] const RecordingCounts& counts() const { return saved_counts_; }
  [[nodiscard]] const RecordingHash& hash() const { return saved_hash_; }
  [[nodiscard]] std::uint64_t size() const { return file_.size(); }

 private:
  struct Channels {
    std::uint16_t step = 0, configuration = 0, jpeg = 0, raw = 0, log = 0, packets = 0, state = 0, scene = 0,
                  annotations = 0, hello = 0, events = 0;
  };

  Result<void> add_channels();
  Result<void> flush();
  Result<std::uint16_t> add_channel(std::string_view topic, std::string_view schema, std::string_view schema_encoding,
                                    std::string_view schema_text, std::string_view encoding);
  std::uint64_t time_of(Instant instant);
  void add_bytes(std::uint16_t channel, std::uint64_t time_ns, std::string_view bytes);
  template <class Write>
  void add_json(std::uint16_t channel, std::uint64_t time_ns, const Write& write);
  void add_shown(const Snapshot& snapshot, std::uint64_t time_ns);
  void add_events(const FrameEvents& events, std::uint64_t time_ns);
  void add_packets(const OutgoingPackets& packets, std::uint64_t time_ns);

  hal::mcap::McapWriter file_;
  Channels channels_;
  std::uint32_t sequence_ = 0;
  std::shared_ptr<const console::Scene> scene_;
  std::optional<GameEvents> events_;  // of the session
  // Unix time at time 0 of the loop's clock, of one session: simulated time begins anew with each.
  std::uint32_t time_session_ = 0;
  Duration unix_offset_{};
  std::uint64_t first_time_ns_ = 0, last_time_ns_ = 0;
  std::unique_ptr<StepMessage> message_ = std::make_unique<StepMessage>();
  std::unique_ptr<Sightings> sightings_ = std::make_unique<Sightings>();
  std::unique_ptr<StepParts> parts_ = std::make_unique<StepParts>();
  std::unique_ptr<Snapshot> snapshot_ = std::make_unique<Snapshot>();
  std::string bytes_;
  std::vector<char> json_;
  RecordingCounts counts_, saved_counts_;
  RecordingHash hash_, saved_hash_;
};

}  // namespace touchline::recording
