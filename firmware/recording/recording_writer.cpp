#include "firmware/recording/recording_writer.h"

#include <algorithm>
#include <chrono>
#include <cstring>

#include "firmware/console/foxglove_messages.h"
#include "firmware/console/foxglove_schemas.h"
#include "firmware/recording/picture_message.h"
#include "firmware/report/base64.h"
#include "firmware/report/json_writer.h"

namespace touchline::recording {
namespace {

using report::JsonWriter;

// A state of 22 robots has up to 20 KB, the projection of the largest field 60 KB.
constexpr std::size_t kJsonBytes = std::size_t{1} << 17;

constexpr std::string_view kLogSchema =
    R"({"type":"object","title":"foxglove.Log","properties":{"timestamp":{"type":"object","title":"time",)"
    R"("properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},"level":{"type":"integer"},)"
    R"("message":{"type":"string"},"name":{"type":"string"},"file":{"type":"string"},"line":{"type":"integer"}}})";
constexpr std::string_view kPacketsSchema =
    R"({"type":"object","title":"touchline.Packets","properties":{"packets":{"type":"array","items":{"type":"object",)"
    R"("properties":{"receiver":{"type":"integer"},"bytes":{"type":"string","contentEncoding":"base64"}}}}}})";
constexpr std::string_view kHelloSchema =
    R"({"type":"object","title":"touchline.Hello","description":"`hello` of docs/console-protocol.md"})";
constexpr std::string_view kEventSchema =
    R"({"type":"object","title":"touchline.Event","properties":{"kind":{"type":"string"},"team":{"type":"string"},)"
    R"("by":{"type":"string"},"own":{"type":"integer"},"opponent":{"type":"integer"},"halt":{"type":"array","items":)"
    R"({"type":"string"}},"id":{"type":"integer"},"latency_ms":{"type":"number"}}})";
constexpr std::string_view kConfigurationSchema =
    R"({"type":"object","title":"touchline.Configuration","properties":{"session":{"type":"integer"},)"
    R"("reload":{"type":"integer"},"version":{"type":"string"},"camera":{"type":"string"},"calibrated":)"
    R"({"type":"boolean"},"board.toml":{"type":"string"},"venue.toml":{"type":"string"},"team.toml":)"
    R"({"type":"string"},"light_map.png":{"type":"string","contentEncoding":"base64"},"light_reference.png":)"
    R"({"type":"string","contentEncoding":"base64"}}})";

std::uint64_t unix_now_ns() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
}

// Numbers of foxglove.Log.
int log_level(std::string_view level) { return level == "error" ? 4 : level == "warning" ? 3 : 2; }

}  // namespace

Result<std::uint16_t> RecordingWriter::add_channel(std::string_view topic, std::string_view schema,
                                                   std::string_view schema_encoding, std::string_view schema_text,
                                                   std::string_view encoding) {
  TOUCHLINE_TRY_ASSIGN(const std::uint16_t id,
                       file_.add_schema(std::string(schema), std::string(schema_encoding), std::string(schema_text)));
  return file_.add_channel(id, std::string(topic), std::string(encoding));
}

Result<void> RecordingWriter::create(const std::string& path, std::string_view version) {
  json_.resize(kJsonBytes);
  TOUCHLINE_TRY(file_.create(path, "touchline " + std::string(version)));
  Result<void> added = add_channels();
  if (!added.ok()) file_.discard();
  return added;
}

