#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"

namespace touchline::testing {

/// The whole way of a frame, for benchmarks: a second of a game on a board's arena (ten robots, ball, light that is not
/// even, the sensor's noise), drawn beforehand, and a pipeline that watches it as when it was played.
class StepSubject {
 public:
  /// `frames`: an odd number, so that of two calls in a row the second gets every frame in its turn.
  /// Empty when the board's arena could be played and every frame showed all of its robots; else what was wrong.
  std::string prepare(const std::string& board_file, std::size_t frames = 49);

  /// Classification and regions of the next frame. Each of the two goes through the frames on its own, again and again.
  void scan_only();
  /// Frame to packet. After the last frame the tracks are forgotten, and the second begins anew.
  const StepTrace& step();

 private:
  struct Picture {
    Frame frame;
    std::vector<std::uint8_t> bytes;
  };
  [[nodiscard]] static Picture copy_of(const Frame& frame);
  std::string play(std::size_t frames);

  std::unique_ptr<config::Configuration> configuration_ = std::make_unique<config::Configuration>();
  std::unique_ptr<Pipeline> pipeline_ = std::make_unique<Pipeline>();
  std::unique_ptr<RegionScanner> scanner_ = std::make_unique<RegionScanner>();
  std::unique_ptr<Runs> runs_ = std::make_unique<Runs>();
  std::unique_ptr<Regions> regions_ = std::make_unique<Regions>();
  std::vector<Picture> pictures_;
  std::size_t scanned_ = 0, stepped_ = 0;
};

}  // namespace touchline::testing
