#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "firmware/devices.h"
#include "firmware/loop.h"
#include "firmware/status_text.h"
#include "hal/linux/monotonic_clock.h"

namespace touchline {

struct SessionOptions {
  config::FilePaths files;
  std::uint64_t seed = 1;
  std::uint64_t frames = 0;  // 0: no limit
  Duration duration{};       // 0: no limit
  Duration status_interval = std::chrono::seconds(1);
  ArenaTime arena_time = ArenaTime::kFast;
};

/// A GPIO that passes its calls on to another GPIO.
class GpioProxy : public hal::Gpio {
 public:
  /// `gpio` and `clock`, which stamps its edges, must outlive this object's use.
  virtual void attach(hal::Gpio& gpio, hal::Clock& clock) = 0;
};

/// Everything that a run needs, created in this order: configuration, pipeline, devices. Used by touchline and
/// touchline-latency.
class Session {
 public:
  /// Reads the files and configures the pipeline. Touches no device. Errors of config::load().
  Result<void> load(const SessionOptions& options);
  /// Does the same as load() for a venue without camera model or colors: pictures are taken and stop packets are sent,
  /// but nothing is recognized and robots never move. All other errors of the files are reported as by load().
  Result<void> load_uncalibrated(const SessionOptions& options);
  /// Uses the files of `former` as they were read, without reading them again. Touches no device. Errors as load().
  Result<void> load_again(const Session& former);
  /// Declares that a draft is in use (SetupMode); call it after load() and before open().
  void set_draft() {
    is_draft_ = true;
    if (setup_ == SetupMode::kCalibrated) setup_ = SetupMode::kDraft;
  }
  [[nodiscard]] bool is_calibrated() const { return setup_ != SetupMode::kUncalibrated; }
  /// Sets the devices that may be absent at open(), see LoopSettings::awaited; call it before open().
  void await(const DeviceFlags& devices) { awaited_ = devices; }
  /// See LoopSettings::former_pauses; call it before open().
  void set_former_pauses(const LoopDevices::Pauses& pauses) { former_pauses_ = pauses; }
  /// The number of the order of the console that this session fulfills, see console::UseFiles; 0: none. Call it before
  /// open().
  void set_order(std::uint64_t number) { order_ = number; }
  [[nodiscard]] std::uint64_t order() const { return order_; }
  /// Ends the loop with LoopEnd::kRestart when it is set; call it before open().
  void set_restart(const std::atomic<bool>* restart) { restart_ = restart; }
  /// Sets the number of the first snapshot, so that the numbers of a run continue in its next session; call it before
  /// open().
  void set_first_number(std::uint64_t number) { first_number_ = number; }
  [[nodiscard]] std::uint64_t next_number() const { return first_number_ + loop_->statistics().frames; }
  [[nodiscard]] bool is_draft() const { return is_draft_; }
  /// Replaces the limits of the options; call it before open().
  void limit(std::uint64_t frames, Duration duration) {
    options_.frames = frames;
    options_.duration = duration;
  }
  /// Sets the requests to the adaptation while the loop runs; call it before open().
  void set_adaptation_requests(const AdaptationRequests& requests) { adaptation_ = &requests; }
  /// Sets the reasons for which robots wait for a start from the beginning; call it before open().
  void hold(const HeldStops& held) { held_ = held; }
  /// Sets the commands of other programs and the messages of a referee; call it before open().
  void set_external_input(const ExternalInputSettings& settings) { external_ = settings; }
  /// Sets how the time of a simulation passes; call it before open().
  void set_arena_time(ArenaTime time) { options_.arena_time = time; }
  /// Replaces the clock that measures the stages; call it before load().
  void set_stage_clock(Pipeline::StageClock clock) { stage_clock_ = clock; }
  /// Puts a device between the loop and the board's GPIO; it must outlive the loop. Call it before open().
  void set_gpio_proxy(GpioProxy& proxy) { gpio_proxy_ = &proxy; }
  /// Adds an LED to an arena's picture; call it after load() and before open().
  void set_arena_led(const hal::mock::ArenaLed& led) { configuration_->board.arena.led = led; }
  /// Sets the ring that gets a snapshot of every frame; null: none. Call it before open().
  void set_snapshots(SnapshotRing* snapshots) { snapshots_ = snapshots; }
  /// Sets the recording that gets every step; null: none. Call it before open().
  void set_recording(recording::StepTap* recording) { recording_ = recording; }
  /// Sets the input of the console, and the exchange for the pictures that it requests; call it before open().
  void set_console(ConsoleLink* link, PictureExchange* pictures) {
    console_ = link;
    pictures_ = pictures;
  }
  /// Sets the object that moves robots and ball of an arena; call it before open().
  void set_arena_objects(std::shared_ptr<ArenaObjects> objects) { arena_objects_ = std::move(objects); }
  /// Returns the LiveUpdate that passes new settings to the running loop (firmware/config_reloader.h).
  [[nodiscard]] LiveUpdate& live_update() { return live_update_; }
  /// Creates and opens the devices; call it after load().
  Result<void> open(LoopObserver observer);

