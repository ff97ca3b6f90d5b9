#include "tools/programs/replay/recording_source.h"

#include <algorithm>
#include <utility>

#include "firmware/config/reload.h"
#include "firmware/recording/picture_message.h"
#include "firmware/recording/pipeline_state.h"
#include "firmware/recording/recording_writer.h"

namespace touchline::replay {
namespace {

using recording::PictureKind;
using recording::ResultPart;
using recording::StepKind;

std::string frame_text(const recording::StepHeader& header) { return "frame " + std::to_string(header.frame_number); }
std::string step_text(const recording::StepHeader& header) {
  return header.kind == StepKind::kFrame ? frame_text(header) : "stop (step " + std::to_string(header.number) + ")";
}

// The pipeline exchanges the teams of foreign sightings as the referee has assigned the colors; the recorded ones are
// what it made of them.
void exchange_teams(Sightings& sightings) {
  for (RobotSighting& robot : sightings.robots) {
    robot.team = robot.team == Team::kOwn ? Team::kOpponent : Team::kOwn;
  }
}

}  // namespace

Result<void> RecordingSource::open(const std::string& path) {
  path_ = path;
  return reader_.open(path);
}

Result<std::optional<RecordingSource::Step>> RecordingSource::next() {
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<hal::mcap::Message> message, reader_.next());
    if (!message) {
      note_end();
      return std::optional<Step>();
    }
    const auto channel = reader_.channels().find(message->channel);
    if (channel == reader_.channels().end()) continue;
    const std::string& topic = channel->second.topic;
    if (topic == recording::kConfigurationTopic) {
      if (const Result<void> taken = take_configuration(message->data); !taken.ok()) return error_of(taken.error());
    } else if (topic == recording::kJpegTopic || topic == recording::kRawTopic) {
      picture_kind_ = topic == recording::kJpegTopic ? PictureKind::kJpeg : PictureKind::kRaw;
      const auto bytes = recording::picture_of(picture_kind_, message->data);
      if (!bytes) return error_of(failure(ErrorCode::kCorruptFrame, "a picture cannot be read"));
      picture_.assign(bytes->begin(), bytes->end());
      picture_sequence_ = message->sequence;
    } else if (topic == recording::kStepTopic) {
      if (message->sequence != picture_sequence_) picture_kind_ = PictureKind::kNone;
      Result<std::optional<Step>> step = run(message->data);
      if (!step.ok()) return error_of(step.error());
      if (step.value()) return step;
    }
  }
}

void RecordingSource::note_end() {
  if (reader_.is_damaged()) {
    notes_.push_back(path_ + ": the file is damaged at byte " + std::to_string(reader_.offset()) +
                     "; the replay ends before it");
  } else if (!reader_.is_complete()) {
    const std::string rest = reader_.rest() == 0 ? ""
                                                 : "; its last " + std::to_string(reader_.rest()) +
                                                       " bytes are no whole chunk and are left out";
    notes_.push_back(path_ + ": the recording was cut off" + rest);
  }
}

Result<void> RecordingSource::take_configuration(std::span<const std::byte> json) {
  TOUCHLINE_TRY_ASSIGN(const recording::ConfigurationText text,
                       recording::decode_configuration({reinterpret_cast<const char*>(json.data()), json.size()}));
  return text.reload == 0 ? begin_session(text) : prepare_reload(text);
}

Result<void> RecordingSource::begin_session(const recording::ConfigurationText& text) {
  session_ = text.session;
  is_calibrated_ = text.is_calibrated;
  prepared_reload_ = 0;
  applied_reload_.reset();
  next_number_ = 0;
  had_gap_ = was_restored_ = false;
  const std::string name = "session " + std::to_string(session_);
  if (!is_calibrated_) {
    notes_.push_back(name + " is not calibrated: nothing was recognized, and nothing is replayed");
    return {};
  }
  recording::TemporaryFiles files;
  TOUCHLINE_TRY(files.write(text));
  running_ = std::make_unique<config::Configuration>();
  TOUCHLINE_TRY(config::load(files.paths(overrides_), *running_));
  pipeline_ = std::make_unique<Pipeline>();
  live_settings_ = LiveSettingsBuilder();
  if (const Status s = pipeline_->configure(running_->pipeline); !s.ok()) {
    return failure(s.code(), "%s: the recorded files cannot be used together: %s", name.c_str(), describe(s.code()));
  }
  uses_pictures_ = running_->pipeline.has_pictures;
  notes_.push_back(name + ", recorded by touchline " + text.version +
                   (text.camera.empty() ? std::string() : ": " + text.camera));
  return {};
}

