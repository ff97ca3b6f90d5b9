#include "hal/linux/v4l2/v4l2_control_list.h"

#include <linux/videodev2.h>

#include <algorithm>

namespace touchline::hal {
namespace {

// Limit for drivers whose lists never end; the kernel defines a few hundred controls.
constexpr int kMaxControls = 512;
constexpr std::int64_t kMaxMenuItems = 64;

const char* key_of(std::uint32_t id) {
  switch (id) {
    case V4L2_CID_EXPOSURE_AUTO_PRIORITY:
      return "rate_hz";
    case V4L2_CID_EXPOSURE_AUTO:
    case V4L2_CID_EXPOSURE_ABSOLUTE:
      return "exposure_us";
    case V4L2_CID_EXPOSURE:
      return "exposure_steps";
    case V4L2_CID_AUTOGAIN:
    case V4L2_CID_GAIN:
    case V4L2_CID_ANALOGUE_GAIN:
      return "gain";
    case V4L2_CID_AUTO_WHITE_BALANCE:
    case V4L2_CID_WHITE_BALANCE_TEMPERATURE:
    case V4L2_CID_RED_BALANCE:
    case V4L2_CID_BLUE_BALANCE:
      return "white_balance_k";
    case V4L2_CID_FOCUS_AUTO:
    case V4L2_CID_FOCUS_ABSOLUTE:
      return "focus";
    case V4L2_CID_POWER_LINE_FREQUENCY:
      return "power_line";
    default:
      return "";
  }
}

bool is_number(const v4l2_queryctrl& query) {
  const std::uint32_t type = query.type;
  // A 64-bit value, but not an array.
  if (type == V4L2_CTRL_TYPE_INTEGER64) return (query.flags & V4L2_CTRL_FLAG_HAS_PAYLOAD) == 0;
  return type == V4L2_CTRL_TYPE_INTEGER || type == V4L2_CTRL_TYPE_BOOLEAN || type == V4L2_CTRL_TYPE_MENU ||
         type == V4L2_CTRL_TYPE_INTEGER_MENU || type == V4L2_CTRL_TYPE_BITMASK;
}

void list_menu(const V4l2Device& device, std::uint32_t type, V4l2ControlState& control) {
  if (type != V4L2_CTRL_TYPE_MENU && type != V4L2_CTRL_TYPE_INTEGER_MENU) return;
  const std::int64_t last = std::min(control.high, control.low + kMaxMenuItems - 1);
  for (std::int64_t i = std::max<std::int64_t>(control.low, 0); i <= last; ++i) {
    v4l2_querymenu item{};
    item.id = control.id;
    item.index = static_cast<std::uint32_t>(i);
    if (device.request(VIDIOC_QUERYMENU, &item) != 0) continue;  // menus may have gaps
    control.menu.emplace_back(
        i, type == V4L2_CTRL_TYPE_MENU ? reinterpret_cast<const char*>(item.name) : std::to_string(item.value));
  }
}

bool read(const V4l2Device& device, V4l2ControlState& control) {
  v4l2_control current{control.id, 0};
  if (device.request(VIDIOC_G_CTRL, &current) != 0) return false;
  control.value = current.value;
  return true;
}

/// Reads range and value of a 64-bit control, which needs the extended requests.
bool read_wide(const V4l2Device& device, V4l2ControlState& control) {
  v4l2_query_ext_ctrl query{};
  query.id = control.id;
  if (device.request(VIDIOC_QUERY_EXT_CTRL, &query) == 0) {
    control.low = query.minimum;
    control.high = query.maximum;
    control.step = static_cast<std::int64_t>(query.step);
    control.default_value = query.default_value;
  }
  v4l2_ext_control current{};
  current.id = control.id;
  v4l2_ext_controls request{};
  request.which = V4L2_CTRL_WHICH_CUR_VAL;
  request.count = 1;
  request.controls = &current;
  if (device.request(VIDIOC_G_EXT_CTRLS, &request) != 0) return false;
  control.value = current.value64;
  return true;
}

}  // namespace

std::vector<V4l2ControlState> list_controls(const V4l2Device& device) {
  std::vector<V4l2ControlState> controls;
  v4l2_queryctrl query{};
  for (int i = 0; i < kMaxControls; ++i) {
    query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
    if (device.request(VIDIOC_QUERYCTRL, &query) != 0) break;
    if ((query.flags & V4L2_CTRL_FLAG_DISABLED) != 0 || !is_number(query)) continue;
    V4l2ControlState control;
    control.id = query.id;
    control.name = reinterpret_cast<const char*>(query.name);
    control.key = key_of(query.id);
    control.low = query.minimum;
    control.high = query.maximum;
    control.step = query.step;
    control.default_value = query.default_value;
    control.inactive = (query.flags & V4L2_CTRL_FLAG_INACTIVE) != 0;
    control.read_only = (query.flags & V4L2_CTRL_FLAG_READ_ONLY) != 0;
    const bool is_read = query.type == V4L2_CTRL_TYPE_INTEGER64 ? read_wide(device, control) : read(device, control);
    control.readable = is_read && (query.flags & V4L2_CTRL_FLAG_WRITE_ONLY) == 0;
    list_menu(device, query.type, control);
    controls.push_back(std::move(control));
  }
  return controls;
}

}  // namespace touchline::hal
