#include "tools/programs/log/recorded_messages.h"

#include "firmware/recording/recording_writer.h"

namespace touchline::log {

bool RecordedMessage::is_picture() const {
  return channel->topic == recording::kJpegTopic || channel->topic == recording::kRawTopic;
}

Result<void> RecordedMessages::open(const std::string& path) {
  path_ = path;
  return reader_.open(path);
}

Error RecordedMessages::error_of(const Error& error) const {
  return prefixed(path_ + ": byte " + std::to_string(reader_.offset()), error);
}

Result<std::optional<RecordedMessage>> RecordedMessages::next() {
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<hal::mcap::Message> message, reader_.next());
    if (!message) return std::optional<RecordedMessage>();
    const auto channel = reader_.channels().find(message->channel);
    if (channel == reader_.channels().end()) continue;
    RecordedMessage out{*message, &channel->second};
    if (channel->second.topic == recording::kStepTopic) {
      if (const Result<void> decoded = recording::decode(message->data, *step_); !decoded.ok()) {
        return error_of(decoded.error());
      }
      out.step = step_.get();
    } else if (channel->second.topic == recording::kConfigurationTopic) {
      Result<recording::ConfigurationText> text =
          recording::decode_configuration({reinterpret_cast<const char*>(message->data.data()), message->data.size()});
      if (!text.ok()) return error_of(text.error());
      configuration_ = std::move(text).value();
      out.configuration = &configuration_;
    }
    return std::optional(out);
  }
}

Result<std::unique_ptr<LoadedConfiguration>> load_recorded(const recording::ConfigurationText& text) {
  auto loaded = std::make_unique<LoadedConfiguration>();
  TOUCHLINE_TRY(loaded->files.write(text));
  TOUCHLINE_TRY(config::load(loaded->files.paths({}), loaded->configuration));
  return loaded;
}

std::string end_of(const hal::mcap::McapReader& file) {
  if (file.is_damaged()) return "damaged at byte " + std::to_string(file.offset()) + "; the rest is left out";
  return file.is_complete() ? std::string() : "cut off at byte " + std::to_string(file.offset());
}

}  // namespace touchline::log
