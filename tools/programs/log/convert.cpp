#include "tools/programs/log/convert.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <memory>
#include <string_view>

#include "firmware/network/encoder.h"
#include "hal/recording/mcap_writer.h"
#include "hal/recording/ssl_log.h"
#include "tools/programs/log/csv.h"
#include "tools/programs/log/log_file.h"
#include "tools/programs/log/recorded_frame.h"
#include "tools/programs/log/recorded_messages.h"

namespace touchline::log {
namespace {

constexpr std::string_view kTopicOfOthers = "/ssl/type/";
// By type, from 0 on.
constexpr std::array<std::string_view, hal::kSslIndex + 1> kTopics{
    "/ssl/blank", "/ssl/unknown", "/ssl/vision2010", "/ssl/referee", "/ssl/vision", "/ssl/tracker", "/ssl/index"};
// As Touchline sends it (firmware/network/publisher.cpp).
constexpr std::int64_t kGeometryPeriod_ns = 1'000'000'000;

std::vector<std::string> end_notes(const hal::SslLogReader& reader, const std::string& path) {
  if (reader.is_complete()) return {};
  return {path + ": cut off in the message at byte " + std::to_string(reader.position()) + ", which is left out"};
}

std::vector<std::string> end_notes(const RecordedMessages& messages) {
  const std::string end = end_of(messages.file());
  if (end.empty()) return {};
  return {messages.path() + ": " + end};
}

/// Calls `take` for each message.
template <class Take>
Result<Conversion> for_each_message(const std::string& input, const Take& take) {
  hal::SslLogReader reader;
  TOUCHLINE_TRY(reader.open(input));
  Conversion done;
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<hal::SslLogMessage> message, reader.next());
    if (!message) break;
    TOUCHLINE_TRY_ASSIGN(const std::uint64_t written, take(*message));
    done.written += written;
  }
  done.notes = end_notes(reader, input);
  return done;
}

/// A game log in the container of recordings. A message keeps its bytes and time, and its topic tells its type.
class SslMcapWriter {
 public:
  SslMcapWriter() = default;
  ~SslMcapWriter() { file_.discard(); }
  SslMcapWriter(const SslMcapWriter&) = delete;
  SslMcapWriter& operator=(const SslMcapWriter&) = delete;

  Result<void> create(const std::string& path) { return file_.create(path, "touchline-log"); }
  Result<std::uint64_t> add(const hal::SslLogMessage& message) {
    const std::string topic = topic_of(message.type, message.time_ns);
    const auto [channel, is_new] = channels_.try_emplace(topic, std::uint16_t{0});
    // Viewers need a description of the messages to decode them; the packets of the leagues are not described here.
    if (is_new) {
      TOUCHLINE_TRY_ASSIGN(channel->second, file_.add_channel(0, topic, "protobuf"));
    }
    // An index has no time; it gets the last one, so that viewers do not begin in 1970.
    if (topic != kTopics[hal::kSslIndex]) time_ns_ = static_cast<std::uint64_t>(message.time_ns);
    file_.add({channel->second, sequence_++, time_ns_, {}}, {message.data});
    if (file_.chunk_bytes() >= hal::mcap::McapWriter::kChunkBytes) TOUCHLINE_TRY(file_.flush());
    return std::uint64_t{1};
  }
  Result<void> finish() { return file_.close(); }

 private:
  hal::mcap::McapWriter file_;
  std::map<std::string, std::uint16_t> channels_;
  std::uint32_t sequence_ = 0;
  std::uint64_t time_ns_ = 0;
};

Result<Conversion> game_log_to_mcap(const std::string& input, const std::string& output) {
  SslMcapWriter writer;
  TOUCHLINE_TRY(writer.create(output));
  TOUCHLINE_TRY_ASSIGN(Conversion done,
                       for_each_message(input, [&](const auto& message) { return writer.add(message); }));
  TOUCHLINE_TRY(writer.finish());
  return done;
}

