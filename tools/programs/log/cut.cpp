#include "tools/programs/log/cut.h"

#include <optional>
#include <vector>

#include "firmware/config/reload.h"
#include "firmware/recording/recording_writer.h"
#include "hal/recording/ssl_log.h"
#include "tools/programs/log/log_file.h"
#include "tools/programs/log/recorded_messages.h"
#include "tools/programs/log/recording_copy.h"

namespace touchline::log {
namespace {

/// Tells which messages lie in a stretch. Times may have any value, because a file may be damaged.
class Range {
 public:
  Range(std::int64_t begin_ns, const Stretch& stretch) : begin_ns_(static_cast<double>(begin_ns)), stretch_(stretch) {}
  [[nodiscard]] bool is_before(std::int64_t time_ns) const { return since_begin_s(time_ns) < stretch_.from_s; }
  [[nodiscard]] bool is_after(std::int64_t time_ns) const { return since_begin_s(time_ns) > stretch_.to_s; }

 private:
  // Rounded to 256 ns.
  [[nodiscard]] double since_begin_s(std::int64_t time_ns) const {
    return (static_cast<double>(time_ns) - begin_ns_) * 1e-9;
  }
  double begin_ns_;
  Stretch stretch_;
};

Error nothing_in(const std::string& input, const Stretch& stretch) {
  return failure(ErrorCode::kNotFound, "%s: nothing was recorded from %g to %g s; see touchline-log list",
                 input.c_str(), stretch.from_s, stretch.to_s);
}

/// The configuration in force while the steps before the stretch pass by.
class PassedConfiguration {
 public:
  void add(const recording::ConfigurationText& text) {
    if (text.reload == 0) {
      session_ = text;
      reloads_.clear();
      applied_ = 0;
    } else {
      reloads_.push_back(text);
    }
  }
  void pass(const recording::StepHeader& header) { applied_ = header.reload; }
  [[nodiscard]] bool has_session() const { return session_.session != 0; }
  /// Returns the configuration with which the session goes on, as if it began with it.
  Result<recording::ConfigurationText> now() const {
    if (applied_ == 0) return session_;
    TOUCHLINE_TRY_ASSIGN(const auto running, load_recorded(session_));
    for (const recording::ConfigurationText& reload : reloads_) {
      if (reload.reload > applied_) break;
      TOUCHLINE_TRY_ASSIGN(const auto read, load_recorded(reload));
      // A session keeps the values that only a restart changes.
      TOUCHLINE_TRY(config::apply_reloadable(read->configuration, running->configuration));
    }
    recording::ConfigurationText text = recording::text_of(running->configuration);
    text.session = session_.session;
    text.version = session_.version;
    text.camera = session_.camera;
    text.is_calibrated = session_.is_calibrated;
    return text;
  }
  /// Returns the reloads that no step has used yet.
  [[nodiscard]] std::vector<recording::ConfigurationText> waiting() const {
    std::vector<recording::ConfigurationText> out;
    for (const recording::ConfigurationText& reload : reloads_) {
      if (reload.reload > applied_) out.push_back(reload);
    }
    return out;
  }

 private:
  recording::ConfigurationText session_;
  std::vector<recording::ConfigurationText> reloads_;
  std::uint32_t applied_ = 0;
};

/// A message that is kept until it is known whether it belongs to the stretch.
struct KeptMessage {
  hal::mcap::Message message;
  std::string data;

  void keep(const hal::mcap::Message& from) {
    message = from;
    data.assign(reinterpret_cast<const char*>(from.data.data()), from.data.size());
  }
  [[nodiscard]] hal::mcap::Message kept() const {
    hal::mcap::Message out = message;
    out.data = hal::mcap::bytes_of(data);
    return out;
  }
};

Result<void> write_configuration(const KeptMessage& channel, const recording::ConfigurationText& text,
                                 RecordingCopy& copy) {
  const std::string bytes = recording::encode(text);
  hal::mcap::Message message = channel.message;
  message.data = hal::mcap::bytes_of(bytes);
  return copy.add(message);
}

Result<std::optional<std::int64_t>> time_of_first_step(RecordedMessages& messages) {
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<RecordedMessage> next, messages.next());
    if (!next) return std::optional<std::int64_t>();
    if (next->step != nullptr) return std::optional(static_cast<std::int64_t>(next->message.time_ns));
  }
}

