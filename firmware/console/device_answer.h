#pragma once

#include <functional>
#include <memory>
#include <string>

#include "hal/device_parameters.h"
#include "hal/linux/libcamera/libcamera_link.h"

namespace touchline::console {

/// Connects to libcamera; tests replace it.
using MakeLibcameraLink = std::function<std::unique_ptr<hal::LibcameraLink>()>;

/// Cameras with what they offer and a small picture of each, serial ports and GPIO chips, as JSON: the devices that Set
/// up lets a person choose from. A camera that another program uses has "refused" instead of "thumbnail"; "suggested"
/// is the mode with which it is tried first. `used` is the loop's camera, which is not opened, because its picture is
/// on the page anyway. Takes up to two seconds for each camera, and leaves the others' controls as they are set for
/// Touchline's default exposure. A device whose driver hangs is listed with "refused" after five seconds, and all
/// together take 20 s at most.
///
/// A camera of libcamera is listed without being acquired, except for its small picture. `priority`: that of the loop;
/// a libcamera that is started here may soon serve the loop, see LibcameraCamera. USB cameras are listed as V4L2
/// devices only.
std::string device_answer(const hal::CameraSettings& used, int priority = 0,
                          const MakeLibcameraLink& make_link = hal::make_libcamera_link);

/// Returns only the serial ports and GPIO chips of device_answer(), which takes no time. "name" is the value for the
/// board file.
std::string port_answer();

}  // namespace touchline::console
