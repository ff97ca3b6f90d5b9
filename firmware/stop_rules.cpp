#include "firmware/stop_rules.h"

#include <algorithm>

namespace touchline {

void StopRules::set_limits(Duration stop_after, bool resume_after_emergency) {
  settings_.stop_after = stop_after;
  settings_.resume_after_emergency = resume_after_emergency;
}

void StopRules::apply_inputs(const std::optional<hal::GpioInputs>& inputs, Instant now) {
  hal::GpioInputs unreadable;
  unreadable.emergency_stop = settings_.has_emergency_stop;
  update_emergency(inputs.value_or(unreadable), now);
  std::uint16_t halt = halt_ & (kHaltNoFrames | kExternalHalts | kPictureHalts);
  if (emergency_) halt |= inputs ? kHaltEmergency : kHaltUnreadableLine;
  if (!started_) halt |= kHaltStart;
  if (settings_.hold_after_crash) halt |= kHaltCrash;
  halt_ = halt;
}

void StopRules::update_emergency(const hal::GpioInputs& inputs, Instant now) {
  if (inputs.emergency_stop) {
    emergency_ = true;
    emergency_seen_ = now;
    restarted_ = false;
    return;
  }
  if (inputs.start_pressed) {
    started_ = restarted_ = true;
    acknowledge();
    settings_.hold_after_crash = false;
  }
  const bool may_resume = settings_.resume_after_emergency || restarted_;
  if (may_resume && now - emergency_seen_ >= kEmergencyReleaseTime) emergency_ = false;
}

void StopRules::accept_frame(Instant capture_time, Instant now) {
  const Instant captured = std::min(capture_time, now);
  last_good_ = last_good_ ? std::max(*last_good_, captured) : captured;
}

void StopRules::apply_external(std::uint16_t reasons) {
  halt_ = static_cast<std::uint16_t>((halt_ & ~kExternalHalts) | (reasons & kExternalHalts));
}

void StopRules::apply_picture(const PictureTrace& picture) {
  if (picture.replays) unacknowledged_ |= kHaltRepeats;
  if (picture.contradicts) unacknowledged_ |= kHaltMotion;
  std::uint16_t reasons = unacknowledged_;
  if (picture.repeats) reasons |= kHaltRepeats;
  if (picture.overloads) reasons |= kHaltOverload;
  if (picture.hides_field) reasons |= kHaltField;
  halt_ = static_cast<std::uint16_t>((halt_ & ~kPictureHalts) | reasons);
}

void StopRules::set_stale(bool stale) {
  halt_ = static_cast<std::uint16_t>((halt_ & ~kHaltNoFrames) | (stale ? kHaltNoFrames : kHaltNone));
}

}  // namespace touchline
