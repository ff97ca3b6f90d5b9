#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "firmware/devices.h"
#include "firmware/loop.h"
#include "firmware/status_text.h"

namespace touchline {

struct SessionOptions {
  config::FilePaths files;
  std::uint64_t seed = 1;
  std::uint64_t frames = 0;  // 0: no limit
  Duration duration{};       // 0: no limit
  Duration status_interval = std::chrono::seconds(1);
};

/// Everything that one run needs, built in the order in which it may fail: files, pipeline, devices. What touchline,
/// touchline-latency and viewers have in common.
class Session {
 public:
  /// Reads the files and configures the pipeline. Touches no device. kNotFound, kInconsistent: see `problems`.
  Status load(const SessionOptions& options, config::Problems& problems);
  /// Other limits than the options'; before open().
  void limit(std::uint64_t frames, Duration duration) {
    options_.frames = frames;
    options_.duration = duration;
  }
  /// Whoever may freeze the adaptation or put it back while the loop runs; before open().
  void steer_adaptation(const AdaptationRequests& requests) { adaptation_ = &requests; }
  /// By which somebody may change parameters while the loop runs (firmware/config_reloader.h).
  [[nodiscard]] LiveUpdate& live_update() { return live_update_; }
  /// Builds and opens the devices, after load(). On error `reason` names device and cause.
  Status open(LoopObserver observer, std::string& reason);

  [[nodiscard]] const config::FilePaths& files() const { return options_.files; }
  [[nodiscard]] const config::Configuration& configuration() const { return *configuration_; }
  [[nodiscard]] Devices& devices() { return devices_; }
  [[nodiscard]] Loop& loop() { return *loop_; }
  [[nodiscard]] ReportRing& reports() { return *reports_; }
  [[nodiscard]] Expectation expectation() const;
  /// What the camera granted, in a line; empty when it had nothing to be asked for.
  [[nodiscard]] const std::string& granted() const { return granted_; }
  /// What of it is not as asked; empty when nothing.
  [[nodiscard]] const std::string& grants() const { return grants_; }
  /// What the radio's port granted, and which input lines can only be looked at; empty when there is nothing to say.
  [[nodiscard]] const std::string& radio_grants() const { return radio_grants_; }
  [[nodiscard]] const std::string& gpio_grants() const { return gpio_grants_; }

 private:
  SessionOptions options_;
  const AdaptationRequests* adaptation_ = nullptr;
  LiveUpdate live_update_;
  // On the heap: megabytes.
  std::unique_ptr<config::Configuration> configuration_ = std::make_unique<config::Configuration>();
  std::unique_ptr<Pipeline> pipeline_ = std::make_unique<Pipeline>();
  std::unique_ptr<ReportRing> reports_ = std::make_unique<ReportRing>();
  Devices devices_;
  std::string granted_, grants_, radio_grants_, gpio_grants_;
  std::unique_ptr<Loop> loop_;  // last: it must go before the devices
};

}  // namespace touchline
