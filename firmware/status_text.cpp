#include "firmware/status_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "core/radio/telemetry.h"

namespace touchline {
namespace {

// Robots send telemetry about twice a second.
constexpr double kStaleRobotStatusS = 2.0;

// Appends formatted text; the arguments are as for printf.
[[gnu::format(printf, 2, 3)]] void print(std::string& out, const char* format, ...) {
  std::array<char, 512> buffer{};
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer.data(), buffer.size(), format, arguments);
  va_end(arguments);
  out += buffer.data();
}

double milliseconds(Duration d) { return seconds(d) * 1e3; }

// Returns the number that explains a reason; "" if there is none.
std::string figure(Halt reason, const PictureTrace& picture) {
  std::string text;
  const auto percent = [](float share) { return 100.0 * static_cast<double>(share); };
  switch (reason) {
    case kHaltRepeats:
      if (picture.repeated_share > 0.0f) {
        print(text, " (%.0f %% of the picture, %.2f s old)", percent(picture.repeated_share),
              static_cast<double>(picture.repeated_s));
      }
      if (picture.replays || !picture.repeats) text += "; check the camera, then press Start";
      break;
    case kHaltOverload:
      print(text, " (%u frames in a row)", picture.overload_frames);
      break;
    case kHaltField:
      if (picture.field_share >= 0.0f) print(text, " (%.0f %% of it)", percent(picture.field_share));
      break;
    case kHaltMotion:
      if (picture.contradicts && !picture.jumps) {
        print(text, " (%d of %d commanded robots)", int{picture.contradicting}, int{picture.commanded});
      }
      text += "; check batteries, radio and picture, then press Start";
      break;
    default:
      break;
  }
  return text;
}

std::string halt_reasons(std::uint32_t halt, const PictureTrace& picture) {
  std::string reasons;
  for (const HaltDescription& reason : kHaltDescriptions) {
    if ((halt & reason.bit) == 0) continue;
    // The end of a setup is listed instead, which explains why the console holds the robots.
    if (reason.bit == kHaltConsole && (halt & kHaltSetupEnded) != 0) continue;
    if (!reasons.empty()) reasons += ", ";
    reasons.append(reason.reason).append(figure(reason.bit, picture));
    if (reason.bit == kHaltCrash && (halt & kHaltStart) == 0) {
      reasons += ", press Start on the page or restart the service to let robots move";
    }
  }
  return reasons;
}

// On the map and in the picture's usual orientation, positive x is to the right.
const char* direction(bool own_on_positive_half) { return own_on_positive_half ? "left" : "right"; }

// Returns the largest number of bytes that noise on the link explains. A damaged report leaves its bytes, and the next
// report shows that its number is missing. The last report of each robot may be damaged or incomplete, too.
std::uint64_t bytes_of_damaged_reports(const RobotReports& reports) {
  std::uint64_t damaged = 0;
  for (const RobotReport& robot : reports.robots) damaged += robot.missed + 1U;
  return damaged * reports.report_bytes;
}

// Omits values that a robot does not measure.
void print_robot_status(std::string& out, float battery_v, int link_percent, const std::optional<WheelSpeeds>& wheels) {
  if (battery_v > 0.0f) print(out, " %.2f V", static_cast<double>(battery_v));
  if (link_percent >= 0) print(out, " %d %%", link_percent);
  if (!wheels) return;
  print(out, " wheels %.2f %.2f m/s", static_cast<double>(wheels->left_mps), static_cast<double>(wheels->right_mps));
}

const char* consequence(FaultAction action) {
  switch (action) {
    case FaultAction::kNone:
      return "";
    case FaultAction::kSkip:
      return "; skipped";
    case FaultAction::kReopen:
      return "; reopening it";
    case FaultAction::kLeave:
      return "; stopping the robots and ending the program";
    case FaultAction::kContinueWithout:
      return "; continuing without it";
  }
  return "";
}

const char* describe_end(LoopEnd end) {
  switch (end) {
    case LoopEnd::kRequested:
      return "stopped on request";
    case LoopEnd::kLimit:
      return "limit of frames or duration reached";
    case LoopEnd::kEndOfStream:
      return "end of the input";
    case LoopEnd::kDeviceLost:
      return "a device was lost for too long";
    case LoopEnd::kRestart:
      return "switched to other files";
    case LoopEnd::kFault:
      return "a fault that reopening the device cannot fix";
  }
  return "";
}

}  // namespace

