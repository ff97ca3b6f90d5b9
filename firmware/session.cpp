#include "firmware/session.h"

#include <algorithm>

#include "firmware/config/uncalibrated.h"
#include "firmware/pose_plan.h"

namespace touchline {

Result<void> Session::load(const SessionOptions& options) {
  options_ = options;
  TOUCHLINE_TRY(config::load(options.files, *configuration_));
  return configure_pipeline();
}

Result<void> Session::load_uncalibrated(const SessionOptions& options) {
  options_ = options;
  setup_ = SetupMode::kUncalibrated;
  Result<void> loaded = config::load(options.files, *configuration_);
  if (!loaded.ok() && !config::lacks_calibration(*configuration_)) return loaded;
  config::do_without_calibration(*configuration_);
  return configure_pipeline();
}

Result<void> Session::load_again(const Session& former) {
  options_ = former.options_;
  setup_ = former.setup_;
  is_draft_ = former.is_draft_;
  *configuration_ = *former.configuration_;
  return configure_pipeline();
}

Result<void> Session::configure_pipeline() {
  if (const Status s = pipeline_->configure(configuration_->pipeline, stage_clock_); !s.ok()) {
    // The checks of the files have passed, so only the stage's error code is known.
    return failure(s.code(), "%s and %s cannot be used together: %s", configuration_->venue_where.file().c_str(),
                   configuration_->team_where.file().c_str(), describe(s.code()));
  }
  if (!configuration_->pipeline.has_pictures) TOUCHLINE_TRY(plan_poses(*configuration_));
  if (Result<std::vector<PlannedRadio>> radios = plan_radios(*configuration_); !radios.ok()) return radios.error();
  return {};
}

Result<void> Session::open(LoopObserver observer) {
  TOUCHLINE_TRY(devices_.make(*configuration_, options_.seed, options_.arena_time));
  devices_.attach(arena_objects_);
  const HalDevices made = devices_.hal_devices();
  if (gpio_proxy_ != nullptr) gpio_proxy_->attach(made.gpio, made.clock);
  hal::Gpio& gpio = gpio_proxy_ != nullptr ? *gpio_proxy_ : made.gpio;
  const HalDevices devices{made.camera, made.radio, gpio, made.clock, made.simulated_time};
  LoopSettings settings;
  settings.faults = configuration_->board.faults;
  settings.radio_delay = from_seconds(configuration_->board.radio.delay_s);
  settings.radio_line = hal::line_time(configuration_->board.radio);
  settings.status_interval = options_.status_interval;
  settings.frames = options_.frames;
  settings.duration = options_.duration;
  settings.adaptation = adaptation_;
  settings.telemetry = configuration_->board.radio.telemetry;
  settings.start_button = configuration_->board.gpio.start_line != hal::kNoLine;
  settings.emergency_stop = configuration_->board.gpio.emergency_stop_line != hal::kNoLine;
  settings.held = held_;
  settings.live_update = &live_update_;
  settings.external = external_;
  settings.external.console = console_;
  settings.external.setup = setup_;
  settings.external.own_on_positive_half = configuration_->team.half == config::Half::kPositive;
  settings.restart = restart_;
  settings.awaited = awaited_;
  settings.former_pauses = former_pauses_;
  settings.first_number = first_number_;
  settings.snapshots = snapshots_;
  settings.pictures = pictures_;
  settings.recording = recording_;
  settings.score = devices_.score();
  settings.jumps = devices_.jumps();
  settings.external.simulated_referee = devices_.referee();
  loop_ = std::make_unique<Loop>(devices, *pipeline_, settings, *reports_, observer);
  TOUCHLINE_TRY(loop_->open());
  if (loop_->is_open(Device::kCamera)) {
    camera_info_ = devices.camera.info();
  } else {
    const hal::CameraSettings& camera = configuration_->board.camera;
    camera_info_ = {hal::pixel_format(camera.format), camera.width_px, camera.height_px, camera.rate_hz};
    if (!configuration_->pipeline.has_pictures) camera_info_.width_px = camera_info_.height_px = 0;
  }
  if (loop_->is_open(Device::kRadio)) radio_description_ = devices.radio.description();
  if (loop_->is_open(Device::kGpio)) gpio_description_ = devices.gpio.description();
  return {};
}

Expectation Session::expectation() const {
  const auto count = [](const TeamMarking& team) -> std::uint32_t {
    if (team.team_color == kBackground) return 0;
    const auto robots = static_cast<std::uint32_t>(team.robots.size());
    return robots == 0 ? team.max_robots : std::min<std::uint32_t>(robots, team.max_robots);
  };
  const MarkerParameters& marker = configuration_->pipeline.marker;
  Expectation out{count(marker.teams[0]), count(marker.teams[1]), marker.field};
  if (!configuration_->pipeline.has_pictures) {
    out.source = hal::kPoseProtocolTable[static_cast<std::size_t>(configuration_->board.camera.poses)].word;
  }
  return out;
}

}  // namespace touchline
