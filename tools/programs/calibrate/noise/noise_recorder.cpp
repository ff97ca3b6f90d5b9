#include "tools/programs/calibrate/noise/noise_recorder.h"

#include <chrono>

namespace touchline::calibrate {

Result<void> NoiseRecorder::load(const std::string& venue, const std::string& team) {
  return config::load_venue_and_team({{}, venue, team, {}}, *configuration_);
}

Result<void> NoiseRecorder::add(const Frame& frame, const std::string& source) {
  if (!pipeline_) {
    TOUCHLINE_TRY(config::resolve({frame.format, frame.width_px, frame.height_px, source}, *configuration_));
    auto pipeline = std::make_unique<Pipeline>();
    if (const Status status = pipeline->configure(configuration_->pipeline); !status.ok()) {
      return failure(status.code(), "%s: venue and team file cannot be used together for it: %s", source.c_str(),
                     describe(status.code()));
    }
    pipeline_ = std::move(pipeline);
    settle(frame);
  }
  measurement_.add(pipeline_->step(frame, inputs_).sightings);
  pipeline_->adapt();
  return {};
}

void NoiseRecorder::settle(const Frame& first) {
  constexpr int kPictures = 200;
  constexpr Duration kPeriod = std::chrono::milliseconds(100);
  Frame frame = first;
  for (int before = kPictures; before > 0; --before) {
    frame.capture_time = first.capture_time - before * kPeriod;
    pipeline_->step(frame, inputs_);
    pipeline_->adapt();
  }
}

Result<NoiseReport> NoiseRecorder::report() const {
  TOUCHLINE_TRY_ASSIGN(NoiseReport out,
                       measurement_.report({configuration_->team.own.color, configuration_->team.opponent.color}));
  if (!out.has_ball) out.entry.ball_position_m = before().ball_position_m;
  return out;
}

}  // namespace touchline::calibrate