Result<void> RecordingSource::prepare_reload(const recording::ConfigurationText& text) {
  if (!is_calibrated_ || running_ == nullptr) return {};
  recording::TemporaryFiles files;
  TOUCHLINE_TRY(files.write(text));
  const auto read = std::make_unique<config::Configuration>();
  TOUCHLINE_TRY(config::load(files.paths(overrides_), *read));
  next_ = std::make_unique<config::Configuration>(*running_);
  TOUCHLINE_TRY_ASSIGN(const config::ReloadChanges changes, config::apply_reloadable(*read, *next_));
  TOUCHLINE_TRY(live_settings_.build(*next_, changes));
  prepared_reload_ = text.reload;
  std::string keys;
  for (const config::Change& change : changes.applied) keys += (keys.empty() ? "" : ", ") + change.key;
  notes_.push_back("reload " + std::to_string(text.reload) + ": " + keys);
  return {};
}

// Returns whether the settings of a reload apply from this step on.
Result<bool> RecordingSource::take_reload() {
  const recording::StepHeader& header = message_->header;
  // What begins in the middle of a session has the configuration that was in force there.
  const bool begins = !applied_reload_ && header.number > 0 && header.reload != prepared_reload_;
  if (begins) applied_reload_ = header.reload;
  if (header.reload == applied_reload_.value_or(0)) return false;
  if (header.reload != prepared_reload_) {
    return failure(ErrorCode::kInconsistent, "%s uses reload %u, whose files are not recorded",
                   frame_text(header).c_str(), header.reload);
  }
  StepEvents& events = message_->inputs.events;
  LiveSettings& settings = live_settings_.settings();
  events.control = settings.control;
  if (settings.tables != nullptr) {
    if (settings.keep_adaptation_mode) settings.adaptation.set_mode(pipeline_->adaptation());
    events.tables = settings.tables;
    events.adaptation = &settings.adaptation;
  }
  return true;
}

void RecordingSource::finish_reload() {
  LiveSettings& settings = live_settings_.settings();
  if (settings.tables != nullptr) settings.tables = pipeline_->released_tables();
  live_settings_.on_taken();
  running_ = std::move(next_);
  applied_reload_ = std::exchange(prepared_reload_, 0);
}

void RecordingSource::note_gap() {
  const recording::StepHeader& header = message_->header;
  if (header.number != next_number_) {
    had_gap_ = true;
    message_->inputs.events.reset = true;
    const std::uint64_t lost = header.number - next_number_;
    notes_.push_back(step_text(header) + ": " + std::to_string(lost) + (lost == 1 ? " step" : " steps") +
                     " before it not recorded: tracks begin anew, and nothing is compared until a state is recorded");
  }
  next_number_ = header.number + 1;
}

// After a gap, continues with the state after this step.
Result<void> RecordingSource::restore_state() {
  if (!had_gap_ || message_->state.empty()) return {};
  TOUCHLINE_TRY(recording::read_state(std::as_bytes(std::span(message_->state)), *pipeline_));
  had_gap_ = false;
  was_restored_ = true;
  uses_pictures_ = false;
  notes_.push_back(step_text(message_->header) +
                   ": its state is recorded: from the next step on, the replay continues with it, uses the recorded "
                   "sightings and compares");
  return {};
}

