#include "tools/programs/devices/judge/judge.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "tools/programs/command_line/formatted.h"
#include "tools/programs/devices/judge/luma_picture.h"
#include "tools/programs/devices/judge/moving_objects.h"
#include "tools/programs/devices/judge/readout_estimate.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::devices {
namespace {

// A first frame may take longer than faults.camera_timeout_s.
constexpr Duration kPatience = std::chrono::seconds(5);
// A camera's automatic control of brightness settles in about a second.
constexpr double kSettle_s = 1.0;
constexpr double kBackground_s = 1.0;
constexpr double kExposureStep_s = 0.7;
// These span the shortest time that global shutters offer to more than half the period of 60 Hz.
constexpr std::array kExposures_us{100, 1000, 2000, 5000, 10000};
// The measurement ends early when the uncertainty (two standard deviations) is below this.
constexpr double kGoodReadout_s = 0.0008, kGoodShare = 0.05;
// Standard deviation of systematic errors, for example from lines behind the object. In the simulated arena, readouts
// of 0 to 15 ms were measured up to 0.5 ms too long (tests/tools/camera_judge_test.cpp).
constexpr double kSystematic_s = 0.0003;
// The readout is reported only if its uncertainty is small enough to tell a rolling from a global shutter.
constexpr double kUsefulReadout_s = 0.003, kUsefulShare = 0.15;
// This is more than enough for the statistics, and a person can move an object for so long.
constexpr double kMinMotion_s = 10.0;

using Lease = hal::FrameLease;

class Judge {
 public:
  Judge(hal::Camera& camera, hal::Clock& clock, const hal::CameraSettings& settings, const JudgeOptions& options,
        const JudgeProgress& progress, const std::function<void()>& move)
      : camera_(camera), clock_(clock), settings_(settings), options_(options), progress_(progress), move_(move) {}

  Result<JudgeReport> run() {
    report_.requested = settings_;
    report_.motion_wanted = options_.motion_s > 0.0;
    TOUCHLINE_TRY(camera_.open());
    TOUCHLINE_TRY(camera_.start());
    report_.info = camera_.info();
    TOUCHLINE_TRY(watch(kSettle_s, [](const Frame&) {}));
    TOUCHLINE_TRY(measure_still());
    TOUCHLINE_TRY(measure_exposures());
    if (report_.motion_wanted) TOUCHLINE_TRY(measure_shutter());
    return report_;
  }

 private:
  /// Calls `use` with each frame that arrives within this time. Damaged frames (short, corrupt) are skipped.
  template <class Use>
  Result<void> watch(double for_s, Use use, bool shown = false, const std::function<void()>& before = {}) {
    const Instant begin = clock_.now(), end = begin + from_seconds(for_s);
    Instant last_frame = begin;
    while (clock_.now() < end) {
      if (before) before();
      const Result<Lease> lease = camera_.wait(clock_.now() + std::chrono::milliseconds(500));
      if (!lease.ok()) {
        const bool goes_on = lease.code() == ErrorCode::kShortFrame || lease.code() == ErrorCode::kCorruptFrame ||
                             lease.code() == ErrorCode::kTimeout;
        if (!goes_on || clock_.now() - last_frame > kPatience) return Error(lease.error());
        continue;
      }
      last_frame = clock_.now();
      use(lease.value().frame());
      if (shown) progress_.update(std::min(1.0, seconds(last_frame - begin) / for_s), "");
    }
    return {};
  }

  Result<void> measure_still() {
    progress_.begin(
        1, formatted("keep the picture still for %.0f s: rate, time stamps, noise, flicker", options_.still_s));
    std::vector<FrameTime> times;
    StillMeasurement still;
    TOUCHLINE_TRY(watch(
        options_.still_s,
        [&](const Frame& frame) {
          times.push_back({frame.capture_time, clock_.now(), frame.sequence});
          still.add(frame);
        },
        true));
    if (times.size() < 3) {
      return failure(ErrorCode::kTimeout,
                     "the camera delivered %zu frames in %.0f s; is the cable too long, or the "
                     "exposure longer than a frame?",
                     times.size(), options_.still_s);
    }
    report_.timing = analyze_timing(times);
    report_.still = still.report();
    return {};
  }

