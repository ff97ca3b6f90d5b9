// Fills the inputs of the pipeline's steps: values in force before each step, events when they happen.
#include "firmware/loop.h"

namespace touchline {

void Loop::fill_inputs(Instant now, Duration action_delay) {
  inputs_.now = now;
  inputs_.action_delay = action_delay;
  inputs_.radio_delay = settings_.radio_delay;
  inputs_.commands = external_.commands();
  inputs_.teams = external_.teams();
  inputs_.situation = external_.referee().situation();
  inputs_.halt = rules_.halt();
  inputs_.picture_check = {from_seconds(settings_.faults.stop_after_s), settings_.faults.unusable_frames};
}

void Loop::on_inputs_used(Instant now) {
  if (!inputs_.events.telemetry.empty()) {
    statistics_.robots = pipeline_.reports();
    reports_.report_batteries(statistics_.robots, now);
  }
  if (inputs_.events.control) {
    LiveSettings& settings = *settings_.live_update->offered();
    if (settings.tables != nullptr) settings.tables = pipeline_.released_tables();
    settings_.live_update->taken();
  }
  inputs_.events = {};
}

void Loop::note_live_settings() {
  LiveSettings* settings = settings_.live_update != nullptr ? settings_.live_update->offered() : nullptr;
  if (settings == nullptr || inputs_.events.control) return;
  if (settings->tables != nullptr) {
    if (settings->keep_adaptation_mode) settings->adaptation.set_mode(pipeline_.adaptation());
    inputs_.events.tables = settings->tables;
    inputs_.events.adaptation = &settings->adaptation;
  }
  inputs_.events.control = settings->control;  // checked when the files were read
  set_faults(settings->faults);
  settings_.radio_delay = settings->radio_delay;
  settings->taken_after = statistics_.frames;
}

void Loop::note_jump(const Frame& frame) {
  if (settings_.jumps.read == nullptr) return;
  const Instant jump = settings_.jumps.read(settings_.jumps.context);
  if (!last_jump_) last_jump_ = jump;
  if (jump == *last_jump_ || frame.capture_time < jump) return;
  last_jump_ = jump;
  inputs_.events.reset = true;
  inputs_.events.picture_acknowledged = true;
}

void Loop::acknowledge_start() {
  if (rules_.take_start()) inputs_.events.picture_acknowledged = true;
}

void Loop::note_times_on_line(const OutgoingPackets& packets) {
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const Duration line_time = settings_.radio_line.until_sent(packets, i);
    if (i == 0) packet_time_ = line_time;
    const std::size_t receiver = packets[i].receiver;
    if (receiver < inputs_.lateness.size()) inputs_.lateness[receiver] = line_time - packet_time_;
  }
}

void Loop::receive_telemetry(Instant now) {
  if (!settings_.telemetry || !devices_.is_open(Device::kRadio)) return;
  // What does not fit before the next step remains in the driver.
  auto& telemetry = inputs_.events.telemetry;
  auto& parts = inputs_.events.telemetry_parts;
  while (!telemetry.full() && !parts.full()) {
    const std::size_t former = telemetry.size();
    std::size_t sender = kAllRobots;
    telemetry.resize(kMaxTelemetryBytes);
    const Result<std::size_t> count =
        devices_.radio().receive(std::span(telemetry.data(), telemetry.size()).subspan(former), sender);
    telemetry.resize(former + (count.ok() ? count.value() : 0));
    if (!count.ok()) return on_fault(Device::kRadio, count.error(), now);
    if (count.value() == 0) return;
    parts.push_back({count.value(), sender});
    inputs_.events.telemetry_received = now;
  }
}

}  // namespace touchline
