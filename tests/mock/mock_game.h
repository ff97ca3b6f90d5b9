#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/arena_sides.h"
#include "firmware/config/configuration.h"
#include "firmware/loop.h"
#include "hal/mock/arena.h"
#include "hal/mock/mock_devices.h"
#include "tests/results.h"

namespace touchline {

/// Everything that a loop in the mock board's arena needs, built as by Session, but with access to the arena.
class MockGame {
 public:
  MockGame(std::uint64_t seed, std::vector<hal::mock::ArenaFault> faults, std::vector<std::string> overrides = {}) {
    EXPECT_OK(config::load({TOUCHLINE_BOARDS "/mock/board.toml", "", "", std::move(overrides)}, *configuration));
    config::BoardFile& board = configuration->board;
    board.arena.fault = std::move(faults);
    EXPECT_TRUE(pipeline->configure(configuration->pipeline).ok());
    arena.emplace(board.arena, board.camera, board.radio, seed);
    Result<ArenaOpponents> made = make_opponents(*configuration, seed);
    EXPECT_OK(made);
    if (made.ok()) opponents = std::move(made).value();
    arena->game().set_side(hal::mock::Side::kOpponent, opponents.side.get());
    clock.emplace(*arena);
    camera.emplace(*arena, *clock);
    radio.emplace(*arena, *clock);
    gpio.emplace(*arena, *clock);
  }

  [[nodiscard]] double now_s() const { return seconds(arena->now() - hal::mock::Arena::kBegin); }

  std::unique_ptr<config::Configuration> configuration = std::make_unique<config::Configuration>();
  std::unique_ptr<Pipeline> pipeline = std::make_unique<Pipeline>();
  std::unique_ptr<ReportRing> ring = std::make_unique<ReportRing>();
  ArenaOpponents opponents;
  std::optional<hal::mock::Arena> arena;
  std::optional<hal::mock::ArenaClock> clock;
  std::optional<hal::mock::MockCamera> camera;
  std::optional<hal::mock::MockRadio> radio;
  std::optional<hal::mock::MockGpio> gpio;

 protected:
  /// Returns the settings of the board file.
  [[nodiscard]] LoopSettings settings() const {
    const config::BoardFile& board = configuration->board;
    LoopSettings out;
    out.faults = board.faults;
    out.radio_delay = from_seconds(board.radio.delay_s);
    out.radio_byte_time = hal::byte_time(board.radio);
    return out;
  }
  /// Opens `loop`; declare it last, so that it is destroyed before the objects that it uses. The devices may be
  /// wrappers around those of the arena.
  void open(std::optional<Loop>& loop, hal::Camera& used_camera, hal::Radio& used_radio, hal::Gpio& used_gpio,
            const LoopSettings& settings, const LoopObserver& observer) {
    loop.emplace(HalDevices{used_camera, used_radio, used_gpio, *clock, true}, *pipeline, settings, *ring, observer);
    EXPECT_OK(loop->open());
  }
};

}  // namespace touchline