std::string status_line(const StatusReport& status, const Expectation& expected) {
  std::string line;
  print(line, "%.0f s  %.1f fps  ", status.elapsed_s, status.rate_hz);
  if (!expected.source.empty()) line += "of " + expected.source + "  ";
  print(line, "own %u/%u  opp %u/%u  ", status.own_seen, expected.own, status.opponents_seen, expected.opponents);
  if (status.ball_seen) {
    print(line, "ball (%.2f, %.2f)", static_cast<double>(status.ball.x_m), static_cast<double>(status.ball.y_m));
  } else {
    line += "ball lost";
  }
  if (status.score) print(line, "  score %u:%u", status.score->own, status.score->opponent);
  print(line, "  playing %s", direction(status.own_on_positive_half));
  print(line, "  latency p50 %.1f p99 %.1f max %.1f ms  packets %llu", milliseconds(status.p50),
        milliseconds(status.p99), milliseconds(status.max), static_cast<unsigned long long>(status.packets));
  const auto count = [&](const char* what, std::uint64_t value) {
    if (value > 0) print(line, "  %s %llu", what, static_cast<unsigned long long>(value));
  };
  count("packets dropped", status.packets_dropped);
  count("commands expired", status.commands_expired);
  count("frames lost", status.frames_lost);
  count("frames stamped in the future", status.future_stamps);
  count("packets ignored", status.packets_ignored);
  count("overloads", status.overloads);
  count("faults", status.faults);
  // Changes below this are not shown, because noise changes the brightness by some percent.
  constexpr double kNoise_percent = 4.5;
  const double brighter = 100.0 * (static_cast<double>(status.brightness) - 1.0);
  if (std::abs(brighter) > kNoise_percent) print(line, "  light %+.0f %%", brighter);
  if (status.adaptation == AdaptationMode::kFrozen) line += "  adaptation frozen";
  for (std::size_t i = 0; i < status.robot_status.size(); ++i) {
    const RobotStatus& robot = status.robot_status[i];
    print(line, "%s%d:", i == 0 ? "  robots " : ", ", robot.id);
    print_robot_status(line, robot.battery_v, robot.link_percent, robot.wheels);
    if (robot.battery_low) line += " LOW";
    if (robot.age_s > kStaleRobotStatusS) print(line, " (%.0f s ago)", robot.age_s);
  }
  for (const Device device : kDevices) {
    const ReasonText& reason = status.lost[static_cast<std::size_t>(device)];
    if (!reason.empty()) line.append("  no ").append(describe(device)).append(": ").append(reason.view());
  }
  if (status.halt != kHaltNone) line += "  HALTED: " + halt_reasons(status.halt, status.picture);
  return line;
}

std::string fault_line(const FaultReport& fault) {
  std::string line;
  print(line, "%.1f s  %s: ", fault.elapsed_s, describe(fault.device));
  if (fault.code == ErrorCode::kOk) return line + "reopened";
  line += describe(fault.code);
  if (!fault.reason.empty()) line.append(" (").append(fault.reason.view()).append(")");
  return line + consequence(fault.action);
}

std::string battery_line(const BatteryReport& battery) {
  std::string line;
  print(line, "%.1f s  robot %d: battery is low, %.2f V", battery.elapsed_s, battery.id,
        static_cast<double>(battery.battery_v));
  return line;
}

std::string drive_line(const DriveReport& drive) {
  std::string line;
  const auto& [first, second] = drive.compared;
  print(line, "%.1f s  ", drive.elapsed_s);
  if (drive.value == DriveReport::Value::kGain) {
    print(line, "robot %d: own.robot.wheel_gain of the team file is %.3f, %.3f, but its wheels show %.3f, %.3f",
          drive.robot, first.stated, second.stated, first.used, second.used);
    const double sigma = std::max(first.measured.sigma, second.measured.sigma);
    if (std::isfinite(sigma)) print(line, " (+- %.3f)", sigma);
    line += "; these are used";
  } else {
    const bool is_delay = drive.value == DriveReport::Value::kDelay;
    print(line, "%s is %.0f ms, but the robots show %.1f",
          is_delay ? "radio.delay_s of the board file" : "tracking.robot.wheel_lag_s of the team file",
          1e3 * first.stated, 1e3 * first.used);
    if (std::isfinite(first.measured.sigma)) print(line, " +- %.1f", 1e3 * first.measured.sigma);
    line += " ms, which is used";
  }
  return line + ": measure it with touchline-radio and correct the file";
}

