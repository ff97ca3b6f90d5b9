#pragma once

#include <string>

namespace touchline::console {

/// Cameras with what they offer and a small picture of each, serial ports and GPIO chips, as JSON: the devices that Set
/// up lets a person choose from. A camera that another program uses has "refused" instead of "thumbnail"; "suggested"
/// is the mode with which devices::suggested_settings() tries it first. `used_camera` is the loop's camera, which is
/// not opened, because its picture is on the page anyway. Takes up to two seconds for each camera, and leaves the
/// others' controls as they are set for Touchline's default exposure.
std::string device_answer(const std::string& used_camera);

/// The serial ports and GPIO chips of device_answer() alone, which takes no time. "name" is what a board file should
/// have.
std::string port_answer();

}  // namespace touchline::console
