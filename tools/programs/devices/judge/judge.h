#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hal/camera.h"
#include "hal/clock.h"
#include "hal/device_parameters.h"
#include "hal/result.h"
#include "tools/programs/devices/judge/frame_timing.h"
#include "tools/programs/devices/judge/still_picture.h"

namespace touchline::devices {

/// Behavior of the camera at one exposure time.
struct ExposureStep {
  int exposure_us = 0;
  double brightness = 0.0;  // median brightness, 0 to 255
  double rate_hz = 0.0;
  std::string differs;  // what the driver did instead of setting the time; "": the time was set
};

/// Time from the exposure of the first row to that of the last row.
struct ShutterReport {
  bool measured = false;
  double readout_s = 0.0, sigma_s = 0.0;
};

struct JudgeReport {
  hal::CameraSettings requested;
  hal::CameraInfo info;
  TimingReport timing;
  StillReport still;
  std::vector<ExposureStep> exposures;  // shortest first; empty: the exposure cannot be changed while streaming
  std::string exposure_refusal;         // why the exposure cannot be changed; "": it can be changed
  ShutterReport shutter;
  bool motion_wanted = true;
};

struct JudgeOptions {
  double still_s = 10.0;
  double motion_s = 60.0;  // longest measurement of the rolling shutter; 0: skip it
};

/// Called while the camera is judged: begin() once for each step, then update() with the part of it that is `done`, 0
/// to 1.
struct JudgeProgress {
  std::function<void(int step, const std::string& what)> begin = [](int, const std::string&) {};
  std::function<void(double done, const std::string& remark)> update = [](double, const std::string&) {};
};
inline constexpr int kJudgeSteps = 3;

/// Opens a camera, measures it, and closes it again. `move` is called before each frame of the last step, so that a
/// simulation can move an object. At the end the camera has the exposure of `settings`. Errors: those of the camera.
Result<JudgeReport> judge(hal::Camera& camera, hal::Clock& clock, const hal::CameraSettings& settings,
                          const JudgeOptions& options, const JudgeProgress& progress,
                          const std::function<void()>& move = {});

}  // namespace touchline::devices