std::string standing_line(const StandingReport& standing) {
  std::string line;
  print(line, "%.1f s  %s although %s commanded to move: check batteries, radio and picture", standing.elapsed_s,
        standing.robots == 1 ? "the robot stands" : "all robots stand", standing.robots == 1 ? "it is" : "they are");
  return line;
}

std::string halt_line(const HaltReport& halt) {
  std::string line;
  print(line, "%.1f s  ", halt.elapsed_s);
  return line +
         (halt.halt == kHaltNone ? "robots may move" : "robots halted: " + halt_reasons(halt.halt, halt.picture));
}

std::string summary(const LoopStatistics& statistics, LoopEnd end) {
  std::string text;
  const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  const double elapsed = seconds(statistics.end - statistics.begin);
  print(text, "end       %s\n", describe_end(end));
  print(text, "frames    %llu in %.1f s (%.1f per second), %llu lost, %llu unusable\n", number(statistics.frames),
        elapsed, elapsed > 0.0 ? static_cast<double>(statistics.frames) / elapsed : 0.0, number(statistics.frames_lost),
        number(statistics.frames - statistics.good_frames));
  text += "game      ";
  if (statistics.score) print(text, "score %u : %u, ", statistics.score->own, statistics.score->opponent);
  print(text, "playing to the %s\n", direction(statistics.own_on_positive_half));
  if (statistics.future_stamps > 0) {
    print(text, "stamps    %llu frames with a time stamp in the future; the time of arrival was used\n",
          number(statistics.future_stamps));
  }
  if (const hal::SourceCounters& source = statistics.source; source.sum() > 0) {
    print(text, "source    packets ignored: %llu late, %llu doubled, %llu of a second sender, %llu malformed\n",
          number(source.late), number(source.doubled), number(source.foreign), number(source.malformed));
  }
  print(text, "latency   capture to send: p50 %.2f  p90 %.2f  p99 %.2f  p99.9 %.2f  max %.2f ms\n",
        milliseconds(statistics.latency.percentile(0.5)), milliseconds(statistics.latency.percentile(0.9)),
        milliseconds(statistics.latency.percentile(0.99)), milliseconds(statistics.latency.percentile(0.999)),
        milliseconds(statistics.latency.max()));
  print(text, "packets   %llu sent, %llu of them stop packets; %llu refused, %llu dropped for newer ones\n",
        number(statistics.packets - statistics.packets_dropped), number(statistics.stop_packets),
        number(statistics.packets_refused), number(statistics.packets_dropped));
  if (const ExternalCounts& external = statistics.external; external.commands > 0) {
    print(text, "commands  %llu of other programs; %llu times a robot stopped because its last one was too old\n",
          number(external.commands), number(external.commands_expired));
  }
  if (const std::uint64_t messages = statistics.external.referee_messages; messages > 0) {
    print(text, "referee   %llu messages\n", number(messages));
  }
  for (const RobotReport& robot : statistics.robots.robots) {
    print(text, "robot %-2d ", robot.last.id);
    print_robot_status(text, robot.last.battery_v, robot.last.link_percent, robot.last.wheels);
    print(text, " %.1f s before the end; %u reports, %u missed%s\n", seconds(statistics.end - robot.heard),
          robot.packets, robot.missed, robot.battery_low ? "; BATTERY LOW" : "");
  }
  if (statistics.packets_unreachable > 0) {
    print(text, "radio     %llu packets did not reach their robot: it is switched off, or its address is wrong\n",
          number(statistics.packets_unreachable));
  }
  if (statistics.robots.foreign_bytes > bytes_of_damaged_reports(statistics.robots)) {
    print(
        text,
        "radio     %llu received bytes are not from reports of robots: check radio.baud, and whether the radio module "
        "echoes or sends messages\n",
        number(statistics.robots.foreign_bytes));
  }
  print(text, "overload  %llu frames (%llu runs and %llu regions did not fit)\n", number(statistics.overloads),
        number(statistics.runs_dropped), number(statistics.regions_dropped));
  for (std::size_t d = 0; d < kDeviceCount; ++d) {
    for (std::size_t c = 0; c < kErrorCodeCount; ++c) {
      if (statistics.faults[d][c] == 0) continue;
      print(text, "faults    %s: %s, %llu times\n", describe(static_cast<Device>(d)),
            describe(static_cast<ErrorCode>(c)), number(statistics.faults[d][c]));
    }
    if (statistics.reopened[d] > 0) {
      print(text, "reopened  %s, %llu times\n", describe(static_cast<Device>(d)), number(statistics.reopened[d]));
    }
  }
  return text;
}

}  // namespace touchline
