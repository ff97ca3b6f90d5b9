#include "tools/programs/log/join.h"

#include <algorithm>
#include <optional>

#include "hal/recording/ssl_log.h"
#include "tools/programs/log/log_file.h"
#include "tools/programs/log/recorded_messages.h"
#include "tools/programs/log/recording_copy.h"

namespace touchline::log {
namespace {

/// Numbers of sessions and messages that the files so far have used.
struct UsedNumbers {
  std::uint32_t session = 0, sequence = 0;
};

Result<void> append_recording(const std::string& input, UsedNumbers& used, RecordingCopy& copy) {
  RecordedMessages messages;
  TOUCHLINE_TRY(messages.open(input));
  copy.begin(messages.file());
  UsedNumbers last = used;
  std::string bytes;
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<RecordedMessage> next, messages.next());
    if (!next) break;
    hal::mcap::Message message = next->message;
    message.sequence += used.sequence;
    last.sequence = std::max(last.sequence, message.sequence);
    if (next->step != nullptr) {
      next->step->header.session += used.session;
      last.session = std::max(last.session, next->step->header.session);
      recording::encode(*next->step, bytes);
      message.data = hal::mcap::bytes_of(bytes);
    } else if (next->configuration != nullptr) {
      next->configuration->session += used.session;
      last.session = std::max(last.session, next->configuration->session);
      bytes = recording::encode(*next->configuration);
      message.data = hal::mcap::bytes_of(bytes);
    }
    TOUCHLINE_TRY(copy.add(message));
  }
  used = last;
  return {};
}

Result<void> append_game_log(const std::string& input, hal::SslLogWriter& writer) {
  hal::SslLogReader reader;
  TOUCHLINE_TRY(reader.open(input));
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<hal::SslLogMessage> message, reader.next());
    if (!message) return {};
    // Its offsets are those of one file.
    if (message->type != hal::kSslIndex) TOUCHLINE_TRY(writer.add(*message));
  }
}

}  // namespace

Result<void> join(const std::vector<std::string>& inputs, const std::string& output) {
  TOUCHLINE_TRY_ASSIGN(const OutputFormat wanted, output_format_of(output));
  for (const std::string& input : inputs) {
    TOUCHLINE_TRY(check_output(input, output));
    TOUCHLINE_TRY_ASSIGN(const LogFormat format, format_of(input));
    if (wanted != (format == LogFormat::kMcap ? OutputFormat::kMcap : OutputFormat::kSslLog)) {
      return failure(ErrorCode::kUnsupported, "%s: has another format than %s; convert it first", input.c_str(),
                     output.c_str());
    }
  }
  if (wanted == OutputFormat::kMcap) {
    RecordingCopy copy;
    TOUCHLINE_TRY(copy.create(output));
    UsedNumbers used;
    for (const std::string& input : inputs) TOUCHLINE_TRY(append_recording(input, used, copy));
    return copy.finish();
  }
  hal::SslLogWriter writer;
  TOUCHLINE_TRY(writer.open(output));
  for (const std::string& input : inputs) TOUCHLINE_TRY(append_game_log(input, writer));
  return writer.commit();
}

}  // namespace touchline::log
