#pragma once

#include <optional>

#include "firmware/loop_devices.h"

namespace touchline {

/// Sets the strobe and the status light. Does nothing while the GPIO chip is lost, and after give_up() until the chip
/// is reopened.
class BoardOutputs {
 public:
  explicit BoardOutputs(LoopDevices& devices) : devices_(devices) {}

  /// Errors: those of the GPIO chip.
  Result<void> set_strobe(bool high);
  /// Blinks once a second, or five times a second if `alarm`; if `steady`, the light stays on. Errors are those of the
  /// chip.
  Result<void> update_light(Duration since_begin, bool alarm, bool steady);
  /// Ignores errors, because the loop is about to end.
  void switch_light_off();

  void give_up() { failed_ = true; }
  void on_reopened();

 private:
  [[nodiscard]] bool work() const { return devices_.is_open(Device::kGpio) && !failed_; }

  LoopDevices& devices_;
  std::optional<bool> light_;  // state that was set last
  bool failed_ = false;
};

}  // namespace touchline
