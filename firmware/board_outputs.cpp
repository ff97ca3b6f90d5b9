#include "firmware/board_outputs.h"

namespace touchline {
namespace {

// Periods of the status light.
constexpr Duration kBlinkPeriod = std::chrono::seconds(1), kAlarmBlinkPeriod = std::chrono::milliseconds(200);

}  // namespace

Result<void> BoardOutputs::set_strobe(bool high) {
  if (!work()) return {};
  return devices_.gpio().set_strobe(high);
}

Result<void> BoardOutputs::update_light(Duration since_begin, bool alarm, bool steady) {
  if (!work()) return {};
  const Duration half = (alarm ? kAlarmBlinkPeriod : kBlinkPeriod) / 2;
  const bool on = steady || since_begin / half % 2 == 0;
  if (light_ == on) return {};
  light_ = on;
  return devices_.gpio().set_status_led(on);
}

void BoardOutputs::switch_light_off() {
  if (!light_.value_or(false) || !devices_.is_open(Device::kGpio)) return;
  static_cast<void>(devices_.gpio().set_status_led(false));
}

void BoardOutputs::on_reopened() {
  light_.reset();
  failed_ = false;
}

}  // namespace touchline
