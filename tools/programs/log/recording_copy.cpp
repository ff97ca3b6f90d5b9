#include "tools/programs/log/recording_copy.h"

namespace touchline::log {

RecordingCopy::~RecordingCopy() { writer_.discard(); }

Result<void> RecordingCopy::create(const std::string& path) { return writer_.create(path, "touchline-log"); }

void RecordingCopy::begin(const hal::mcap::McapReader& file) {
  file_ = &file;
  channels_.clear();
}

Result<std::uint16_t> RecordingCopy::channel_for(std::uint16_t channel) {
  if (const auto found = channels_.find(channel); found != channels_.end()) return found->second;
  const hal::mcap::Channel& from = file_->channels().at(channel);
  const auto schema = file_->schemas().find(from.schema);
  const bool has_schema = schema != file_->schemas().end();
  const auto [entry, is_new] =
      known_.try_emplace({from.topic, has_schema ? schema->second.name : std::string()}, std::uint16_t{0});
  if (is_new) {
    std::uint16_t schema_id = 0;
    if (has_schema) {
      const hal::mcap::Schema& text = schema->second;
      TOUCHLINE_TRY_ASSIGN(schema_id, writer_.add_schema(text.name, text.encoding, text.data));
    }
    TOUCHLINE_TRY_ASSIGN(entry->second, writer_.add_channel(schema_id, from.topic, from.encoding));
  }
  channels_[channel] = entry->second;
  return entry->second;
}

Result<void> RecordingCopy::add(const hal::mcap::Message& message) {
  TOUCHLINE_TRY_ASSIGN(const std::uint16_t channel, channel_for(message.channel));
  hal::mcap::Message copy = message;
  copy.channel = channel;
  writer_.add(copy, {message.data});
  return writer_.chunk_bytes() >= hal::mcap::McapWriter::kChunkBytes ? writer_.flush() : Result<void>();
}

Result<void> RecordingCopy::finish() { return writer_.close(); }

}  // namespace touchline::log