// Returns whether the frame has its picture.
Result<bool> RecordingSource::decode_picture(Frame& frame) {
  const recording::StepHeader& header = message_->header;
  if (header.picture == PictureKind::kNone || header.picture != picture_kind_) return false;
  const bool is_jpeg = header.picture == PictureKind::kJpeg;
  // The file may be damaged or hostile, and the pictures' memory follows from these values.
  const ScanParameters& scan = running_->pipeline.scan;
  if (frame.format != scan.format || frame.width_px != scan.width_px || frame.height_px != scan.height_px ||
      (is_jpeg && frame.format != PixelFormat::kYuvj422p)) {
    return failure(ErrorCode::kCorruptFrame, "%s: its picture has another format or size than its session",
                   frame_text(header).c_str());
  }
  const std::uint8_t* begin = reinterpret_cast<const std::uint8_t*>(picture_.data());
  PictureLayout layout = picture_layout(frame.format, frame.width_px, frame.height_px);
  if (is_jpeg) {
    if (decoder_width_px_ != frame.width_px || decoder_height_px_ != frame.height_px) {
      decoder_.open(frame.width_px, frame.height_px);
      decoder_width_px_ = frame.width_px;
      decoder_height_px_ = frame.height_px;
    }
    layout = decoder_.layout();
    decoded_.resize(layout.bytes);
    const Result<void> decoded = decoder_.decode({begin, picture_.size()}, decoded_.data());
    if (!decoded.ok()) return prefixed(frame_text(header), decoded.error());
    begin = decoded_.data();
  } else if (picture_.size() != layout.bytes) {
    return failure(ErrorCode::kCorruptFrame, "%s: its picture has %zu bytes instead of %zu", frame_text(header).c_str(),
                   picture_.size(), layout.bytes);
  }
  for (std::size_t i = 0; i < info_of(frame.format).planes; ++i) frame.plane[i] = begin + layout.offset_bytes[i];
  frame.stride_bytes = layout.stride_bytes;
  return true;
}

Result<void> RecordingSource::fill_frame(Frame& frame) {
  const recording::StepHeader& header = message_->header;
  frame.format = header.format;
  frame.width_px = header.width_px;
  frame.height_px = header.height_px;
  frame.sequence = header.sequence;
  frame.capture_time = header.captured;
  TOUCHLINE_TRY_ASSIGN(const bool has_picture, decode_picture(frame));
  if (uses_pictures_ && !has_picture) {
    uses_pictures_ = false;
    notes_.push_back(frame_text(header) +
                     ": its picture was not recorded: from here on the replay uses the recorded sightings");
  }
  if (uses_pictures_) return {};
  TOUCHLINE_TRY(recording::decode_sightings(message_->results, *sightings_));
  if (message_->inputs.teams.colors_exchanged) exchange_teams(*sightings_);
  frame.sightings = sightings_.get();
  message_->inputs.was_unusable = header.is_unusable;
  return {};
}

Result<std::optional<RecordingSource::Step>> RecordingSource::run(std::span<const std::byte> bytes) {
  TOUCHLINE_TRY(recording::decode(bytes, *message_));
  const recording::StepHeader& header = message_->header;
  if (header.session == session_ && !is_calibrated_) return std::optional<Step>();
  if (header.session != session_ || pipeline_ == nullptr) {
    return failure(ErrorCode::kInconsistent, "the configuration of session %u is not recorded", header.session);
  }
  const bool had_steps = header.number == next_number_;
  note_gap();
  TOUCHLINE_TRY_ASSIGN(const bool reloads, take_reload());
  if (reloads && !had_steps) {
    notes_.push_back(frame_text(header) + ": reload " + std::to_string(header.reload) +
                     " took effect in a step that was not recorded; it takes effect here");
  }
  if (was_restored_) message_->inputs.drives = message_->drives;
  Step step{header};
  step.is_compared = !had_gap_;
  if (header.kind == StepKind::kFrame) {
    Frame frame;
    TOUCHLINE_TRY(fill_frame(frame));
    const StepTrace& trace = pipeline_->step(frame, message_->inputs);
    if (header.revoked) pipeline_->revoke();
    seen_->ball = trace.sightings.ball;
    seen_->robots = trace.sightings.robots;
    seen_->cut_short = trace.sightings.cut_short;
    recording::write_results(*seen_, trace.tracks, trace.commands, trace.packets, results_);
    pipeline_->adapt();
    step.trace = &trace;
    step.has_picture = frame.plane[0] != nullptr;
  } else {
    recording::write_results(pipeline_->stop(message_->inputs), results_);
  }
  if (reloads) finish_reload();
  TOUCHLINE_TRY(restore_state());
  if (hash_.covers(header, !message_->state.empty())) hash_.add(results_);
  for (std::size_t i = 0; i < recording::kResultParts; ++i) step.differs[i] = results_[i] != message_->results[i];
  return std::optional(step);
}

}  // namespace touchline::replay