Result<void> RecordingWriter::add_channels() {
  const auto add_ros = [&](std::string_view topic, PictureKind kind) {
    return add_channel(topic, picture_schema_name(kind), "ros2msg", picture_schema(kind), "cdr");
  };
  const auto add_json_channel = [&](std::string_view topic, std::string_view schema, std::string_view text) {
    return add_channel(topic, schema, "jsonschema", text, "json");
  };
  const auto add_foxglove = [&](console::FoxgloveChannel channel) {
    const console::FoxgloveSchema schema = console::foxglove_schema(channel);
    return add_json_channel(schema.topic, schema.name, schema.text);
  };
  TOUCHLINE_TRY_ASSIGN(channels_.step, add_channel(kStepTopic, "touchline.Step", "text", step_schema(), "touchline"));
  TOUCHLINE_TRY_ASSIGN(channels_.configuration,
                       add_json_channel(kConfigurationTopic, "touchline.Configuration", kConfigurationSchema));
  TOUCHLINE_TRY_ASSIGN(channels_.jpeg, add_ros(kJpegTopic, PictureKind::kJpeg));
  TOUCHLINE_TRY_ASSIGN(channels_.raw, add_ros(kRawTopic, PictureKind::kRaw));
  TOUCHLINE_TRY_ASSIGN(channels_.log, add_json_channel("/log", "foxglove.Log", kLogSchema));
  TOUCHLINE_TRY_ASSIGN(channels_.packets, add_json_channel("/radio/packets", "touchline.Packets", kPacketsSchema));
  TOUCHLINE_TRY_ASSIGN(channels_.hello, add_json_channel(kHelloTopic, "touchline.Hello", kHelloSchema));
  TOUCHLINE_TRY_ASSIGN(channels_.events, add_json_channel(kEventTopic, "touchline.Event", kEventSchema));
  TOUCHLINE_TRY_ASSIGN(channels_.state, add_foxglove(console::FoxgloveChannel::kState));
  TOUCHLINE_TRY_ASSIGN(channels_.scene, add_foxglove(console::FoxgloveChannel::kScene));
  TOUCHLINE_TRY_ASSIGN(channels_.annotations, add_foxglove(console::FoxgloveChannel::kAnnotations));
  return {};
}

void RecordingWriter::add_bytes(std::uint16_t channel, std::uint64_t time_ns, std::string_view bytes) {
  file_.add({channel, sequence_, time_ns, {}}, {hal::mcap::bytes_of(bytes)});
}

template <class Write>
void RecordingWriter::add_json(std::uint16_t channel, std::uint64_t time_ns, const Write& write) {
  JsonWriter json(json_);
  write(json);
  if (json.fits()) add_bytes(channel, time_ns, {json_.data(), json.size()});
}

Result<void> RecordingWriter::add(const ConfigurationText& text) {
  if (!text.is_calibrated) hash_.leave_out(text.session);
  add_bytes(channels_.configuration, std::max(unix_now_ns(), last_time_ns_), encode(text));
  return flush();
}

void RecordingWriter::begin_session(std::shared_ptr<const console::Scene> scene) {
  scene_ = std::move(scene);
  const MarkerParameters& marker = scene_->configuration->pipeline.marker;
  events_.emplace(marker.field, marker.ball.radius_m);
  const std::uint64_t time_ns = std::max(unix_now_ns(), last_time_ns_);
  add_json(channels_.hello, time_ns, [&](JsonWriter& json) {
    console::write_hello(json, *scene_, false, 0, static_cast<double>(time_ns) * 1e-9);
  });
}

Result<void> RecordingWriter::add_line(std::string_view level, std::string_view line) {
  const std::uint64_t time_ns = unix_now_ns();
  constexpr std::uint64_t kSecond = 1'000'000'000;
  add_json(channels_.log, time_ns, [&](JsonWriter& json) {
    json.begin_object();
    json.key("timestamp");
    json.begin_object();
    json.key("sec");
    json.integer(static_cast<std::int64_t>(time_ns / kSecond));
    json.key("nsec");
    json.integer(static_cast<std::int64_t>(time_ns % kSecond));
    json.end_object();
    json.key("level");
    json.integer(log_level(level));
    json.key("message");
    json.string(line);
    json.key("name");
    json.string("touchline");
    json.key("file");
    json.string("");
    json.key("line");
    json.integer(0);
    json.end_object();
  });
  return {};
}

std::uint64_t RecordingWriter::time_of(Instant instant) {
  const Duration since = instant.time_since_epoch();
  if (parts_->header.session != time_session_) {
    time_session_ = parts_->header.session;
    unix_offset_ = Duration(static_cast<Duration::rep>(std::max(unix_now_ns(), last_time_ns_))) - since;
  }
  last_time_ns_ = std::max(last_time_ns_, static_cast<std::uint64_t>((since + unix_offset_).count()));
  if (counts_.steps == 0) first_time_ns_ = last_time_ns_;
  counts_.duration_ns = last_time_ns_ - first_time_ns_;
  return last_time_ns_;
}

