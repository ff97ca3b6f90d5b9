#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "core/types.h"
#include "firmware/session.h"
#include "tools/programs/latency/led_analysis.h"

namespace touchline::latency {

/// Switches the line of the status light on and off at random times, and records the time of each edge. Meanwhile the
/// loop cannot switch this light; all its other lines work.
class LedBlinker final : public GpioProxy {
 public:
  LedBlinker() = default;
  ~LedBlinker() override { stop(); }
  LedBlinker(const LedBlinker&) = delete;
  LedBlinker& operator=(const LedBlinker&) = delete;

  void attach(hal::Gpio& gpio, hal::Clock& clock) override;
  /// Starts the thread; call it after open(). An edge follows the previous one after ten to eleven periods, so that
  /// edges fall evenly into all phases of a frame.
  void start(double rate_hz);
  void stop();
  /// Returns the edges in the order of time; call it after stop().
  [[nodiscard]] const std::vector<LedEdge>& edges() const { return edges_; }
  /// Returns the error of the line; empty if there was none.
  [[nodiscard]] const std::string& error() const { return error_; }
  [[nodiscard]] const std::string& description() const override { return gpio_->description(); }

 private:
  Result<void> do_open() override;
  void do_close() override;
  Result<void> do_set_status_led(bool) override { return {}; }
  Result<void> do_set_strobe(bool high) override;
  Result<hal::GpioInputs> do_inputs(Instant now) override;
  void run(Duration period, const std::stop_token& stop);

  hal::Gpio* gpio_ = nullptr;
  hal::Clock* clock_ = nullptr;
  std::mutex mutex_;  // a GPIO line belongs to one thread at a time
  std::vector<LedEdge> edges_;
  std::string error_;
  std::jthread thread_;
};

/// Records the brightness of a disc in each frame. Only the constructor allocates.
class LedWatch {
 public:
  /// `frames`: largest number of frames to record.
  LedWatch(const LedPlace& place, std::size_t frames);
  void add(const Frame& frame, Instant sent);
  [[nodiscard]] std::span<const LedFrame> frames() const { return std::span(frames_).first(count_); }

 private:
  LedPlace place_;
  std::vector<LedFrame> frames_;
  std::size_t count_ = 0;
};

}  // namespace touchline::latency
