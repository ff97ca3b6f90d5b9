#pragma once

#include <string>

namespace touchline::console {

/// Returns the devices from which a person can choose in Set up, as JSON: cameras with their modes and a small picture
/// of each, serial ports, and GPIO chips. A camera that another program uses has "refused" instead of "thumbnail";
/// "suggested" is the mode with which devices::suggested_settings() tries it first. `used_camera` is the loop's camera;
/// it is not opened, because its picture is on the page anyway. Takes up to two seconds for each camera, and leaves the
/// other cameras' controls as set for Touchline's default exposure.
std::string device_answer(const std::string& used_camera);

/// Returns only the serial ports and GPIO chips of device_answer(), which takes no time. "name" is the value for the
/// board file.
std::string port_answer();

}  // namespace touchline::console
