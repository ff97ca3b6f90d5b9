#pragma once

#include <memory>
#include <string>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "hal/result.h"
#include "tools/programs/calibrate/noise/noise_measurement.h"

namespace touchline::calibrate {

/// Runs the pipeline of a venue and a team file on frames of robots at rest, and measures their noise. The [noise]
/// section of the venue file has no effect, because only sightings are measured.
class NoiseRecorder {
 public:
  /// Errors of config::load_venue_and_team().
  Result<void> load(const std::string& venue, const std::string& team);
  /// Returns the color space that frames must have. Like all functions below, it may be called only after load().
  [[nodiscard]] ColorSpace color_space() const { return configuration_->venue.colors.space; }
  /// All frames must have the format and size of the first one; `source` names them in messages. Errors of
  /// config::resolve() and Pipeline::configure().
  Result<void> add(const Frame& frame, const std::string& source);
  /// As NoiseMeasurement::report(). If the ball was not measured, its value is that of the venue file.
  [[nodiscard]] Result<NoiseReport> report() const;
  /// Returns the former [noise] section of the venue file.
  [[nodiscard]] const config::NoiseEntry& before() const { return configuration_->venue.noise; }

 private:
  /// Shows the first picture until the pipeline has learned its light and the widths of its edges. If it learned them
  /// during the measurement, the changes would count as noise.
  void settle(const Frame& first);

  std::unique_ptr<config::Configuration> configuration_ = std::make_unique<config::Configuration>();
  std::unique_ptr<Pipeline> pipeline_;  // exists from the first frame on
  StepInputs inputs_ = observing_inputs();
  NoiseMeasurement measurement_;
};

}  // namespace touchline::calibrate