Result<void> cut_recording(const std::string& input, const Stretch& stretch, const std::string& output) {
  RecordedMessages messages;
  TOUCHLINE_TRY(messages.open(input));
  TOUCHLINE_TRY_ASSIGN(const std::optional<std::int64_t> begin, time_of_first_step(messages));
  if (!begin) {
    return failure(ErrorCode::kNotFound, "%s: there are no steps in it; convert a game log back and cut it then",
                   input.c_str());
  }
  const Range range(*begin, stretch);
  messages.rewind();
  RecordingCopy copy;
  TOUCHLINE_TRY(copy.create(output));
  copy.begin(messages.file());
  PassedConfiguration passed;
  KeptMessage configuration, hello, picture;
  bool has_begun = false;
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<RecordedMessage> next, messages.next());
    if (!next) break;
    const auto time_ns = static_cast<std::int64_t>(next->message.time_ns);
    if (next->configuration != nullptr && !has_begun) {
      passed.add(*next->configuration);
      configuration.keep(next->message);
      continue;
    }
    // The page Recordings draws the field by it.
    if (next->channel->topic == recording::kHelloTopic && !has_begun) {
      hello.keep(next->message);
      continue;
    }
    // A picture precedes its step.
    if (next->is_picture()) {
      picture.keep(next->message);
      continue;
    }
    if (next->step != nullptr) {
      if (range.is_after(time_ns)) break;
      if (!has_begun && (!next->is_frame() || range.is_before(time_ns))) {
        passed.pass(next->step->header);
        continue;
      }
      if (!has_begun) {
        if (!passed.has_session()) {
          return messages.error_of(failure(ErrorCode::kInconsistent, "a step has no configuration"));
        }
        Result<recording::ConfigurationText> text = passed.now();
        if (!text.ok()) return messages.error_of(text.error());
        TOUCHLINE_TRY(write_configuration(configuration, text.value(), copy));
        for (const recording::ConfigurationText& reload : passed.waiting()) {
          TOUCHLINE_TRY(write_configuration(configuration, reload, copy));
        }
        if (!hello.data.empty()) TOUCHLINE_TRY(copy.add(hello.kept()));
        has_begun = true;
      }
      if (!picture.data.empty() && picture.message.sequence == next->message.sequence) {
        TOUCHLINE_TRY(copy.add(picture.kept()));
      }
    }
    if (has_begun) TOUCHLINE_TRY(copy.add(next->message));
  }
  if (!has_begun) return nothing_in(input, stretch);
  return copy.finish();
}

Result<void> cut_game_log(const std::string& input, const Stretch& stretch, const std::string& output) {
  hal::SslLogReader reader;
  TOUCHLINE_TRY(reader.open(input));
  hal::SslLogWriter writer;
  TOUCHLINE_TRY(writer.open(output));
  std::optional<Range> range;
  std::uint64_t written = 0;
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<hal::SslLogMessage> message, reader.next());
    if (!message) break;
    if (message->type == hal::kSslIndex) continue;  // its offsets are those of the whole file
    if (!range) range.emplace(message->time_ns, stretch);
    if (range->is_before(message->time_ns) || range->is_after(message->time_ns)) continue;
    TOUCHLINE_TRY(writer.add(*message));
    ++written;
  }
  if (written == 0) return nothing_in(input, stretch);
  return writer.commit();
}

}  // namespace

Result<void> cut(const std::string& input, const Stretch& stretch, const std::string& output) {
  TOUCHLINE_TRY(check_output(input, output));
  TOUCHLINE_TRY_ASSIGN(const LogFormat format, format_of(input));
  TOUCHLINE_TRY_ASSIGN(const OutputFormat wanted, output_format_of(output));
  if (wanted != (format == LogFormat::kMcap ? OutputFormat::kMcap : OutputFormat::kSslLog)) {
    return failure(ErrorCode::kUnsupported, "%s: a part of %s has its format; convert it afterwards", output.c_str(),
                   input.c_str());
  }
  return format == LogFormat::kMcap ? cut_recording(input, stretch, output) : cut_game_log(input, stretch, output);
}

}  // namespace touchline::log
