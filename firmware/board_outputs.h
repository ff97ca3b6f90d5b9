#pragma once

#include <optional>

#include "firmware/loop_devices.h"

namespace touchline {

/// Strobe and status light. They do nothing while the GPIO chip is lost, and after give_up() until it is reopened.
class BoardOutputs {
 public:
  explicit BoardOutputs(LoopDevices& devices) : devices_(devices) {}

  /// Error: that of the GPIO chip.
  Result<void> set_strobe(bool high);
  /// Blinks once a second, and five times a second if `alarm`; if `steady`, it stays on. Error: that of the GPIO chip.
  Result<void> update_light(Duration since_begin, bool alarm, bool steady);
  /// Ignores errors: the loop ends.
  void switch_light_off();

  void give_up() { failed_ = true; }
  void on_reopened();

 private:
  [[nodiscard]] bool work() const { return devices_.is_open(Device::kGpio) && !failed_; }

  LoopDevices& devices_;
  std::optional<bool> light_;  // as last set
  bool failed_ = false;
};

}  // namespace touchline