Result<Conversion> game_log_to_game_log(const std::string& input, const std::string& output) {
  hal::SslLogWriter writer;
  TOUCHLINE_TRY(writer.open(output));
  const auto copy = [&](const hal::SslLogMessage& message) -> Result<std::uint64_t> {
    TOUCHLINE_TRY(writer.add(message));
    return std::uint64_t{1};
  };
  TOUCHLINE_TRY_ASSIGN(Conversion done, for_each_message(input, copy));
  TOUCHLINE_TRY(writer.commit());
  return done;
}

/// Writes what a converted game log holds; returns the number of its messages.
Result<Conversion> mcap_to_game_log(const std::string& input, const std::string& output) {
  RecordedMessages messages;
  TOUCHLINE_TRY(messages.open(input));
  hal::SslLogWriter writer;
  TOUCHLINE_TRY(writer.open(output));
  Conversion done;
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<RecordedMessage> next, messages.next());
    if (!next) break;
    const std::string& topic = next->channel->topic;
    const std::optional<std::int32_t> type = type_of(topic);
    if (!type) continue;
    const bool has_time = topic != kTopics[hal::kSslIndex];
    const std::int64_t time_ns = has_time ? static_cast<std::int64_t>(next->message.time_ns) : 0;
    TOUCHLINE_TRY(writer.add({time_ns, *type, next->message.data}));
    ++done.written;
  }
  done.notes = end_notes(messages);
  TOUCHLINE_TRY(writer.commit());
  return done;
}

/// The league's packets of one session.
class SessionPackets {
 public:
  [[nodiscard]] bool is_of(std::uint32_t session) const { return session_ == session; }
  Result<void> begin(std::uint32_t session, const config::Configuration& configuration) {
    session_ = session;
    next_geometry_ns_.reset();
    TOUCHLINE_TRY_ASSIGN(vision_, network::make_encoder(config::OutputProtocol::kSslVision, configuration));
    TOUCHLINE_TRY_ASSIGN(tracked_, network::make_encoder(config::OutputProtocol::kSslTracked, configuration));
    return {};
  }
  /// Returns the number of messages.
  Result<std::uint64_t> write(const RecordedFrame& frame, hal::SslLogWriter& writer) {
    std::uint64_t written = 0;
    const auto add = [&](std::int32_t type, std::size_t bytes) -> Result<void> {
      if (bytes == 0) return {};
      ++written;
      return writer.add({frame.time_ns, type, std::span(buffer_).first(bytes)});
    };
    if (!next_geometry_ns_ || frame.time_ns >= *next_geometry_ns_) {
      next_geometry_ns_ = frame.time_ns + kGeometryPeriod_ns;
      TOUCHLINE_TRY(add(hal::kSslVision, vision_->encode_geometry(buffer_)));
    }
    TOUCHLINE_TRY(add(hal::kSslVision, vision_->encode_frame(frame.output, buffer_)));
    TOUCHLINE_TRY(add(hal::kSslTracker, tracked_->encode_frame(frame.output, buffer_)));
    return written;
  }

 private:
  std::uint32_t session_ = 0;
  std::optional<std::int64_t> next_geometry_ns_;
  std::unique_ptr<network::Encoder> vision_, tracked_;
  std::vector<std::byte> buffer_ = std::vector<std::byte>(network::kMaxDatagramBytes);
};

Result<Conversion> recording_to_game_log(const std::string& input, const std::string& output) {
  RecordedFrames frames;
  TOUCHLINE_TRY(frames.open(input));
  hal::SslLogWriter writer;
  TOUCHLINE_TRY(writer.open(output));
  SessionPackets packets;
  Conversion done;
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<RecordedFrame> frame, frames.next());
    if (!frame) break;
    if (!packets.is_of(frame->session)) {
      const Result<void> begun = packets.begin(frame->session, frame->configuration);
      if (!begun.ok()) return frames.messages().error_of(begun.error());
    }
    TOUCHLINE_TRY_ASSIGN(const std::uint64_t written, packets.write(*frame, writer));
    done.written += written;
  }
  done.notes = end_notes(frames.messages());
  TOUCHLINE_TRY(writer.commit());
  return done;
}

