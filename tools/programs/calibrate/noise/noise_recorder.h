#pragma once

#include <memory>
#include <string>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "hal/result.h"
#include "tools/programs/calibrate/noise/noise_measurement.h"

namespace touchline::calibrate {

/// Runs the pipeline of a venue and a team file on frames of standing robots, and measures their noise. The file's own
/// [noise] does not matter, because only sightings are measured.
class NoiseRecorder {
 public:
  /// Errors of config::load_venue_and_team().
  Result<void> load(const std::string& venue, const std::string& team);
  /// Only after load(), as all others. The color space that frames must have.
  [[nodiscard]] ColorSpace color_space() const { return configuration_->venue.colors.space; }
  /// All frames must have the format and size of the first one; `source` names them in messages. Errors of
  /// config::resolve() and Pipeline::configure().
  Result<void> add(const Frame& frame, const std::string& source);
  /// As NoiseMeasurement::report(). If the ball was not measured, its value is that of the venue file.
  [[nodiscard]] Result<NoiseReport> report() const;
  /// [noise] of the venue file.
  [[nodiscard]] const config::NoiseEntry& before() const { return configuration_->venue.noise; }

 private:
  /// Shows the first picture until the pipeline has learned its light and the widths of its edges: what it learns while
  /// it measures would count as noise.
  void settle(const Frame& first);

  std::unique_ptr<config::Configuration> configuration_ = std::make_unique<config::Configuration>();
  std::unique_ptr<Pipeline> pipeline_;  // from the first frame on
  NoiseMeasurement measurement_;
};

}  // namespace touchline::calibrate
