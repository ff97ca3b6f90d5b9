#include "tools/programs/log/listing.h"

#include <firmware/network/proto/ssl_referee.pb.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "firmware/stop_rules.h"
#include "hal/poses/protobuf.h"
#include "hal/recording/ssl_log.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/log/convert.h"
#include "tools/programs/log/log_file.h"
#include "tools/programs/log/recorded_messages.h"

namespace touchline::log {
namespace {

// Half a minute of text for a person; the file has the rest.
constexpr std::size_t kMaxListed = 100;
// The events of a recording that has them.
constexpr std::string_view kEventTopic = "/touchline/events";
// Vision sends at 30 Hz and more; ten frames are missing.
constexpr double kGap_s = 0.3;

std::string utc(std::int64_t time_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::time_t time = static_cast<std::time_t>(time_ns / kSecond);
  std::tm parts{};
  std::array<char, 32> text{};
  if (time_ns <= 0 || ::gmtime_r(&time, &parts) == nullptr) return "unknown";
  const std::size_t size = std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S UTC", &parts);
  return {text.data(), size};
}

/// Lines of one kind, the first ones of many.
class Lines {
 public:
  void add(std::string line) {
    if (lines_.size() < kMaxListed) lines_.push_back(std::move(line));
    ++count_;
  }
  void print(std::string& out) const {
    for (const std::string& line : lines_) out += line + "\n";
    if (count_ > lines_.size()) out += "and " + std::to_string(count_ - lines_.size()) + " more\n";
  }

 private:
  std::vector<std::string> lines_;
  std::size_t count_ = 0;
};

/// Messages of each channel.
class ChannelTable {
 public:
  void add(const std::string& topic, std::size_t bytes) {
    Entry& entry = entries_[topic];
    ++entry.messages;
    entry.bytes += bytes;
  }
  void print(std::string& out) const {
    out += formatted("%-26s %10s %12s\n", "channel", "messages", "bytes");
    for (const auto& [topic, entry] : entries_) {
      out += formatted("%-26s %10llu %12llu\n", topic.c_str(), entry.messages, entry.bytes);
    }
  }

 private:
  struct Entry {
    unsigned long long messages = 0, bytes = 0;
  };
  std::map<std::string, Entry> entries_;
};

std::string halt_text(std::uint32_t halt) {
  std::string text;
  for (const HaltDescription& description : kHaltDescriptions) {
    if ((halt & description.bit) != 0) text += (text.empty() ? "" : ", ") + std::string(description.reason);
  }
  return text;
}

/// Follows a recording, and notes what happens.
class RecordingSummary {
 public:
  void add(const RecordedMessage& message) {
    channels_.add(message.channel->topic, message.message.data.size());
    const auto time_ns = static_cast<std::int64_t>(message.message.time_ns);
    if (message.configuration != nullptr) add_configuration(*message.configuration);
    if (message.step != nullptr) add_step(*message.step, time_ns);
    if (message.channel->topic == kEventTopic) add_event(message.message.data, time_ns);
  }
  [[nodiscard]] std::string text(const RecordedMessages& messages) const {
    const std::string end = end_of(messages.file());
    std::string out =
        formatted("%s: recording of %.1f MB, %s\n", messages.path().c_str(),
                  static_cast<double>(messages.file().size()) * 1e-6, end.empty() ? "complete" : end.c_str());
    if (!begin_ns_) return out + "no steps\n";
    out += formatted("from %s, %.3f s: %llu frames, %llu of them with pictures, %llu stops, %llu steps lost\n",
                     utc(*begin_ns_).c_str(), since_begin_s(last_ns_), frames_, pictures_, stops_, lost_);
    happened_.print(out);
    channels_.print(out);
    return out;
  }

 private:
  [[nodiscard]] double since_begin_s(std::int64_t time_ns) const {
    return begin_ns_ ? (static_cast<double>(time_ns) - static_cast<double>(*begin_ns_)) * 1e-9 : 0.0;
  }
  void note(std::int64_t time_ns, const std::string& text) {
    happened_.add(formatted("%10.3f s  %s", since_begin_s(time_ns), text.c_str()));
  }
  void add_configuration(const recording::ConfigurationText& text) {
    if (text.reload != 0) return;  // a step tells when it takes effect
    session_text_ = "session " + std::to_string(text.session) + ", touchline " + text.version +
                    (text.camera.empty() ? std::string() : ": " + text.camera) +
                    (text.is_calibrated ? "" : "; not calibrated");
  }
  void add_step(const recording::StepMessage& step, std::int64_t time_ns) {
    const recording::StepHeader& header = step.header;
    if (!begin_ns_) begin_ns_ = time_ns;
    if (header.session != session_) {
      session_ = header.session;
      next_ = 0;
      halt_ = 0;
      reload_ = 0;
      note(time_ns, session_text_);
    }
    if (header.number != next_) {
      const std::uint64_t count = header.number - next_;
      lost_ += count;
      note(time_ns, std::to_string(count) + (count == 1 ? " step" : " steps") + " before it not recorded");
    }
    next_ = header.number + 1;
    const bool is_frame = header.kind == recording::StepKind::kFrame;
    frames_ += is_frame ? 1U : 0U;
    stops_ += is_frame ? 0U : 1U;
    pictures_ += header.picture != recording::PictureKind::kNone ? 1U : 0U;
    if (header.reload != reload_) note(time_ns, "reload " + std::to_string(header.reload));
    reload_ = header.reload;
    if (step.inputs.halt != halt_) {
      halt_ = step.inputs.halt;
      note(time_ns, halt_ == 0 ? std::string("robots may drive") : "halt: " + halt_text(halt_));
    }
    last_ns_ = time_ns;
  }
  void add_event(std::span<const std::byte> data, std::int64_t time_ns) {
    const nlohmann::json event = nlohmann::json::parse(
        std::string_view(reinterpret_cast<const char*>(data.data()), data.size()), nullptr, false);
    if (!event.is_object() || event.value("kind", nlohmann::json()) != "goal") return;
    const auto number = [&](const char* key) { return event.value(key, nlohmann::json()).dump(); };
    note(time_ns, "goal, " + number("own") + " : " + number("opponent"));
  }