  [[nodiscard]] const config::FilePaths& files() const { return options_.files; }
  [[nodiscard]] const config::Configuration& configuration() const { return *configuration_; }
  /// Returns the configuration for users that may outlive this object.
  [[nodiscard]] std::shared_ptr<const config::Configuration> shared_configuration() const { return configuration_; }
  [[nodiscard]] const SessionOptions& options() const { return options_; }
  [[nodiscard]] Devices& devices() { return devices_; }
  /// Returns whether open() could open all devices.
  [[nodiscard]] bool has_all_devices() const {
    return std::all_of(kDevices.begin(), kDevices.end(), [this](Device device) { return loop_->is_open(device); });
  }
  [[nodiscard]] Loop& loop() { return *loop_; }
  [[nodiscard]] ReportRing& reports() { return *reports_; }
  [[nodiscard]] Expectation expectation() const;
  /// Describes the camera as open() left it, or, if it is awaited, the camera that the board file asks for.
  [[nodiscard]] const hal::CameraInfo& camera_info() const { return camera_info_; }
  [[nodiscard]] const std::string& radio_description() const { return radio_description_; }
  [[nodiscard]] const std::string& gpio_description() const { return gpio_description_; }

 private:
  Result<void> configure_pipeline();

  SessionOptions options_;
  const AdaptationRequests* adaptation_ = nullptr;
  HeldStops held_;
  ExternalInputSettings external_;
  Pipeline::StageClock stage_clock_ = hal::MonotonicClock::read;
  SnapshotRing* snapshots_ = nullptr;
  recording::StepTap* recording_ = nullptr;
  GpioProxy* gpio_proxy_ = nullptr;
  ConsoleLink* console_ = nullptr;
  PictureExchange* pictures_ = nullptr;
  const std::atomic<bool>* restart_ = nullptr;
  std::shared_ptr<ArenaObjects> arena_objects_;
  std::uint64_t first_number_ = 0, order_ = 0;
  bool is_draft_ = false;
  DeviceFlags awaited_{};
  LoopDevices::Pauses former_pauses_{};
  SetupMode setup_ = SetupMode::kCalibrated;
  LiveUpdate live_update_;
  // On the heap, because they take megabytes.
  std::shared_ptr<config::Configuration> configuration_ = std::make_shared<config::Configuration>();
  std::unique_ptr<Pipeline> pipeline_ = std::make_unique<Pipeline>();
  std::unique_ptr<ReportRing> reports_ = std::make_unique<ReportRing>();
  Devices devices_;
  hal::CameraInfo camera_info_;
  std::string radio_description_, gpio_description_;
  std::unique_ptr<Loop> loop_;  // last, because it must be destroyed before the devices
};

}  // namespace touchline
