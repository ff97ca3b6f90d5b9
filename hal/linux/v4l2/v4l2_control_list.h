#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "hal/linux/v4l2/v4l2_device.h"

namespace touchline::hal {

/// A control of a driver, with its range and current value.
struct V4l2ControlState {
  std::uint32_t id = 0;
  std::string name;
  std::string key;  // key of the board file that sets the control, "": none
  std::int64_t low = 0, high = 0, step = 1, default_value = 0, value = 0;
  bool readable = true;  // false: `value` is unknown
  bool read_only = false;
  bool inactive = false;  // the control has no effect because of another one, such as automatic exposure
  std::vector<std::pair<std::int64_t, std::string>> menu;  // values and their names
};

/// Returns all controls with integer values, including menus and switches, in the order of the driver.
std::vector<V4l2ControlState> list_controls(const V4l2Device& device);

}  // namespace touchline::hal
