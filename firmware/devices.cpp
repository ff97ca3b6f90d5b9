#include "firmware/devices.h"

#include <algorithm>
#include <utility>

#include "firmware/arena_loop.h"
#include "firmware/null_devices.h"
#include "firmware/paced_clock.h"
#include "firmware/pose_plan.h"
#include "firmware/radio_group.h"
#include "firmware/remote_plan.h"
#include "hal/linux/gpio/gpiod_gpio.h"
#include "hal/linux/libcamera/libcamera_camera.h"
#include "hal/linux/monotonic_clock.h"
#include "hal/linux/network/frame_clock.h"
#include "hal/linux/network/pose_camera.h"
#include "hal/linux/network/remote_camera.h"
#include "hal/linux/serial/serial_radio.h"
#include "hal/linux/v4l2/v4l2_camera.h"
#include "hal/mock/arena.h"
#include "hal/mock/mock_devices.h"
#include "hal/replay/replay_camera.h"

namespace touchline {

Devices::Devices() = default;
Devices::~Devices() {
  if (objects_) objects_->detach();
}

void Devices::attach(std::shared_ptr<ArenaObjects> objects) {
  if (!objects || (!arena_ && !remote_arena_)) return;
  objects_ = std::move(objects);
  if (remote_arena_) return objects_->attach(*remote_arena_);
  objects_->attach(*arena_, colors_, time_control_);
}

std::unique_ptr<hal::Radio> Devices::make_radio(const PlannedRadio& radio) {
  switch (radio.settings.backend) {
    case hal::RadioBackend::kMock:
      return std::make_unique<hal::mock::MockRadio>(*arena_, *clock_);
    case hal::RadioBackend::kSerial:
      return std::make_unique<hal::SerialRadio>(radio.settings);
    case hal::RadioBackend::kUdp:
      return std::make_unique<hal::UdpRadio>(radio.udp);
    case hal::RadioBackend::kFirasim:  // config::use_simulator() has replaced them
    case hal::RadioBackend::kGrsim:
    case hal::RadioBackend::kNone:
      break;
  }
  return std::make_unique<NullRadio>();
}

Result<void> Devices::make(const config::Configuration& configuration, std::uint64_t seed, ArenaTime time) {
  const config::BoardFile& board = configuration.board;
  TOUCHLINE_TRY_ASSIGN(const std::vector<PlannedRadio> radios, plan_radios(configuration));
  const auto is_any_radio = [&](auto... backends) {
    return std::any_of(radios.begin(), radios.end(),
                       [&](const PlannedRadio& radio) { return ((radio.settings.backend == backends) || ...); });
  };
  const bool mock_camera = board.camera.backend == hal::CameraBackend::kMock;
  const bool mock_radio = is_any_radio(hal::RadioBackend::kMock);
  const bool mock_gpio = board.gpio.backend == hal::GpioBackend::kMock;
  const bool real_radio = is_any_radio(hal::RadioBackend::kSerial, hal::RadioBackend::kUdp);
  const bool real_gpio = board.gpio.backend == hal::GpioBackend::kGpiod;
  // Without real devices, the arena can have its own time; otherwise it follows the system clock.
  const bool alone = mock_camera && !real_radio && !real_gpio;
  simulated_time_ = alone && time != ArenaTime::kMachine;
  if (mock_camera || mock_radio || mock_gpio) {
    arena_ =
        std::make_unique<hal::mock::Arena>(board.arena, board.camera, board.radio, seed,
                                           simulated_time_ ? hal::mock::Arena::kBegin : hal::MonotonicClock::read());
    colors_ = team_colors(configuration);
    arena_->channel().set_layouts(configuration.pipeline.radio, configuration.pipeline.telemetry);
    TOUCHLINE_TRY_ASSIGN(opponents_, make_opponents(configuration, seed));
    arena_->game().set_side(hal::mock::Side::kOpponent, opponents_.side.get());
  }
  if (simulated_time_) {
    clock_ = std::make_unique<hal::mock::ArenaClock>(*arena_);
    time_control_ = ArenaTimeControl::kPause;
  } else {
    clock_ = std::make_unique<hal::MonotonicClock>();
  }
  hal::FrameClock* frame_clock = nullptr;
  if (board.camera.backend == hal::CameraBackend::kRemote && board.camera.lockstep) {
    auto clock = std::make_unique<hal::FrameClock>();
    frame_clock = clock.get();
    clock_ = std::move(clock);
    simulated_time_ = true;
  }
  if (simulated_time_ && time == ArenaTime::kPaced) {
    slowed_clock_ = std::move(clock_);
    clock_ = std::make_unique<PacedClock>(*slowed_clock_, arena_->pace());
    time_control_ = ArenaTimeControl::kSpeed;
  }
  hal::mock::RenderingClock* rendering = nullptr;
  if (alone && time == ArenaTime::kMachine) {
    slowed_clock_ = std::move(clock_);
    auto clock = std::make_unique<hal::mock::RenderingClock>(*slowed_clock_);
    rendering = clock.get();
    clock_ = std::move(clock);
  }
  switch (board.camera.backend) {
    case hal::CameraBackend::kMock:
      camera_ = std::make_unique<hal::mock::MockCamera>(*arena_, *clock_, rendering);
      break;
    case hal::CameraBackend::kV4l2:
      camera_ = std::make_unique<hal::V4l2Camera>(board.camera);
      break;
    case hal::CameraBackend::kLibcamera:
      camera_ =
          std::make_unique<hal::LibcameraCamera>(board.camera, board.realtime.priority, hal::make_libcamera_link());
      break;
    case hal::CameraBackend::kReplay:
      camera_ = std::make_unique<hal::ReplayCamera>(
          hal::ReplayParameters{board.camera.device, hal::pixel_format(board.camera.format), board.camera.rate_hz},
          clock_.get());
      break;
    case hal::CameraBackend::kPoses: {
      TOUCHLINE_TRY_ASSIGN(const hal::PoseCameraSettings settings, plan_poses(configuration));
      camera_ = std::make_unique<hal::PoseCamera>(settings);
      break;
    }
    case hal::CameraBackend::kRemote: {
      TOUCHLINE_TRY_ASSIGN(const hal::TcpAddress address, plan_remote(configuration));
      camera_ = std::make_unique<hal::RemoteCamera>(address, board.camera, frame_clock);
      TOUCHLINE_TRY_ASSIGN(remote_arena_, plan_arena_control(configuration));
      break;
    }
  }
  if (radios.size() == 1) {
    radio_ = make_radio(radios.front());
  } else {
    std::vector<GroupMember> members;
    members.reserve(radios.size());
    for (const PlannedRadio& radio : radios) members.push_back({make_radio(radio), radio.reaches});
    radio_ = std::make_unique<RadioGroup>(std::move(members), *clock_, from_seconds(board.faults.reopen_after_s),
                                          simulated_time_);
  }
  switch (board.gpio.backend) {
    case hal::GpioBackend::kMock:
      gpio_ = std::make_unique<hal::mock::MockGpio>(*arena_, *clock_, board.gpio);
      break;
    case hal::GpioBackend::kGpiod:
      gpio_ = std::make_unique<hal::GpiodGpio>(board.gpio);
      break;
    case hal::GpioBackend::kNone:
      gpio_ = std::make_unique<NullGpio>();
      break;
  }
  return {};
}

HalDevices Devices::hal_devices() { return {*camera_, *radio_, *gpio_, *clock_, simulated_time_}; }

ScoreSource Devices::score() const { return arena_ ? score_of(*arena_) : ScoreSource{}; }
JumpSource Devices::jumps() const { return arena_ ? jumps_of(*arena_) : JumpSource{}; }
RefereeSource Devices::referee() const { return arena_ ? referee_of(*arena_) : RefereeSource{}; }

std::string Devices::summary() const {
  if (!arena_) return {};
  return summary_of(*arena_);
}

}  // namespace touchline
