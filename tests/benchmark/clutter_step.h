#pragma once

#include <memory>
#include <string>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "hal/result.h"
#include "tests/benchmark/clutter_teams.h"
#include "tests/benchmark/measurement.h"
#include "tests/color/owned_picture.h"
#include "tools/programs/latency/clutter_picture.h"

namespace touchline::testing {

// Suffix of the name of cases with ClutterTeams::kLargest.
inline constexpr char kLargestTeams[] = ", 22 robots of six patches";

/// Runs the whole pipeline step repeatedly on one cluttered picture, with the venue of the mock board.
class ClutterStep {
 public:
  Result<void> configure(const config::FilePaths& files, ClutterTeams teams);
  void show(const latency::ClutterRecipe& recipe);
  /// Returns the next frame, which shows the same picture.
  Frame next_frame();
  const StepTrace& step();
  [[nodiscard]] const PipelineParameters& parameters() const { return configuration_->pipeline; }

 private:
  std::unique_ptr<config::Configuration> configuration_ = std::make_unique<config::Configuration>();
  std::unique_ptr<Pipeline> pipeline_ = std::make_unique<Pipeline>();
  StepInputs inputs_;
  CameraModel camera_;
  OwnedPicture picture_{PixelFormat::kRgb24, 1, 1, 0};
  std::uint32_t frames_ = 0;
};

/// Adds one case for each picture of latency::worst_clutter() and both teams whose name contains `filter`: "step, ...".
Result<void> add_clutter_cases(BenchmarkCases& cases, const std::string& filter);

/// Searches for the picture with the slowest step for `seconds`, and prints its recipe, for latency::worst_clutter().
Result<void> search_slowest_step(double seconds, unsigned seed, ClutterTeams teams);

}  // namespace touchline::testing
