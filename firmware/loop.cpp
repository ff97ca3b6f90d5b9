#include "firmware/loop.h"

#include <algorithm>
#include <utility>

#include "hal/linux/monotonic_clock.h"

namespace touchline {
namespace {

using namespace std::chrono_literals;

// At 3 % lost packets (users report as much) that not one of five arrives happens once in 40 million times.
constexpr int kFinalStops = 5;
constexpr Duration kFinalStopPause = 20ms;
// 63 bytes at 1200 baud, the slowest port, take 0.53 s.
constexpr Duration kDrainTime = 1s;
// A switch's contacts bounce for some milliseconds; nobody releases and pulls again within a tenth of a second.
constexpr Duration kEmergencyReleaseTime = 100ms;
// The status light's periods.
constexpr Duration kBeat = 1s, kAlarmBeat = 200ms;
// Latency changes slowly; a single late frame must not move the prediction of the next ones.
constexpr int kLatencySmoothing = 16;

Status reopen_camera(void* device) {
  auto& camera = *static_cast<hal::Camera*>(device);
  camera.stop();
  camera.close();
  Status status = camera.open();
  if (!status.ok()) return status;
  status = camera.start();
  // Held open until the next attempt, its number would stay taken and its module could not be unloaded.
  if (!status.ok()) camera.close();
  return status;
}

template <class Device>
Status reopen(void* device) {
  static_cast<Device*>(device)->close();
  return static_cast<Device*>(device)->open();
}

// Often enough for stop packets and the emergency line, rarely enough to be idle.
Duration slice_of(Duration stop_after) { return std::clamp<Duration>(stop_after / 4, 5ms, 50ms); }

}  // namespace

Loop::Loop(const LoopDevices& devices, Pipeline& pipeline, const LoopSettings& settings, ReportRing& reports,
           LoopObserver observer)
    : devices_(devices),
      pipeline_(pipeline),
      settings_(settings),
      reports_(reports),
      observer_(observer),
      started_(!settings.start_button) {
  set_faults(settings.faults);
}

Loop::~Loop() { close(); }

void Loop::set_faults(const config::FaultSettings& faults) {
  settings_.faults = faults;
  stop_after_ = from_seconds(faults.stop_after_s);
  slice_ = slice_of(stop_after_);
  for (auto& reconnector : reconnectors_) {
    if (reconnector) reconnector->set_first_pause(from_seconds(faults.reopen_after_s));
  }
}

Status Loop::open(std::string& reason) {
  const auto refused = [&](Device device, Status status) {
    reason = std::string(touchline::describe(device)) + ": " + reason_of(device);
    devices_.camera.close();
    devices_.radio.close();
    devices_.gpio.close();
    return status;
  };
  // The radio first: whoever finds robots running can stop them.
  if (const Status s = devices_.radio.open(); !s.ok()) return refused(Device::kRadio, s);
  if (const Status s = devices_.gpio.open(); !s.ok()) return refused(Device::kGpio, s);
  if (const Status s = devices_.camera.open(); !s.ok()) return refused(Device::kCamera, s);
  if (const Status s = devices_.camera.start(); !s.ok()) return refused(Device::kCamera, s);
  is_open_ = true;

  const Duration pause = from_seconds(settings_.faults.reopen_after_s);
  const bool wait = devices_.simulated_time;
  reconnectors_[0].emplace(reopen_camera, &devices_.camera, pause, wait);
  reconnectors_[1].emplace(reopen<hal::Radio>, &devices_.radio, pause, wait);
  reconnectors_[2].emplace(reopen<hal::Gpio>, &devices_.gpio, pause, wait);

  const Instant now = devices_.clock.now();
  statistics_.begin = last_frame_ = last_packet_ = last_report_ = now;
  last_good_ = now - stop_after_ - Duration(1);  // nothing has been seen yet
  next_report_ = now + settings_.status_interval;
  return {};
}

LoopEnd Loop::run(const std::atomic<bool>& stop) {
  std::optional<LoopEnd> end;
  while (!end) end = stop.load(std::memory_order_relaxed) ? LoopEnd::kRequested : iterate();
  halt_robots();
  return *end;
}

std::optional<LoopEnd> Loop::iterate() {
  const Instant now = devices_.clock.now();
  serve_inputs(now);
  serve_radio(now);
  const Instant until = now + std::min({slice_, look_again_, send_again_});
  if (reconnector(Device::kCamera).is_open()) {
    const Result<hal::FrameLease> lease = devices_.camera.wait(until);
    if (lease.ok()) {
      serve_frame(lease.value());
    } else if (lease.error() != ErrorCode::kTimeout) {
      on_fault(Device::kCamera, lease.error(), devices_.clock.now());
    }
  } else {
    devices_.clock.sleep_until(until);
  }
  const Instant after = devices_.clock.now();
  // A camera that hangs says nothing: only the clock tells.
  if (reconnector(Device::kCamera).is_open() && after - last_frame_ > from_seconds(settings_.faults.camera_timeout_s)) {
    report_fault(Device::kCamera, ErrorCode::kTimeout, FaultAction::kReopen, after);
    reconnector(Device::kCamera).mark_lost(after);
  }
  update_halt(after, last_good_);
  if (halt_ != kHaltNone && after - last_packet_ >= slice_) send_stop(after);
  listen(after);
  serve_lost_devices(after);
  serve_light(after);
  report_if_due(after);
  take_live_settings();
  statistics_.end = after;
  heartbeat_.good_frames.store(statistics_.good_frames, std::memory_order_relaxed);
  heartbeat_.iterations.fetch_add(1, std::memory_order_relaxed);
  const bool enough_frames = settings_.frames != 0 && statistics_.frames >= settings_.frames;
  const bool enough_time = settings_.duration != Duration::zero() && after - statistics_.begin >= settings_.duration;
  if (!end_ && (enough_frames || enough_time)) end_ = LoopEnd::kLimit;
  return end_;
}

void Loop::serve_frame(const hal::FrameLease& lease) {
  const Frame& frame = lease.frame();
  StepTiming timing;
  timing.received = devices_.clock.now();
  strobe(true, timing.received);
  const Instant machine_received = hal::MonotonicClock::read();
  last_frame_ = timing.received;
  if (last_sequence_) statistics_.frames_lost += frame.sequence - *last_sequence_ - 1;
  last_sequence_ = frame.sequence;

  const Duration to_wheels = smoothed_latency_ + settings_.radio_delay;
  pipeline_.set_action_delay(std::clamp<Duration>(to_wheels, 0s, 1s));
  update_halt(timing.received, frame.capture_time);
  pipeline_.set_halted(halt_ != kHaltNone);
  const StepTrace& trace = pipeline_.step(frame);
  last_trace_ = &trace;
  // Pulled while the frame was awaited or worked on: its packet drives nobody.
  read_inputs(devices_.clock.now());
  if (halt_ != kHaltNone && !trace.commands.stop) pipeline_.revoke();
  send(trace.packet, trace.commands.stop, timing.received);
  timing.sent = devices_.clock.now();
  timing.processing = hal::MonotonicClock::read() - machine_received;
  strobe(false, timing.sent);
  timing.latency = timing.received - frame.capture_time + timing.processing;

  ++statistics_.frames;
  statistics_.overloads += trace.overload ? 1 : 0;
  statistics_.runs_dropped += trace.runs_dropped;
  statistics_.regions_dropped += trace.regions_dropped;
  note_latency(frame, timing);
  adapt();
  if (observer_.on_step != nullptr) observer_.on_step(observer_.context, trace, timing);
  // A frame that did not fit into the capacities was seen in part, which is better than not at all.
  if (trace.status.ok() || trace.status == Status(ErrorCode::kFull)) {
    last_good_ = std::max(last_good_, frame.capture_time);
    if (timing.received - frame.capture_time <= stop_after_) ++statistics_.good_frames;
  } else {
    on_fault(Device::kCamera, trace.status.code(), timing.sent);
  }
}

void Loop::adapt() {
  const auto asked = [](const std::atomic<std::uint32_t>& count, std::uint32_t& served) {
    const std::uint32_t now = count.load(std::memory_order_relaxed);
    return std::exchange(served, now) != now;
  };
  if (settings_.adaptation != nullptr) {
    const auto toggle = [this](AdaptationMode mode) {
      pipeline_.set_adaptation(pipeline_.adaptation() == mode ? AdaptationMode::kFollow : mode);
    };
    if (asked(settings_.adaptation->freeze, freezes_served_)) toggle(AdaptationMode::kFrozen);
    if (asked(settings_.adaptation->put_back, put_backs_served_)) toggle(AdaptationMode::kOff);
  }
  pipeline_.adapt();
}

void Loop::take_live_settings() {
  LiveSettings* live_settings = settings_.live_update != nullptr ? settings_.live_update->offered() : nullptr;
  if (live_settings == nullptr) return;
  if (live_settings->tables != nullptr) {
    if (live_settings->keep_adaptation_mode) live_settings->adaptation.set_mode(pipeline_.adaptation());
    live_settings->tables = &pipeline_.exchange(*live_settings->tables, live_settings->adaptation);
  }
  static_cast<void>(pipeline_.retune(live_settings->control));  // was checked with the files
  set_faults(live_settings->faults);
  settings_.radio_delay = live_settings->radio_delay;
  live_settings->taken_after = statistics_.frames;
  settings_.live_update->taken();
}

void Loop::note_latency(const Frame& frame, const StepTiming& timing) {
  statistics_.latency.add(timing.latency);
  interval_latency_.add(timing.latency);
  // Of the loop's clock alone: in simulated time the robots do not wait for this machine.
  const Duration measured = std::max<Duration>(timing.sent - frame.capture_time, 0s);
  smoothed_latency_ =
      latency_known_ ? smoothed_latency_ + (measured - smoothed_latency_) / kLatencySmoothing : measured;
  latency_known_ = true;
}

void Loop::send(const Packet& packet, bool is_stop, Instant now) {
  last_packet_ = now;
  if (!reconnector(Device::kRadio).is_open()) {
    ++statistics_.packets_refused;
    return;
  }
  const Status sent = devices_.radio.send(packet);
  const bool drops = sent == Status(ErrorCode::kBusy);
  if (sent.ok() || drops) {
    ++statistics_.packets;
    statistics_.stop_packets += is_stop ? 1 : 0;
    statistics_.packets_dropped += drops ? 1 : 0;
  } else {
    ++statistics_.packets_refused;
  }
  if (!sent.ok()) on_fault(Device::kRadio, sent.code(), now);
}

void Loop::serve_radio(Instant now) {
  send_again_ = slice_;
  if (!reconnector(Device::kRadio).is_open()) return;
  const Result<Duration> again = devices_.radio.serve();
  if (again.ok()) {
    send_again_ = again.value();
  } else {
    on_fault(Device::kRadio, again.error(), now);
  }
}

void Loop::listen(Instant now) {
  if (!settings_.telemetry || !reconnector(Device::kRadio).is_open()) return;
  const Result<std::size_t> count = devices_.radio.receive(received_);
  if (!count.ok()) {
    on_fault(Device::kRadio, count.error(), now);
  } else if (count.value() > 0) {
    pipeline_.listen(std::span(received_).first(count.value()), now);
    statistics_.robots = pipeline_.reports();
    report_batteries(now);
  }
}

void Loop::strobe(bool high, Instant now) {
  if (!outputs_work()) return;
  if (const Status s = devices_.gpio.set_strobe(high); !s.ok()) on_output_fault(s.code(), now);
}

void Loop::serve_light(Instant now) {
  if (!outputs_work()) return;
  const Duration half = halt_ == kHaltNone ? kBeat / 2 : kAlarmBeat / 2;
  const bool on = halt_ == kHaltStart || (now - statistics_.begin) / half % 2 == 0;
  if (led_ == on) return;
  led_ = on;
  if (const Status s = devices_.gpio.set_status_led(on); !s.ok()) on_output_fault(s.code(), now);
}

void Loop::send_stop(Instant now) { send(pipeline_.stop(now), true, now); }

void Loop::halt_robots() {
  for (int i = 0; i < kFinalStops; ++i) {
    Instant now = devices_.clock.now();
    const Instant next = now + kFinalStopPause;
    send_stop(now);
    // One that waits for the line must not wait longer.
    for (; now < next; now = devices_.clock.now()) {
      serve_radio(now);
      devices_.clock.sleep_until(now + std::min(next - now, send_again_));
    }
  }
  if (!reconnector(Device::kRadio).is_open()) return;
  const Instant now = devices_.clock.now();
  if (const Status drained = devices_.radio.drain(now + kDrainTime); !drained.ok()) {
    report_fault(Device::kRadio, drained.code(), action_for(drained.code()), now);
  }
}

void Loop::close() {
  if (!is_open_) return;
  is_open_ = false;
  for (auto& reconnector : reconnectors_) reconnector->stop();
  if (led_.value_or(false)) static_cast<void>(devices_.gpio.set_status_led(false));
  devices_.camera.stop();
  devices_.camera.close();
  devices_.radio.close();
  devices_.gpio.close();
}

void Loop::on_fault(Device device, ErrorCode code, Instant now) {
  if (code == ErrorCode::kEndOfStream) {
    end_ = LoopEnd::kEndOfStream;
    return;
  }
  const FaultAction unneeded = is_awaited(device) ? FaultAction::kReopen : FaultAction::kContinueWithout;
  const FaultAction action = is_needed(device) ? action_for(code) : unneeded;
  report_fault(device, code, action, now);
  if (action == FaultAction::kReopen || action == FaultAction::kContinueWithout) reconnector(device).mark_lost(now);
  if (action == FaultAction::kLeave) end_ = LoopEnd::kFault;
}

void Loop::on_output_fault(ErrorCode code, Instant now) {
  if (!is_awaited(Device::kGpio)) return on_fault(Device::kGpio, code, now);
  // Opening the chip again would take away the emergency stop or the start button, which still works or is about to
  // tell that it does not.
  outputs_failed_ = true;
  report_fault(Device::kGpio, code, FaultAction::kContinueWithout, now);
}

void Loop::serve_lost_devices(Instant now) {
  for (std::size_t i = 0; i < kDeviceCount; ++i) {
    const auto device = static_cast<Device>(i);
    DeviceReconnector& reconnector = *reconnectors_[i];
    if (reconnector.is_open()) continue;
    const std::uint32_t attempts = reconnector.failed_attempts();
    if (reconnector.poll(now)) {
      ++statistics_.reopened[i];
      if (is_awaited(device)) report_fault(device, ErrorCode::kOk, FaultAction::kNone, now);
      if (device == Device::kCamera) {
        // Robots moved unseen, and the driver counts its frames anew.
        pipeline_.reset();
        last_sequence_.reset();
        last_frame_ = now;
      }
      if (device == Device::kGpio) {
        led_.reset();
        outputs_failed_ = false;
      }
      continue;
    }
    if (reconnector.failed_attempts() != attempts) {
      // Not to leave, whatever the code: it did open with these settings, and who plugged it in badly may do so again.
      const FaultAction action = is_awaited(device) ? FaultAction::kReopen : FaultAction::kContinueWithout;
      report_fault(device, reconnector.last_status().code(), action, now);
    }
    const double patience_s = settings_.faults.leave_after_s;
    if (is_needed(device) && patience_s > 0.0 && reconnector.time_lost(now) > from_seconds(patience_s))
      end_ = LoopEnd::kDeviceLost;
  }
}

void Loop::serve_inputs(Instant now) {
  const std::uint8_t before = halt_;
  read_inputs(now);
  // The first stop must not wait for the next frame.
  if (before == kHaltNone && halt_ != kHaltNone) send_stop(now);
}

void Loop::read_inputs(Instant now) {
  // An emergency stop that cannot be read counts as pulled, with all that follows.
  hal::GpioInputs inputs;
  inputs.emergency_stop = settings_.emergency_stop;
  Halt emergency = kHaltLine;
  if (reconnector(Device::kGpio).is_open()) {
    const Result<hal::GpioInputs> read = devices_.gpio.inputs(now);
    if (read.ok()) {
      inputs = read.value();
      emergency = kHaltEmergency;
    } else {
      on_fault(Device::kGpio, read.error(), now);
    }
  }
  look_again_ = inputs.look_again;
  judge_emergency(inputs, now);
  const auto others = static_cast<std::uint8_t>(halt_ & kHaltNoFrames);
  halt_ =
      static_cast<std::uint8_t>(others | (emergency_ ? emergency : kHaltNone) | (started_ ? kHaltNone : kHaltStart));
}

void Loop::judge_emergency(const hal::GpioInputs& inputs, Instant now) {
  if (inputs.emergency_stop) {
    emergency_ = true;
    emergency_seen_ = now;
    restarted_ = false;
    return;
  }
  if (inputs.start_pressed) started_ = restarted_ = true;
  const bool may_resume = settings_.faults.resume_after_emergency || restarted_;
  if (may_resume && now - emergency_seen_ >= kEmergencyReleaseTime) emergency_ = false;
}

void Loop::update_halt(Instant now, Instant last_good) {
  const bool stale = now - last_good > stop_after_;
  const auto others = static_cast<std::uint8_t>(halt_ & ~kHaltNoFrames);
  halt_ = static_cast<std::uint8_t>(others | (stale ? kHaltNoFrames : kHaltNone));
}

}  // namespace touchline