  Result<void> measure_exposures() {
    progress_.begin(2, "set exposure times: keep the light as it is");
    hal::CameraSettings changed = settings_;
    for (std::size_t i = 0; i < kExposures_us.size(); ++i) {
      changed.exposure_us = kExposures_us[i];
      changed.exposure_steps = hal::kExposureStepsUnset;
      Result<std::string> differs = camera_.adjust(changed);
      if (!differs.ok()) {
        report_.exposure_refusal = differs.text();
        return {};
      }
      ExposureStep step{kExposures_us[i], 0.0, 0.0, differs.value()};
      std::vector<double> brightness;
      std::vector<FrameTime> times;
      // The first half of the time passes before all frames have the new exposure.
      TOUCHLINE_TRY(watch(kExposureStep_s / 2.0, [](const Frame&) {}));
      TOUCHLINE_TRY(watch(kExposureStep_s / 2.0, [&](const Frame& frame) {
        StillMeasurement one;
        one.add(frame);
        one.add(frame);
        brightness.push_back(one.report().brightness);
        times.push_back({frame.capture_time, clock_.now(), frame.sequence});
      }));
      if (!brightness.empty()) step.brightness = statistics::median(brightness);
      step.rate_hz = analyze_timing(times).delivered_hz;
      report_.exposures.push_back(std::move(step));
      progress_.update(static_cast<double>(i + 1) / static_cast<double>(kExposures_us.size()), "");
    }
    const Result<std::string> restored = camera_.adjust(settings_);
    if (!restored.ok()) return Error(restored.error());
    return watch(kSettle_s, [](const Frame&) {});
  }

  Result<void> measure_shutter() {
    progress_.begin(3,
                    formatted("move a round or square stiff thing (a lid, a robot) quickly left and right and up and "
                              "down, for at most %.0f s: rolling shutter",
                              options_.motion_s));
    const std::size_t square = luma_square(report_.info.width_px);
    LumaPicture picture, background;
    std::size_t count = 0;
    TOUCHLINE_TRY(watch(kBackground_s, [&](const Frame& frame) {
      read_luma(frame, square, picture);
      if (count++ == 0) background.value.assign(picture.value.size(), 0.0f);
      for (std::size_t i = 0; i < picture.value.size(); ++i) background.value[i] += picture.value[i];
    }));
    if (count == 0) return failure(ErrorCode::kTimeout, "the camera delivers no frames any more");
    background.width = picture.width;
    background.height = picture.height;
    for (float& value : background.value) value /= static_cast<float>(count);
    MovingObjectFinder finder(std::move(background), report_.still.noise / static_cast<double>(square));
    const double period_s = report_.timing.period_s;
    ReadoutMeasurement readout(picture.height, period_s);
    const Instant begin = clock_.now();
    Instant next_estimate = begin + from_seconds(kMinMotion_s);
    bool is_good = false;
    while (!is_good && seconds(clock_.now() - begin) < options_.motion_s) {
      // Frames are watched in pieces of a second; the estimate, which takes longer than a frame, is made between two
      // pieces.
      TOUCHLINE_TRY(watch(
          1.0,
          [&](const Frame& frame) {
            read_luma(frame, square, picture);
            readout.add(frame.sequence, finder.find(picture));
          },
          false, move_));
      const double elapsed_s = seconds(clock_.now() - begin);
      std::string remark = "nothing moves yet";
      if (clock_.now() >= next_estimate) {
        const ReadoutEstimate estimate = readout.estimate();
        if (estimate.known) {
          ShutterReport& shutter = report_.shutter;
          shutter.readout_s = estimate.readout * period_s;
          shutter.sigma_s = std::hypot(estimate.sigma * period_s, kSystematic_s);
          const double uncertainty_s = 2.0 * shutter.sigma_s, size_s = std::abs(shutter.readout_s);
          shutter.measured = uncertainty_s < std::max(kUsefulReadout_s, kUsefulShare * size_s);
          is_good = uncertainty_s < std::max(kGoodReadout_s, kGoodShare * size_s);
          remark = formatted("%.1f ms +- %.1f ms; go on", 1e3 * shutter.readout_s, 1e3 * uncertainty_s);
        }
      } else {
        remark = "go on";
      }
      progress_.update(std::min(1.0, elapsed_s / options_.motion_s), remark);
    }
    return {};
  }

  hal::Camera& camera_;
  hal::Clock& clock_;
  const hal::CameraSettings& settings_;
  const JudgeOptions& options_;
  const JudgeProgress& progress_;
  const std::function<void()>& move_;
  JudgeReport report_;
};

}  // namespace

Result<JudgeReport> judge(hal::Camera& camera, hal::Clock& clock, const hal::CameraSettings& settings,
                          const JudgeOptions& options, const JudgeProgress& progress,
                          const std::function<void()>& move) {
  Result<JudgeReport> report = Judge(camera, clock, settings, options, progress, move).run();
  camera.stop();
  camera.close();
  return report;
}

}  // namespace touchline::devices