  std::optional<std::int64_t> begin_ns_;
  std::int64_t last_ns_ = 0;
  unsigned long long frames_ = 0, pictures_ = 0, stops_ = 0, lost_ = 0;
  std::uint32_t session_ = 0, halt_ = 0, reload_ = 0;
  std::uint64_t next_ = 0;
  std::string session_text_;
  Lines happened_;
  ChannelTable channels_;
};

Result<std::string> list_recording(const std::string& input) {
  RecordedMessages messages;
  TOUCHLINE_TRY(messages.open(input));
  RecordingSummary summary;
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<RecordedMessage> next, messages.next());
    if (!next) return summary.text(messages);
    summary.add(*next);
  }
}

/// Follows a game log, and notes what happens.
class GameLogSummary {
 public:
  void add(const hal::SslLogMessage& message) {
    channels_.add(topic_of(message.type, message.time_ns), message.data.size());
    ++messages_;
    if (message.type == hal::kSslIndex) return;
    if (!begin_ns_) begin_ns_ = message.time_ns;
    last_ns_ = message.time_ns;
    if (message.type == hal::kSslVision || message.type == hal::kSslVision2010) add_vision(message.time_ns);
    if (message.type == hal::kSslReferee) add_referee(message);
  }
  [[nodiscard]] std::string text(const std::string& path, const hal::SslLogReader& reader) const {
    const std::string end =
        reader.is_complete() ? "complete" : "cut off in the message at byte " + std::to_string(reader.position());
    std::string out = formatted("%s: game log of %.1f MB unpacked, %s\n", path.c_str(),
                                static_cast<double>(reader.position()) * 1e-6, end.c_str());
    if (!begin_ns_) return out + "no messages\n";
    out += formatted("from %s, %.3f s, %llu messages\n", utc(*begin_ns_).c_str(), since_begin_s(last_ns_), messages_);
    happened_.print(out);
    channels_.print(out);
    return out;
  }

 private:
  [[nodiscard]] double since_begin_s(std::int64_t time_ns) const {
    return (static_cast<double>(time_ns) - static_cast<double>(*begin_ns_)) * 1e-9;
  }
  void note(std::int64_t time_ns, const std::string& text) {
    happened_.add(formatted("%10.3f s  %s", since_begin_s(time_ns), text.c_str()));
  }
  void add_vision(std::int64_t time_ns) {
    if (vision_ns_) {
      const double pause_s = since_begin_s(time_ns) - since_begin_s(*vision_ns_);
      if (pause_s > kGap_s) note(*vision_ns_, formatted("no vision for %.3f s", pause_s));
    }
    vision_ns_ = time_ns;
  }
  void add_referee(const hal::SslLogMessage& message) {
    ssl_Referee referee = ssl_Referee_init_zero;
    if (!hal::decode_message(ssl_Referee_fields, message.data, &referee).ok()) return;
    if (referee.command_counter != command_counter_) {
      const bool is_halt = referee.command == ssl_Command_HALT;
      if (is_halt && !is_halted_) note(message.time_ns, "halt");
      is_halted_ = is_halt;
      command_counter_ = referee.command_counter;
    }
    const std::pair score{referee.yellow.score, referee.blue.score};
    if (score_ && score != *score_) {
      note(message.time_ns, formatted("score: yellow %u, blue %u", score.first, score.second));
    }
    score_ = score;
  }

  std::optional<std::int64_t> begin_ns_, vision_ns_;
  std::int64_t last_ns_ = 0;
  unsigned long long messages_ = 0;
  std::optional<std::uint32_t> command_counter_;
  bool is_halted_ = false;
  std::optional<std::pair<std::uint32_t, std::uint32_t>> score_;
  Lines happened_;
  ChannelTable channels_;
};

Result<std::string> list_game_log(const std::string& input) {
  hal::SslLogReader reader;
  TOUCHLINE_TRY(reader.open(input));
  GameLogSummary summary;
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<hal::SslLogMessage> message, reader.next());
    if (!message) return summary.text(input, reader);
    summary.add(*message);
  }
}

}  // namespace

Result<std::string> list(const std::string& input) {
  TOUCHLINE_TRY_ASSIGN(const LogFormat format, format_of(input));
  return format == LogFormat::kMcap ? list_recording(input) : list_game_log(input);
}

}  // namespace touchline::log
