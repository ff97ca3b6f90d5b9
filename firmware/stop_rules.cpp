#include "firmware/stop_rules.h"

#include <algorithm>

namespace touchline {

StopRules::StopRules(const StopRuleSettings& settings)
    : settings_(settings), held_(settings.held.reasons), held_number_(settings.held.number) {
  const bool waits_for_button = settings.has_start_button && !settings.held.is_started;
  held_ = static_cast<std::uint32_t>((held_ & ~kHaltStart) | (waits_for_button ? kHaltStart : kHaltNone));
  if (is_held()) ++held_number_;
}

void StopRules::set_limits(Duration stop_after, Duration radio_outage, bool resume_after_emergency) {
  settings_.stop_after = stop_after;
  settings_.radio_outage = radio_outage;
  settings_.resume_after_emergency = resume_after_emergency;
}

void StopRules::apply_inputs(const std::optional<hal::GpioInputs>& inputs, Instant now) {
  const bool is_pulled = inputs ? inputs->emergency_stop : settings_.has_emergency_stop;
  is_readable_ = inputs.has_value();
  if (is_pulled) {
    emergency_ = true;
    emergency_seen_ = now;
  } else if (now - emergency_seen_ >= kEmergencyReleaseTime) {
    emergency_ = false;
  }
  hold(kHaltEmergency, is_pulled && !settings_.resume_after_emergency);
  // While the switch is pulled, pressing the button has no effect.
  if (inputs && inputs->start_pressed && !is_pulled) start();
}

void StopRules::apply_external(std::uint32_t reasons) {
  set(kExternalHalts, false);
  set(reasons & kExternalHalts, true);
}

void StopRules::apply_radio(std::optional<Duration> away) {
  set(kHaltRadio, away.has_value());
  hold(kHaltRadio, away && *away > settings_.radio_outage);
}

void StopRules::hold(Halt reason, bool cause) {
  if (cause == ((causes_ & reason) != 0)) return;
  causes_ = static_cast<std::uint32_t>(causes_ ^ reason);
  held_ |= causes_;
  // The number changes when a cause ends, because an earlier start was meant for robots that could not move.
  // kHaltDriver is an exception: the start of a silent driver itself ends the silence.
  if (cause || reason != kHaltDriver) ++held_number_;
}

void StopRules::accept_frame(Instant capture_time, Instant now) {
  const Instant captured = std::min(capture_time, now);
  last_good_ = last_good_ ? std::max(*last_good_, captured) : captured;
}

std::uint32_t StopRules::halt() const {
  auto halt = static_cast<std::uint32_t>(lasting_ | held_ | (emergency_ ? kHaltEmergency : kHaltNone));
  if (is_readable_ || (halt & kHaltEmergency) == 0) return halt;
  return static_cast<std::uint32_t>((halt & ~kHaltEmergency) | kHaltUnreadableLine);
}

HeldStops StopRules::held() const {
  const auto reasons = static_cast<std::uint32_t>(held_ | (emergency_ ? kHaltEmergency : kHaltNone));
  return {reasons, held_number_, settings_.has_start_button && is_started()};
}

void StopRules::set(std::uint32_t reason, bool holds) {
  lasting_ = static_cast<std::uint32_t>(holds ? lasting_ | reason : lasting_ & ~reason);
}

void StopRules::start() {
  // The next frame shows whether the picture is still wrong.
  causes_ &= ~kPictureHalts;
  held_ &= causes_;
  was_started_ = true;
}

void StopRules::apply_picture(const PictureTrace& picture) {
  set(kHaltRepeats, picture.repeats);
  set(kHaltOverload, picture.overloads);
  set(kHaltField, picture.hides_field);
  hold(kHaltRepeats, picture.replays);
  hold(kHaltMotion, picture.contradicts);
}

}  // namespace touchline
