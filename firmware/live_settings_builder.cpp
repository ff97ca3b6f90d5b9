#include "firmware/live_settings_builder.h"

#include <algorithm>

#include "firmware/config/configuration.h"
#include "firmware/config/reload.h"

namespace touchline {

Result<void> LiveSettingsBuilder::build(const config::Configuration& next, const config::ReloadChanges& changes) {
  settings_->tables = nullptr;
  settings_->control = next.pipeline.control;
  settings_->faults = next.board.faults;
  settings_->radio_delay = from_seconds(next.board.radio.delay_s);
  if (!changes.concern(Reload::kThresholds)) return {};
  if (unused_ == nullptr) {
    second_ = std::make_unique<ScanTables>();
    unused_ = second_.get();
  }
  const PipelineParameters& parameters = next.pipeline;
  const auto unusable = [&next](Status status) {
    return failure(status.code(), "%s: the new values cannot be used: %s", next.venue_where.file().c_str(),
                   describe(status.code()));
  };
  if (const Status s = unused_->configure(parameters.scan); !s.ok()) return unusable(s);
  settings_->tables = unused_;
  settings_->keep_adaptation_mode = std::none_of(
      changes.applied.begin(), changes.applied.end(),
      [](const auto& change) { return change.file == config::FileKind::kVenue && change.key == "adaptation.mode"; });
  const Status configured =
      settings_->adaptation.configure(parameters.adaptation, parameters.scan, parameters.marker.ball.color);
  if (!configured.ok()) return unusable(configured);
  return {};
}

}  // namespace touchline