Result<void> RecordingWriter::add_step(std::span<const std::byte> record) {
  StepParts& parts = *parts_;
  std::memcpy(&parts, record.data(), sizeof(StepParts));
  std::span<const std::byte> rest = record.subspan(sizeof(StepParts));
  const std::uint64_t time_ns = time_of(parts.inputs.now);
  ++sequence_;
  StepMessage& message = *message_;
  message.header = parts.header;
  message.inputs = parts.inputs;
  message.drives = parts.drives;
  if (parts.header.kind == StepKind::kFrame) {
    std::memcpy(snapshot_.get(), rest.data(), sizeof(Snapshot));
    rest = rest.subspan(sizeof(Snapshot));
    sightings_->ball = snapshot_->ball;
    sightings_->robots = snapshot_->robots;
    sightings_->cut_short = parts.header.was_cut_short;
    write_results(*sightings_, snapshot_->tracks, snapshot_->commands, parts.packets, message.results);
  } else {
    write_results(parts.packets, message.results);
  }
  message.state.assign(reinterpret_cast<const char*>(rest.data()), parts.state_bytes);
  rest = rest.subspan(parts.state_bytes);
  if (parts.header.picture != PictureKind::kNone) {
    write_picture_head(parts.header, time_ns, rest.size(), bytes_);
    const bool is_jpeg = parts.header.picture == PictureKind::kJpeg;
    file_.add({is_jpeg ? channels_.jpeg : channels_.raw, sequence_, time_ns, {}}, {hal::mcap::bytes_of(bytes_), rest});
    ++counts_.pictures;
  }
  encode(message, bytes_);
  add_bytes(channels_.step, time_ns, bytes_);
  if (events_) {
    const bool is_frame = parts.header.kind == StepKind::kFrame;
    add_events(is_frame ? events_->add(*snapshot_) : events_->add_stop(parts.inputs.halt), time_ns);
  }
  if (parts.header.kind == StepKind::kFrame) add_shown(*snapshot_, time_ns);
  add_packets(parts.packets, time_ns);
  if (hash_.covers(parts.header, !message.state.empty())) hash_.add(message.results);
  ++counts_.steps;
  return file_.chunk_bytes() >= hal::mcap::McapWriter::kChunkBytes ? flush() : Result<void>();
}

void RecordingWriter::add_shown(const Snapshot& snapshot, std::uint64_t time_ns) {
  if (!scene_) return;
  // With these times the messages have the time of the recording.
  Snapshot& shown = *snapshot_;
  shown.machine_sent = snapshot.sent;
  hal::UnixTimeOffset unix_time;
  unix_time.offset = unix_offset_;
  const console::Scene& scene = *scene_;
  const console::FoxgloveFrame frame{scene, shown, console::captured_unix_s(shown, unix_time)};
  add_json(channels_.state, time_ns,
           [&](JsonWriter& json) { console::write_state(json, scene, shown, ConsoleInput(), unix_time); });
  add_json(channels_.scene, time_ns, [&](JsonWriter& json) {
    // A viewer that jumps into the recording gets the field's lines within a second.
    constexpr std::uint64_t kFieldPeriod = 60;
    console::write_foxglove_scene(json, frame, shown.number % kFieldPeriod == 0);
  });
  add_json(channels_.annotations, time_ns,
           [&](JsonWriter& json) { console::write_foxglove_annotations(json, frame, 1); });
}

void RecordingWriter::add_events(const FrameEvents& events, std::uint64_t time_ns) {
  for (const GameEvent& event : events) {
    add_json(channels_.events, time_ns, [&](JsonWriter& json) { write_event(json, event); });
  }
}

void RecordingWriter::add_packets(const OutgoingPackets& packets, std::uint64_t time_ns) {
  if (packets.empty()) return;
  add_json(channels_.packets, time_ns, [&](JsonWriter& json) {
    json.begin_object();
    json.key("packets");
    json.begin_array();
    for (const OutgoingPacket& outgoing : packets) {
      json.begin_object();
      json.key("receiver");  // index in the team file's list of robots; the number after the last one: all robots
      json.integer(static_cast<std::int64_t>(outgoing.receiver));
      json.key("bytes");
      json.string(report::base64_of({outgoing.packet.data(), outgoing.packet.size()}));
      json.end_object();
    }
    json.end_array();
    json.end_object();
  });
}

Result<void> RecordingWriter::flush() {
  TOUCHLINE_TRY(file_.flush());
  counts_.bytes = file_.size();
  saved_counts_ = counts_;
  saved_hash_ = hash_;
  return {};
}

Result<void> RecordingWriter::save() {
  TOUCHLINE_TRY(flush());
  return file_.sync();
}

Result<void> RecordingWriter::close() {
  Result<void> flushed = flush();
  Result<void> closed = file_.close();
  return flushed.ok() ? closed : flushed;
}

}  // namespace touchline::recording