Result<Conversion> recording_to_csv(const std::string& input, const std::string& output) {
  RecordedFrames frames;
  TOUCHLINE_TRY(frames.open(input));
  CsvWriter writer;
  TOUCHLINE_TRY(writer.open(output));
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<RecordedFrame> frame, frames.next());
    if (!frame) break;
    TOUCHLINE_TRY(writer.add(*frame));
  }
  TOUCHLINE_TRY(writer.commit());
  return Conversion{writer.rows(), end_notes(frames.messages())};
}

Result<Conversion> game_log_to_csv(const std::string& input, const std::string& output) {
  CsvWriter writer;
  TOUCHLINE_TRY(writer.open(output));
  std::uint64_t unreadable = 0;
  const auto add = [&](const hal::SslLogMessage& message) -> Result<std::uint64_t> {
    TOUCHLINE_TRY_ASSIGN(const bool is_readable, writer.add(message));
    unreadable += is_readable ? 0U : 1U;
    return std::uint64_t{0};
  };
  TOUCHLINE_TRY_ASSIGN(Conversion done, for_each_message(input, add));
  TOUCHLINE_TRY(writer.commit());
  done.written = writer.rows();
  if (unreadable > 0) done.notes.push_back(input + ": " + std::to_string(unreadable) + " packets cannot be read");
  return done;
}

/// Returns whether a file in the format MCAP was made from a game log.
Result<bool> holds_game_log(const std::string& input) {
  RecordedMessages messages;
  TOUCHLINE_TRY(messages.open(input));
  TOUCHLINE_TRY_ASSIGN(const std::optional<RecordedMessage> first, messages.next());
  return first && type_of(first->channel->topic).has_value();
}

}  // namespace

std::string topic_of(std::int32_t type, std::int64_t time_ns) {
  // The topic of indices is that of those without a time, which other tools write.
  const bool is_known = type >= 0 && type <= hal::kSslIndex && (type != hal::kSslIndex || time_ns == 0);
  if (is_known) return std::string(kTopics[static_cast<std::size_t>(type)]);
  return std::string(kTopicOfOthers) + std::to_string(type);
}

std::optional<std::int32_t> type_of(const std::string& topic) {
  const auto known = std::find(kTopics.begin(), kTopics.end(), topic);
  if (known != kTopics.end()) return static_cast<std::int32_t>(known - kTopics.begin());
  if (!topic.starts_with(kTopicOfOthers)) return std::nullopt;
  std::int32_t type = 0;
  const char* const end = topic.data() + topic.size();
  const auto [stop, error] = std::from_chars(topic.data() + kTopicOfOthers.size(), end, type);
  if (error != std::errc() || stop != end) return std::nullopt;
  return type;
}

Result<Conversion> convert(const std::string& input, const std::string& output) {
  TOUCHLINE_TRY(check_output(input, output));
  TOUCHLINE_TRY_ASSIGN(const LogFormat format, format_of(input));
  TOUCHLINE_TRY_ASSIGN(const OutputFormat wanted, output_format_of(output));
  if (format == LogFormat::kSslLog) {
    return wanted == OutputFormat::kMcap     ? game_log_to_mcap(input, output)
           : wanted == OutputFormat::kSslLog ? game_log_to_game_log(input, output)
                                             : game_log_to_csv(input, output);
  }
  TOUCHLINE_TRY_ASSIGN(const bool is_game_log, holds_game_log(input));
  if (is_game_log && wanted == OutputFormat::kSslLog) return mcap_to_game_log(input, output);
  if (is_game_log || wanted == OutputFormat::kMcap) {
    return failure(ErrorCode::kUnsupported, "%s: a %s becomes %s", input.c_str(),
                   is_game_log ? "game log in MCAP" : "recording",
                   is_game_log ? "a .log or .log.gz" : "a .log, .log.gz or .csv");
  }
  return wanted == OutputFormat::kSslLog ? recording_to_game_log(input, output) : recording_to_csv(input, output);
}

}  // namespace touchline::log
