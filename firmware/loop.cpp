#include "firmware/loop.h"

#include <algorithm>
#include <utility>

#include "hal/linux/monotonic_clock.h"

namespace touchline {
namespace {

using namespace std::chrono_literals;

// Number of stop packets at the end. If 3 % of the packets are lost, as users report, all five stop packets are lost
// once in 40 million cases.
constexpr int kFinalStops = 5;
constexpr Duration kFinalStopPause = 20ms;
// Time to wait until the last packets are sent. A packet of 63 bytes takes 0.53 s at 1200 baud, the slowest rate of a
// port.
constexpr Duration kDrainTime = 1s;

StopRuleSettings stop_rule_settings(const LoopSettings& settings) {
  const config::FaultSettings& faults = settings.faults;
  return {from_seconds(faults.stop_after_s),
          from_seconds(faults.radio_outage_s),
          faults.resume_after_emergency,
          settings.emergency_stop,
          settings.start_button,
          settings.held};
}

}  // namespace

Loop::Loop(const HalDevices& devices, Pipeline& pipeline, const LoopSettings& settings, ReportRing& reports,
           LoopObserver observer)
    : pipeline_(pipeline),
      settings_(settings),
      observer_(observer),
      devices_(devices),
      outputs_(devices_),
      rules_(stop_rule_settings(settings)),
      external_(settings.external),
      reports_(reports, settings.status_interval) {
  set_faults(settings.faults);
}

Loop::~Loop() { close(); }

void Loop::set_faults(const config::FaultSettings& faults) {
  settings_.faults = faults;
  const Duration stop_after = from_seconds(faults.stop_after_s);
  rules_.set_limits(stop_after, from_seconds(faults.radio_outage_s), faults.resume_after_emergency);
  devices_.set_first_pause(from_seconds(faults.reopen_after_s));
  // Polling is often enough for stop packets and the emergency stop, and seldom enough to leave the processor idle.
  poll_period_ = std::clamp<Duration>(stop_after / 4, 5ms, 50ms);
}

Result<void> Loop::open() {
  const Result<LoopDevices::OpenResults> opened =
      devices_.open(from_seconds(settings_.faults.reopen_after_s), settings_.awaited, settings_.former_pauses);
  if (!opened.ok()) return opened.error();
  const Instant now = devices_.clock().now();
  prepare_crash_stop(now);
  statistics_.begin = last_frame_ = last_packet_ = now;
  reports_.begin(now);
  for (const Device device : kDevices) {
    const Result<void>& result = opened.value()[static_cast<std::size_t>(device)];
    was_open_[static_cast<std::size_t>(device)] = result.ok();
    if (!result.ok()) report_fault(device, result.error(), reopening_action(device), now);
  }
  return {};
}

LoopEnd Loop::run(const std::atomic<bool>& stop) {
  std::optional<LoopEnd> end;
  try {
    while (!end) end = stop.load(std::memory_order_relaxed) ? LoopEnd::kRequested : iterate();
  } catch (...) {
    send_final_stops();
    throw;
  }
  send_final_stops();
  return *end;
}

std::optional<LoopEnd> Loop::iterate() {
  const Instant before = devices_.clock().now();
  check_inputs(before);
  serve_radio(before);
  wait_for_frame(before + std::min({poll_period_, input_due_, radio_due_}));
  const Instant now = devices_.clock().now();
  stop_if_due(now);
  receive_telemetry(now);
  reopen_lost_devices(now);
  update_status_light(now);
  const std::uint32_t stop_number = external_.stop_number(rules_);
  reports_.report_halt(rules_.halt(), stop_number, now);
  reports_.report_standing(now);
  reports_.report_status_if_due(statistics_, rules_.halt(), stop_number, pipeline_.adaptation(), now);
  note_live_settings();
  update_end(now);
  return end_;
}

void Loop::wait_for_frame(Instant deadline) {
  if (!devices_.is_open(Device::kCamera)) {
    devices_.clock().sleep_until(deadline);
    return;
  }
  const Result<hal::FrameLease> lease = devices_.camera().wait(deadline);
  if (lease.ok()) {
    process_frame(lease.value());
  } else if (lease.code() != ErrorCode::kTimeout) {
    on_fault(Device::kCamera, lease.error(), devices_.clock().now());
  }
  // A hanging camera reports no error, so the time without frames is limited.
  const Instant now = devices_.clock().now();
  const bool is_silent = now - last_frame_ > from_seconds(settings_.faults.camera_timeout_s);
  if (is_silent && devices_.is_open(Device::kCamera)) {
    report_fault(Device::kCamera, {ErrorCode::kTimeout, {}}, FaultAction::kReopen, now);
    devices_.mark_lost(Device::kCamera, now);
  }
}

void Loop::process_frame(const hal::FrameLease& lease) {
  Frame frame = lease.frame();
  if (observer_.on_received != nullptr) observer_.on_received(observer_.context);
  StepTiming timing;
  timing.received = devices_.clock().now();
  check_output(outputs_.set_strobe(true), timing.received);
  const Instant machine_received = hal::MonotonicClock::read();
  last_frame_ = timing.received;
  statistics_.frames_lost += frame_gaps_.lost_before(frame.sequence);
  // A frame cannot be captured after its arrival. A stamp in the future would make old commands look recent.
  if (frame.capture_time > timing.received) {
    frame.capture_time = timing.received;
    ++statistics_.future_stamps;
  }

  rules_.check_frame(frame.capture_time, timing.received);
  take_external_input(timing.received);
  const Duration to_wheels = latency_.value() + packet_time_ + settings_.radio_delay;
  note_jump(frame);
  fill_inputs(timing.received, std::clamp<Duration>(to_wheels, 0s, 1s));
  const StepTrace& trace = pipeline_.step(frame, inputs_);
  on_inputs_used(timing.received);
  rules_.apply_picture(trace.picture);
  // The emergency stop may have been pulled meanwhile.
  read_inputs(devices_.clock().now());
  if (!rules_.may_move() && !trace.commands.stop) pipeline_.revoke();
  send(trace.packets, trace.commands.stop, timing.received);
  timing.sent = devices_.clock().now();
  const Instant machine_sent = hal::MonotonicClock::read();
  timing.processing = machine_sent - machine_received;
  if (observer_.on_sent != nullptr) observer_.on_sent(observer_.context);
  check_output(outputs_.set_strobe(false), timing.sent);
  timing.latency = timing.received - frame.capture_time + timing.processing;

  external_.count_expired(trace.commands);
  ++statistics_.frames;
  statistics_.overloads += trace.overload ? 1 : 0;
  statistics_.runs_dropped += trace.runs_dropped;
  statistics_.regions_dropped += trace.regions_dropped;
  statistics_.latency.add(timing.latency);
  measure_latency(frame, timing);
  reports_.add_step(trace, timing.latency);
  const bool is_accepted = trace.status.ok() || trace.status == Status(ErrorCode::kFull);
  const bool is_picture_wanted = settings_.pictures != nullptr && settings_.pictures->is_wanted();
  // The findings are copied before the adaptation changes the tables with which this frame was classified.
  if (is_picture_wanted && is_accepted) settings_.pictures->put_findings(pipeline_, trace);
  adapt_to_light();
  reports_.report_drives(trace.drives, timing.sent);
  if (observer_.on_step != nullptr) observer_.on_step(observer_.context, trace, timing);
  // A frame that exceeds a capacity still gives partial results, which are better than none.
  if (is_accepted) {
    rules_.accept_frame(frame.capture_time, timing.received);
    if (timing.received - frame.capture_time <= from_seconds(settings_.faults.stop_after_s)) ++statistics_.good_frames;
  } else {
    on_fault(Device::kCamera, {trace.status.code(), "the pipeline rejected the frame"}, timing.sent);
  }
  if (settings_.snapshots != nullptr || settings_.recording != nullptr)
    fill_snapshot(trace, lease, timing, machine_sent);
  if (settings_.snapshots != nullptr) settings_.snapshots->write(snapshot_);
  // The picture follows the snapshot, so that whoever gets the picture also finds the results.
  if (is_picture_wanted) settings_.pictures->put(frame, settings_.first_number + statistics_.frames - 1);
  if (settings_.recording != nullptr) settings_.recording->add(pipeline_, trace, snapshot_, lease);
}

void Loop::fill_snapshot(const StepTrace& trace, const hal::FrameLease& lease, const StepTiming& timing,
                         Instant machine_sent) {
  copy_trace(trace, snapshot_);
  snapshot_.truth = lease.truth() != nullptr ? *lease.truth() : hal::TruePlaces();
  snapshot_.sent_commands = pipeline_.sent_commands();
  copy_bytes(trace, pipeline_.radio(), external_.console().tested, snapshot_);
  snapshot_.number = settings_.first_number + statistics_.frames - 1;
  snapshot_.received = timing.received;
  snapshot_.sent = timing.sent;
  snapshot_.machine_sent = machine_sent;
  snapshot_.latency = timing.latency;
  snapshot_.halt = rules_.halt();
  snapshot_.stop_number = external_.stop_number(rules_);
  snapshot_.is_held = rules_.is_held();
  snapshot_.referee = external_.referee();
  snapshot_.referee.score = score();
  snapshot_.referee.own_on_positive_half = external_.is_on_positive_half();
}

std::optional<Score> Loop::score() const {
  if (external_.referee().score || settings_.score.read == nullptr) return external_.referee().score;
  return settings_.score.read(settings_.score.context);
}

void Loop::measure_latency(const Frame& frame, const StepTiming& timing) {
  // The loop's clock measures the latency, so processing takes no time in simulated time.
  const Duration measured = std::max<Duration>(timing.sent - frame.capture_time, 0s);
  // Longer times are left out: so old a frame stops the robots anyway, and a single wrong stamp must not affect the
  // prediction.
  if (measured <= from_seconds(settings_.faults.stop_after_s)) latency_.add(measured);
}

void Loop::adapt_to_light() {
  if (settings_.adaptation != nullptr) {
    const AdaptationMode mode = pipeline_.adaptation();
    const AdaptationMode requested = adaptation_requests_.serve(*settings_.adaptation, mode);
    if (requested != mode) inputs_.events.adaptation_mode = requested;
  }
  pipeline_.adapt();
}

void Loop::take_external_input(Instant now) {
  external_.take(now, hal::MonotonicClock::read());
  external_.assign_teams(pipeline_);
  external_.apply_to(rules_, now, from_seconds(settings_.faults.referee_timeout_s));
  acknowledge_start();
}

void Loop::update_end(Instant now) {
  statistics_.end = now;
  statistics_.external = external_.counts();
  statistics_.source = devices_.camera().source_counters();
  statistics_.score = score();
  statistics_.own_on_positive_half = external_.is_on_positive_half();
  heartbeat_.good_frames.store(statistics_.good_frames, std::memory_order_relaxed);
  heartbeat_.iterations.fetch_add(1, std::memory_order_relaxed);
  const bool enough_frames = settings_.frames != 0 && statistics_.frames >= settings_.frames;
  const bool enough_time = settings_.duration != Duration::zero() && now - statistics_.begin >= settings_.duration;
  if (!end_ && (enough_frames || enough_time)) end_ = LoopEnd::kLimit;
  if (!end_ && settings_.restart != nullptr && settings_.restart->load(std::memory_order_relaxed)) {
    end_ = LoopEnd::kRestart;
  }
}

void Loop::check_inputs(Instant now) {
  const bool could_move = rules_.may_move();
  read_inputs(now);
  take_external_input(now);
  // The first stop packet must not wait for the next frame.
  if (could_move && !rules_.may_move()) send_stop(now);
}

void Loop::read_inputs(Instant now) {
  std::optional<hal::GpioInputs> inputs;
  if (devices_.is_open(Device::kGpio)) {
    const Result<hal::GpioInputs> read = devices_.gpio().inputs(now);
    if (read.ok()) {
      inputs = read.value();
    } else {
      on_fault(Device::kGpio, read.error(), now);
    }
  }
  input_due_ = inputs ? inputs->next_poll_in : Duration::max();
  if (inputs && inputs->start_pressed) external_.on_start();
  rules_.apply_inputs(inputs, now);
  acknowledge_start();
  check_radio(now);
}

void Loop::check_radio(Instant now) { rules_.apply_radio(radio_away(now)); }

std::optional<Duration> Loop::radio_away(Instant now) const {
  if (!devices_.is_open(Device::kRadio)) return devices_.time_lost(Device::kRadio, now);
  if (const std::optional<Instant> since = devices_.radio().partly_lost_since()) return now - *since;
  return std::nullopt;
}

void Loop::stop_if_due(Instant now) {
  rules_.check_last_frame(now);
  check_radio(now);
  if (!rules_.may_move() && now - last_packet_ >= poll_period_) send_stop(now);
}

void Loop::send_stop(Instant now) {
  fill_inputs(now, inputs_.action_delay);
  const OutgoingPackets& packets = pipeline_.stop(inputs_);
  if (observer_.on_stop != nullptr) observer_.on_stop(observer_.context, inputs_);
  if (settings_.recording != nullptr) settings_.recording->add_stop(pipeline_, inputs_, packets);
  on_inputs_used(now);
  send(packets, true, now);
}

void Loop::send(const OutgoingPackets& packets, bool is_stop, Instant now) {
  if (crash_stop::is_stopping()) return;  // another thread has crashed; its stop packets must be the last ones
  last_packet_ = now;
  note_times_on_line(packets);
  needs_final_stops_ = true;
  if (!devices_.is_open(Device::kRadio)) {
    ++statistics_.packets_refused;
    return;
  }
  prepare_crash_stop(now);  // with the number after this packet's
  if (packets.empty() && pipeline_.has_receivers()) {
    ++statistics_.packets_refused;
    on_fault(Device::kRadio,
             failure(ErrorCode::kFull, "the commands fit into no packet; see radio.field of the team file"), now);
  }
  for (const OutgoingPacket& outgoing : packets) {
    const Result<void> sent = devices_.radio().send(outgoing.packet, outgoing.receiver);
    const bool drops = sent.code() == ErrorCode::kBusy;
    if (sent.ok() || drops) {
      ++statistics_.packets;
      statistics_.stop_packets += is_stop ? 1 : 0;
      statistics_.packets_dropped += drops ? 1 : 0;
    } else {
      ++statistics_.packets_refused;
    }
    if (!sent.ok()) on_fault(Device::kRadio, sent.error(), now);
    if (!devices_.is_open(Device::kRadio)) return;
  }
}

void Loop::prepare_crash_stop(Instant now) {
  if (!devices_.is_open(Device::kRadio)) return crash_stop::prepare({});
  pipeline_.prepare_stop(now, stop_packets_);
  crash_stop::prepare(devices_.radio(), stop_packets_);
}

void Loop::serve_radio(Instant now) {
  radio_due_ = poll_period_;
  if (!devices_.is_open(Device::kRadio)) return;
  const Result<Duration> due = devices_.radio().serve();
  if (due.ok()) {
    radio_due_ = due.value();
  } else {
    on_fault(Device::kRadio, due.error(), now);
  }
  statistics_.packets_unreachable = devices_.radio().counters().unreachable;
  report_radio_ports(now);
}

void Loop::report_radio_ports(Instant now) {
  while (const std::optional<Error> event = devices_.radio().take_port_event()) {
    if (event->code != ErrorCode::kOk) {
      report_fault(Device::kRadio, *event, FaultAction::kReopen, now);
      continue;
    }
    ++statistics_.reopened[static_cast<std::size_t>(Device::kRadio)];
    if (devices_.radio().partly_lost_since()) continue;
    reports_.end_loss(Device::kRadio);
    report_fault(Device::kRadio, {ErrorCode::kOk, {}}, FaultAction::kNone, now);
  }
}

void Loop::send_final_stops() {
  for (int i = 0; i < kFinalStops; ++i) {
    Instant now = devices_.clock().now();
    const Instant next = now + kFinalStopPause;
    send_stop(now);
    // The loop repeats, because serve_radio() sends a packet that waits for the line.
    for (; now < next; now = devices_.clock().now()) {
      serve_radio(now);
      devices_.clock().sleep_until(now + std::min(next - now, radio_due_));
    }
  }
  needs_final_stops_ = false;
  if (!devices_.is_open(Device::kRadio)) return;
  const Instant now = devices_.clock().now();
  if (const Result<void> drained = devices_.radio().drain(now + kDrainTime); !drained.ok()) {
    report_fault(Device::kRadio, drained.error(), action_for(drained.code()), now);
  }
}

void Loop::close() {
  if (!devices_.are_open()) return;
  if (needs_final_stops_) send_final_stops();
  outputs_.switch_light_off();
  crash_stop::prepare({});
  devices_.close();
}

void Loop::update_status_light(Instant now) {
  check_output(outputs_.update_light(now - statistics_.begin, !rules_.may_move(), rules_.only_waits_for_start()), now);
}

void Loop::on_fault(Device device, const Error& error, Instant now) {
  if (error.code == ErrorCode::kEndOfStream) {
    end_ = LoopEnd::kEndOfStream;
    return;
  }
  const FaultAction action = is_required(device) ? action_for(error.code) : reopening_action(device);
  report_fault(device, error, action, now);
  if (action == FaultAction::kReopen || action == FaultAction::kContinueWithout) {
    if (device == Device::kRadio) crash_stop::prepare({});  // its descriptors will be closed
    devices_.mark_lost(device, now);
  }
  if (action == FaultAction::kLeave) end_ = LoopEnd::kFault;
}

void Loop::check_output(const Result<void>& result, Instant now) {
  if (result.ok()) return;
  if (!is_awaited(Device::kGpio)) return on_fault(Device::kGpio, result.error(), now);
  // Reopening the chip would interrupt the emergency stop and the start button, which still work or report their own
  // errors.
  outputs_.give_up();
  report_fault(Device::kGpio, result.error(), FaultAction::kContinueWithout, now);
}

bool Loop::is_lost_for_good(Device device, Duration away) const {
  const Duration limit = from_seconds(settings_.faults.leave_after_s);
  return was_open_[static_cast<std::size_t>(device)] && is_required(device) && limit > 0s && away > limit;
}

void Loop::reopen_lost_devices(Instant now) {
  for (const Device device : kDevices) {
    if (devices_.is_open(device)) continue;
    const std::optional<Result<void>> attempt = devices_.poll(device, now);
    if (attempt && attempt->ok()) {
      on_reopened(device, now);
    } else if (attempt) {
      // A failed attempt never ends the program, whatever the code: the device has worked with these settings and may
      // have been plugged in badly, or a person is choosing the settings.
      report_fault(device, attempt->error(), reopening_action(device), now);
    }
    if (is_lost_for_good(device, devices_.time_lost(device, now))) end_ = LoopEnd::kDeviceLost;
  }
  if (is_lost_for_good(Device::kRadio, radio_away(now).value_or(0s))) end_ = LoopEnd::kDeviceLost;
}

void Loop::on_reopened(Device device, Instant now) {
  ++statistics_.reopened[static_cast<std::size_t>(device)];
  const bool was_open = std::exchange(was_open_[static_cast<std::size_t>(device)], true);
  reports_.end_loss(device);
  if (is_awaited(device)) report_fault(device, {ErrorCode::kOk, {}}, FaultAction::kNone, now);
  switch (device) {
    case Device::kCamera:
      // Robots have moved meanwhile, and the driver restarts its frame numbers.
      inputs_.events.reset = true;
      frame_gaps_.restart();
      last_frame_ = now;
      if (!was_open && !end_) end_ = LoopEnd::kRestart;
      break;
    case Device::kGpio:
      outputs_.on_reopened();
      break;
    case Device::kRadio:
      inputs_.events.radio_opened = true;
      prepare_crash_stop(now);
      break;
  }
}

void Loop::report_fault(Device device, const Error& error, FaultAction action, Instant now) {
  const auto code = static_cast<std::size_t>(error.code);
  if (error.code != ErrorCode::kOk) ++statistics_.faults[static_cast<std::size_t>(device)][code];
  reports_.report_fault(device, error.code, action, error.text.view(), now);
}

}  // namespace touchline
