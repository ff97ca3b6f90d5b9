#include "tools/programs/log/recorded_frame.h"

namespace touchline::log {

const std::string& RecordedFrame::color_of(Team team) const {
  const bool is_exchanged = output.own != network::published_scene(configuration).own;
  return (team == Team::kOwn) != is_exchanged ? configuration.team.own.color : configuration.team.opponent.color;
}

Result<void> RecordedFrames::take(const recording::ConfigurationText& text) {
  // Colors and field are those of the session: a reload changes neither.
  if (text.reload != 0) return {};
  is_calibrated_ = text.is_calibrated;
  if (!is_calibrated_) return {};
  TOUCHLINE_TRY_ASSIGN(loaded_, load_recorded(text));
  scene_ = network::published_scene(loaded_->configuration);
  return {};
}

Result<std::optional<RecordedFrame>> RecordedFrames::next() {
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<RecordedMessage> message, messages_.next());
    if (!message) return std::optional<RecordedFrame>();
    if (message->configuration != nullptr) {
      if (const Result<void> taken = take(*message->configuration); !taken.ok())
        return messages_.error_of(taken.error());
    }
    if (!message->is_frame() || !is_calibrated_) continue;
    if (loaded_ == nullptr) {
      return messages_.error_of(failure(ErrorCode::kInconsistent, "a step has no configuration"));
    }
    const recording::StepMessage& step = *message->step;
    if (const Result<void> decoded =
            recording::decode_results(step.results, *sightings_, snapshot_->tracks, snapshot_->commands);
        !decoded.ok()) {
      return messages_.error_of(decoded.error());
    }
    snapshot_->number = step.header.frame_number;
    snapshot_->frame_sequence = step.header.sequence;
    snapshot_->captured = step.header.captured;
    snapshot_->ball = sightings_->ball;
    snapshot_->robots = sightings_->robots;
    const double sent_s = static_cast<double>(message->message.time_ns) * 1e-9;
    output_.emplace(network::OutputFrame{*snapshot_, sent_s - seconds(step.inputs.now - step.header.captured), sent_s,
                                         scene_.own, scene_.camera_id, scene_.robot_height_m});
    const TeamAssignment& teams = step.inputs.teams;
    if (teams.colors_exchanged) output_->own = other(output_->own);
    for (std::size_t i = 0; i < teams.height_m.size(); ++i) {
      if (teams.height_m[i] > 0.0f) output_->robot_height_m[i] = teams.height_m[i];
    }
    return std::optional(RecordedFrame{*output_, snapshot_->commands, step.header.session,
                                       static_cast<std::int64_t>(message->message.time_ns), loaded_->configuration});
  }
}

}  // namespace touchline::log
