#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "hal/result.h"

namespace touchline::testing {

/// The mock board with its venue and team, whose pictures are RGB24.
inline config::FilePaths mock_files() { return {TOUCHLINE_BOARDS "/mock/board.toml", "", "", {}}; }

/// Runs the whole pipeline step for benchmarks, on about a second of a game in a board's mock arena (ten robots, ball,
/// uneven light, sensor noise) that is rendered beforehand.
class StepBenchmark {
 public:
  /// Plays the board's arena and stores `frames` pictures. Their number must be odd: each measured call follows an
  /// unmeasured one, and an even number would measure only every second frame. Returns an error if a frame does not
  /// show all robots.
  Result<void> prepare(const config::FilePaths& files, std::size_t frames = 49);

  /// Classifies and labels every row of the next frame; the time of this scan is the unit of the step's time. step()
  /// and scan_only() cycle through the frames independently.
  void scan_only();
  /// Runs the whole step on the next frame. After the last frame the tracks are reset.
  const StepTrace& step();

  [[nodiscard]] std::size_t frames() const { return pictures_.size(); }
  [[nodiscard]] const Frame& frame(std::size_t number) const { return pictures_[number].frame; }

 private:
  struct Picture {
    Frame frame;
    std::vector<std::uint8_t> bytes;
  };
  [[nodiscard]] static Picture copy_of(const Frame& frame);
  Result<void> play(std::size_t frames);

  std::unique_ptr<config::Configuration> configuration_ = std::make_unique<config::Configuration>();
  std::unique_ptr<Pipeline> pipeline_ = std::make_unique<Pipeline>();
  std::unique_ptr<RegionScanner> scanner_ = std::make_unique<RegionScanner>();
  std::unique_ptr<Runs> runs_ = std::make_unique<Runs>();
  std::unique_ptr<Regions> regions_ = std::make_unique<Regions>();
  StepInputs inputs_;
  std::vector<Picture> pictures_;
  std::size_t scanned_ = 0, stepped_ = 0;
};

}  // namespace touchline::testing
