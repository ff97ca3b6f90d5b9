#include "tools/programs/devices/judge/judge_command.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>

#include "firmware/devices.h"
#include "firmware/exit_codes.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/devices/judge/arena_hand.h"
#include "tools/programs/devices/judge/camera_choice.h"
#include "tools/programs/devices/judge/judge_text.h"

namespace touchline::devices {
namespace {

constexpr const char* kProgram = "touchline-devices";

/// Returns the name of the board and of the operating system, each as the system reports it.
std::string system_text() {
  std::string text;
  std::string line;
  if (std::ifstream model("/proc/device-tree/model"); std::getline(model, line, '\0')) text = line + ", ";
  if (text.empty()) {
    std::ifstream processors("/proc/cpuinfo");
    while (std::getline(processors, line)) {
      if (line.rfind("model name", 0) != 0) continue;
      text = line.substr(std::min(line.size(), line.find(':') + 2)) + ", ";
      break;
    }
  }
  std::ifstream release("/etc/os-release");
  while (std::getline(release, line)) {
    if (line.rfind("PRETTY_NAME=\"", 0) == 0) text += line.substr(13, line.size() - 14) + ", ";
  }
  utsname kernel{};
  if (uname(&kernel) == 0) text += std::string(kernel.sysname) + " " + kernel.release + " " + kernel.machine;
  return text;
}

JudgeProgress progress_on_terminal() {
  const bool is_terminal = isatty(STDERR_FILENO) != 0;
  JudgeProgress progress;
  progress.begin = [is_terminal](int step, const std::string& what) {
    std::fprintf(stderr, "%s%d/%d %s\n", is_terminal ? "\r\033[K" : "", step, kJudgeSteps, what.c_str());
  };
  progress.update = [is_terminal](double done, const std::string& remark) {
    if (!is_terminal) return;
    std::fprintf(stderr, "\r\033[K    %3.0f %% %s", 100.0 * done, remark.c_str());
    if (done >= 1.0) std::fputs("\r\033[K", stderr);
  };
  return progress;
}

Result<void> configure(const JudgeRequest& request, config::Configuration& configuration) {
  hal::CameraSettings& camera = configuration.board.camera;
  if (request.board.empty()) {
    TOUCHLINE_TRY_ASSIGN(camera, choose_camera(request.device, request.mode));
    return {};
  }
  TOUCHLINE_TRY(config::load_board(request.board, request.overrides, configuration));
  if (!request.device.empty()) camera.device = request.device;
  if (!request.mode.empty()) TOUCHLINE_TRY(parse_mode(request.mode, camera));
  return {};
}

}  // namespace

int judge_command(const JudgeRequest& request) {
  const auto configuration = std::make_unique<config::Configuration>();  // too large for the stack
  if (const Result<void> configured = configure(request, *configuration); !configured.ok()) {
    return fail(kProgram, configured.text(), request.board.empty() ? kExitDeviceFailure : kExitBadFile);
  }
  config::BoardFile& board = configuration->board;
  const bool simulated = board.camera.backend == hal::CameraBackend::kMock;
  if (board.camera.backend == hal::CameraBackend::kReplay) {
    return fail(kProgram, request.board + ": camera.backend = \"replay\" is a recording; judge a camera");
  }
  // While a real camera is judged, no robot moves and no pin changes.
  board.radio.backend = simulated ? hal::RadioBackend::kMock : hal::RadioBackend::kNone;
  board.gpio.backend = hal::GpioBackend::kNone;
  if (simulated) ArenaHand::put_lid(board.arena);
  Devices devices;
  devices.make(*configuration, 1);
  const HalDevices hal = devices.hal_devices();
  std::optional<ArenaHand> hand;
  if (simulated && hal.radio.open().ok()) hand.emplace(hal.radio, hal.clock, board.arena.field);
  JudgeOptions options;
  if (!request.motion) options.motion_s = 0.0;
  const JudgeProgress progress = progress_on_terminal();
  const auto move = hand ? std::function<void()>([&hand] { hand->move(); }) : std::function<void()>();
  const Result<JudgeReport> report = judge(hal.camera, hal.clock, board.camera, options, progress, move);
  if (!report.ok()) return fail(kProgram, report.text(), kExitDeviceFailure);
  const JudgeReport& judged = report.value();
  if (!judged.info.description.empty()) std::printf("%s\n", judged.info.description.c_str());
  if (!judged.info.negotiated.empty()) std::printf("%s\n", judged.info.negotiated.c_str());
  std::printf("%s\n%s\n\nFor a hardware report (docs/hardware.md):\n\n```\n%s```\n", figures(judged).c_str(),
              verdict(judged).c_str(), hardware_report(judged, system_text(), TOUCHLINE_VERSION).c_str());
  return kExitOk;
}

}  // namespace touchline::devices
