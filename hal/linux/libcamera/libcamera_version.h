#pragma once

#include <libcamera/camera.h>
#include <libcamera/control_ids.h>
#include <libcamera/controls.h>
#include <libcamera/version.h>

// Differences between libcamera 0.0.3 (Debian 12), 0.4 (Debian 13) and 0.5 and later (Raspberry Pi OS). Only
// libcamera_link.cpp and libcamera_numbers.cpp include this file.
#define TOUCHLINE_LIBCAMERA (LIBCAMERA_VERSION_MAJOR * 10000 + LIBCAMERA_VERSION_MINOR * 100 + LIBCAMERA_VERSION_PATCH)

namespace touchline::hal::version {

/// Sets a control if the camera has it.
template <class T, class V>
void set(libcamera::ControlList& list, const libcamera::ControlInfoMap& of_camera, const libcamera::Control<T>& control,
         const V& value) {
  if (of_camera.find(&control) != of_camera.end()) list.set(control, value);
}

/// Fixes exposure time and gain, or leaves either to the camera. `both_or_none`: the camera cannot fix only one of
/// them.
inline void set_exposure_modes(libcamera::ControlList& list, const libcamera::ControlInfoMap& of_camera, bool exposure,
                               bool gain, bool both_or_none) {
#if TOUCHLINE_LIBCAMERA >= 500
  static_cast<void>(both_or_none);
  set(list, of_camera, libcamera::controls::ExposureTimeMode,
      exposure ? libcamera::controls::ExposureTimeModeManual : libcamera::controls::ExposureTimeModeAuto);
  set(list, of_camera, libcamera::controls::AnalogueGainMode,
      gain ? libcamera::controls::AnalogueGainModeManual : libcamera::controls::AnalogueGainModeAuto);
#else
  // A value fixes one of them; the other stays automatic.
  set(list, of_camera, libcamera::controls::AeEnable, !(both_or_none ? exposure || gain : exposure && gain));
#endif
}

/// Returns null if this version has no flicker filter.
inline const libcamera::Control<std::int32_t>* flicker_period() {
#if TOUCHLINE_LIBCAMERA >= 200
  return &libcamera::controls::AeFlickerPeriod;
#else
  return nullptr;
#endif
}

inline void set_flicker_mode(libcamera::ControlList& list, const libcamera::ControlInfoMap& of_camera, bool manual) {
#if TOUCHLINE_LIBCAMERA >= 200
  set(list, of_camera, libcamera::controls::AeFlickerMode,
      manual ? libcamera::controls::FlickerManual : libcamera::controls::FlickerOff);
#else
  static_cast<void>(list);
  static_cast<void>(of_camera);
  static_cast<void>(manual);
#endif
}

/// Returns whether pictures of this validated configuration are mirror images. A rotated picture is not a mirror image.
inline bool is_mirrored(const libcamera::CameraConfiguration& configuration) {
#if TOUCHLINE_LIBCAMERA >= 200
  using libcamera::Orientation;
  const Orientation of = configuration.orientation;
  return of == Orientation::Rotate0Mirror || of == Orientation::Rotate180Mirror || of == Orientation::Rotate90Mirror ||
         of == Orientation::Rotate270Mirror;
#else
  // Each flip mirrors the picture, and exchanging rows and columns does, too.
  using libcamera::Transform;
  const auto has = [&](Transform part) { return (configuration.transform & part) != Transform::Identity; };
  return has(Transform::HFlip) != (has(Transform::VFlip) != has(Transform::Transpose));
#endif
}

}  // namespace touchline::hal::version
