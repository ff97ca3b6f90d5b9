#include "tools/programs/devices/judge/judge_text.h"

#include <algorithm>
#include <cmath>

#include "tools/programs/command_line/formatted.h"

namespace touchline::devices {
namespace {

// All limits are derived from the displacement of a robot at 1 m/s, the speed assumed in docs/hardware.md: a
// millisecond is a millimeter.
constexpr double kRobot_mps = 1.0;
// Displacement between two frames. 20 mm (50 Hz) is less than the ball's radius; beyond a robot's side (75 mm), tracks
// are ambiguous.
constexpr double kGoodStep_m = 0.0201, kUsableStep_m = 0.075;
// The delivered rate may be lower than requested by this factor.
constexpr double kSlower = 0.95;
// A lost frame leaves a gap of two frame periods. One lost frame in a hundred is rarely noticed; one in five amounts to
// a camera of a lower rate.
constexpr double kGoodLost = 0.01, kUsableLost = 0.2;
// Jitter of the time stamps displaces a robot. 2 mm are below the noise of a robot's position on a field of 2 m at 640
// px (4 mm per pixel); 20 mm are a whole frame.
constexpr double kGoodJitter_m = 0.002, kUsableJitter_m = 0.02;
// Displacement by motion blur, and between first and last row: docs/hardware.md asks for 5 mm at most.
constexpr double kGoodSmear_m = 0.005;
// Color boxes are a few dozen levels wide. Three standard deviations of a noise of 4 levels stay within half of that
// width.
constexpr double kGoodNoise = 4.0, kUsableNoise = 12.0;
// The adaptation to the light follows slow changes only. A fast change of 2 % is like a noise of one level at medium
// brightness.
constexpr double kGoodFlicker = 0.02, kUsableFlicker = 0.15;
// Median brightness below which, or above which, a picture is too dark or too bright to judge.
constexpr double kDark = 24.0, kWhite = 250.0;
constexpr int kGameExposure_us = 5000;

double frames_per_second(const JudgeReport& report) { return report.timing.delivered_hz; }

const ExposureStep* step_at(const JudgeReport& report, int exposure_us) {
  for (const ExposureStep& step : report.exposures) {
    if (step.exposure_us == exposure_us) return &step;
  }
  return nullptr;
}

/// Returns whether the camera measures exposure in steps of its own instead of microseconds (docs/cameras.md).
bool has_own_steps(const JudgeReport& report) {
  return !report.exposures.empty() && report.exposures[0].differs.find("set exposure_steps") != std::string::npos;
}

/// Whether longer exposures make the picture brighter. kUnknown: the picture is black or white at all exposures.
enum class Response : std::uint8_t { kFollows, kIgnores, kUnknown };
Response exposure_response(const JudgeReport& report) {
  if (report.exposures.size() < 2 || has_own_steps(report)) return Response::kUnknown;
  const double dark = report.exposures.front().brightness, bright = report.exposures.back().brightness;
  if (bright > dark + 5.0 && bright > 1.15 * dark) return Response::kFollows;
  return bright < kDark || dark > kWhite ? Response::kUnknown : Response::kIgnores;
}

std::string size_of(const JudgeReport& report) {
  return formatted("%ux%u", unsigned{report.info.width_px}, unsigned{report.info.height_px});
}

std::string format_of(const JudgeReport& report) {
  return std::string(hal::kCameraFormats[static_cast<std::size_t>(report.requested.format)].word);
}

std::string stamp_event(const JudgeReport& report) {
  const std::string& text = report.info.description;
  const std::string mark = "time stamps of the ";
  const std::size_t at = text.find(mark);
  if (at == std::string::npos) {
    switch (report.requested.backend) {
      case hal::CameraBackend::kLibcamera:
        return "end of the first row's exposure (libcamera)";
      case hal::CameraBackend::kMock:
        return "middle of the exposure (simulated)";
      default:
        return "unknown event";
    }
  }
  return text.substr(at + mark.size(), text.find(',', at) - at - mark.size());
}

bool is_stamped_on_arrival(const JudgeReport& report) { return stamp_event(report) == "dequeuing"; }

std::string shutter_text(const JudgeReport& report) {
  if (!report.motion_wanted) return "not measured (--no-motion)";
  const ShutterReport& shutter = report.shutter;
  if (!shutter.measured) return "not measured: too little moved, or not back and forth";
  const double size_ms = 1e3 * shutter.readout_s, uncertainty_ms = 2e3 * shutter.sigma_s;
  if (std::abs(size_ms) < std::max(uncertainty_ms, 0.3)) {
    return formatted("none seen (%.1f ms +- %.1f ms): global, or a fast readout", size_ms, uncertainty_ms);
  }
  return formatted("rolling: last row %.1f ms +- %.1f ms after the first", size_ms, uncertainty_ms);
}

std::string exposure_text(const JudgeReport& report) {
  if (report.exposures.empty()) return "cannot be changed while it streams: " + report.exposure_refusal;
  std::string text;
  for (const ExposureStep& step : report.exposures) {
    text += formatted("%s%g ms: %.0f", text.empty() ? "" : ", ", step.exposure_us / 1e3, step.brightness);
  }
  switch (exposure_response(report)) {
    case Response::kFollows:
      break;
    case Response::kIgnores:
      text += " (the camera ignores it)";
      break;
    case Response::kUnknown:
      text += has_own_steps(report) ? " (the camera has steps of its own)" : " (too dark or too bright to tell)";
      break;
  }
  return text;
}

}  // namespace

std::vector<Finding> judge_findings(const JudgeReport& report) {
  std::vector<Finding> findings;
  const auto add = [&](bool is_bad, bool is_unusable, std::string reason) {
    if (is_bad) findings.push_back({is_unusable ? Grade::kUnusable : Grade::kUsable, std::move(reason)});
  };
  const TimingReport& timing = report.timing;
  const double step_m = kRobot_mps / std::max(frames_per_second(report), 1e-3);
  add(step_m > kGoodStep_m, step_m > kUsableStep_m,
      formatted("it delivers %.3g frames a second, between which a robot at 1 m/s moves %.0f mm",
                frames_per_second(report), 1e3 * step_m));
  if (step_m <= kGoodStep_m && report.requested.rate_hz > 0.0) {
    add(timing.delivered_hz < kSlower * report.requested.rate_hz, false,
        formatted("it delivers %.3g of the requested %.3g frames a second", timing.delivered_hz,
                  report.requested.rate_hz));
  }
  add(timing.lost_share() > kGoodLost, timing.lost_share() > kUsableLost,
      formatted("%.2g %% of its frames are lost", 100.0 * timing.lost_share()));
  const double jitter_m = kRobot_mps * timing.jitter_s;
  add(jitter_m > kGoodJitter_m, jitter_m > kUsableJitter_m,
      formatted("its time stamps jitter by %.1f ms", 1e3 * timing.jitter_s));
  add(is_stamped_on_arrival(report) || !timing.increasing, false,
      "its driver has no monotonic time stamps, so that a late program misjudges every speed");
  switch (exposure_response(report)) {
    case Response::kFollows:
    case Response::kUnknown:
      break;
    case Response::kIgnores:
      add(true, false, "its exposure cannot be set, so that the light decides on motion blur and colors");
  }
  add(has_own_steps(report), false, "its exposure has steps of its own, whose time is unknown (camera.exposure_steps)");
  add(report.exposures.empty(), false, "its exposure cannot be set while it streams");
  if (const ExposureStep* step = step_at(report, kGameExposure_us)) {
    add(step->brightness < kDark, false,
        formatted("the picture is dark at 5 ms (brightness %.0f of 255): more light, a lens with a wider aperture or "
                  "more gain is needed",
                  step->brightness));
    add(frames_per_second(report) > 0.0 && step->rate_hz < 0.9 * frames_per_second(report), false,
        formatted("its rate falls to %.3g Hz at an exposure of 5 ms", step->rate_hz));
  }
  add(report.still.noise > kGoodNoise, report.still.noise > kUsableNoise,
      formatted("a pixel's noise is %.1f of 255", report.still.noise));
  add(report.still.flicker > kGoodFlicker, report.still.flicker > kUsableFlicker,
      formatted("the light flickers by %.1f %%%s: set camera.power_line, or use lamps without flicker",
                100.0 * report.still.flicker, report.still.has_bands ? " in bands" : ""));
  if (report.shutter.measured) {
    const double size_s = std::abs(report.shutter.readout_s);
    add(kRobot_mps * (size_s - 2.0 * report.shutter.sigma_s) > kGoodSmear_m, false,
        formatted("its shutter rolls: a robot at 1 m/s is displaced by %.0f mm between the first and the last row",
                  1e3 * kRobot_mps * size_s));
  }
  std::stable_sort(findings.begin(), findings.end(),
                   [](const Finding& a, const Finding& b) { return a.grade > b.grade; });
  return findings;
}

std::string verdict(const JudgeReport& report) {
  const std::vector<Finding> findings = judge_findings(report);
  const std::string unknown = report.shutter.measured ? "" : " (its shutter was not measured)";
  if (findings.empty()) return "This camera is good for Touchline" + unknown + ".";
  const Grade worst = findings.front().grade;
  std::string text = worst == Grade::kUnusable ? "This camera, as it is set, is not usable, because "
                                               : "This camera is usable, but not good, because ";
  bool first = true;
  for (const Finding& finding : findings) {
    if (finding.grade != worst) break;
    text += (first ? "" : "; ") + finding.reason;
    first = false;
  }
  return text + unknown + ".";
}

std::string figures(const JudgeReport& report) {
  const TimingReport& timing = report.timing;
  std::string text;
  text += formatted("rate          %.2f frames a second arrived (requested %.4g, the driver says %.4g)\n",
                    timing.delivered_hz, report.requested.rate_hz, report.info.rate_hz);
  const unsigned long long lost = timing.lost, frames = timing.frames;
  text += formatted("lost frames   %llu of %llu\n", lost, lost + frames);
  text +=
      formatted("time stamps   of the %s, %s; jitter %.2f ms RMS, %.2f ms at most\n", stamp_event(report).c_str(),
                timing.increasing ? "monotonic" : "not monotonic", 1e3 * timing.jitter_s, 1e3 * timing.worst_jitter_s);
  text += formatted("delay         %.1f ms from the stamp (middle of the exposure) to this program, %.1f ms at most\n",
                    1e3 * timing.delay_s, 1e3 * timing.worst_delay_s);
  text += "shutter       " + shutter_text(report) + "\n";
  text += "exposure      brightness of 255 at " + exposure_text(report) + "\n";
  for (const ExposureStep& step : report.exposures) {
    if (!step.differs.empty()) text += formatted("              %g ms: ", step.exposure_us / 1e3) + step.differs + "\n";
  }
  text += formatted("noise         %.2f of 255 a pixel, at a brightness of %.0f\n", report.still.noise,
                    report.still.brightness);
  text += formatted("flicker       %.2f %%%s\n", 100.0 * report.still.flicker,
                    report.still.has_bands && report.still.flicker > kGoodFlicker ? ", in bands" : "");
  return text;
}

std::string hardware_report(const JudgeReport& report, const std::string& system, const std::string& version) {
  const std::string name = report.info.description.empty()
                               ? std::string("the simulated arena")
                               : report.info.description.substr(0, report.info.description.find(": "));
  std::string text = "camera (name, sensor, format, size, rate): " + name + ", sensor?, " + format_of(report) + " " +
                     size_of(report) + formatted(" at %.4g Hz\n", report.timing.delivered_hz);
  text += "board and system: " + system + "\n";
  text += "radio and robots:\n";
  text += "touchline --version: " + version + "\n";
  text += "touchline-devices --judge:\n";
  std::string lines = figures(report) + verdict(report) + "\n";
  std::size_t begin = 0;
  while (begin < lines.size()) {
    const std::size_t end = lines.find('\n', begin);
    text += "  " + lines.substr(begin, end - begin + 1);
    begin = end + 1;
  }
  text += "last lines of `touchline-latency --board board.toml --duration 60`:\n";
  text += "what worked, what did not:\n";
  return text;
}

}  // namespace touchline::devices
