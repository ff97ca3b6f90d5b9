#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "hal/linux/v4l2/v4l2_device.h"

namespace touchline::hal {

/// A control that a driver offers, as it is now.
struct V4l2ControlState {
  std::uint32_t id = 0;
  std::string name;
  std::string key;  // of the board file that sets it, "": none does
  std::int64_t low = 0, high = 0, step = 1, normal = 0, value = 0;
  bool readable = true;  // else `value` is unknown
  bool read_only = false;
  bool inactive = false;  // without effect while another one, such as an automatic, has its value
  std::vector<std::pair<std::int64_t, std::string>> menu;  // its values, where they have names
};

/// Those with numbers (also of menus and switches), in the driver's order.
std::vector<V4l2ControlState> list_controls(const V4l2Device& device);

}  // namespace touchline::hal
