#include "tools/programs/latency/background_load.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <thread>

namespace touchline::latency {
namespace {

using namespace std::chrono_literals;

constexpr std::array kArguments{"--cpu", "0",     "--cache", "1",           "--vm", "1",      "--vm-bytes",
                                "128m",  "--hdd", "1",       "--hdd-bytes", "16m",  "--quiet"};

// Waits up to `timeout` for `process` to end.
bool has_ended(pid_t process, std::chrono::milliseconds timeout) {
  constexpr auto kStep = 10ms;
  for (auto waited = 0ms;; waited += kStep) {
    if (waitpid(process, nullptr, WNOHANG) != 0) return true;
    if (waited >= timeout) return false;
    std::this_thread::sleep_for(kStep);
  }
}

}  // namespace

std::string BackgroundLoad::description() {
  std::string text = "stress-ng";
  for (const char* argument : kArguments) text += std::string(" ") + argument;
  return text;
}

Result<void> BackgroundLoad::start(const std::string& program) {
  // Allocate everything before fork(), because the child must not allocate.
  std::error_code missing;
  const std::string folder = std::filesystem::temp_directory_path(missing).string();
  if (missing) {
    return failure(ErrorCode::kIo, "--load: the folder for temporary files (TMPDIR): %s", missing.message().c_str());
  }
  std::array<char*, kArguments.size() + 4> arguments{};
  std::size_t count = 0;
  const auto append = [&](const char* text) { arguments[count++] = const_cast<char*>(text); };
  append(program.c_str());
  for (const char* argument : kArguments) append(argument);
  append("--temp-path");
  append(folder.c_str());
  std::array<int, 2> pipe{};
  if (pipe2(pipe.data(), O_CLOEXEC) != 0) {
    return failure(ErrorCode::kIo, "--load: %s", std::strerror(errno));
  }
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ == 0) {
    // Use a separate process group, so that Ctrl-C reaches only this program, which then ends the load.
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() == parent) execvp(arguments[0], arguments.data());
    const int reason = errno;
    static_cast<void>(!write(pipe[1], &reason, sizeof reason));
    _exit(127);
  }
  const int fork_error = errno;
  close(pipe[1]);
  int reason = process_ < 0 ? fork_error : 0;
  // A successful exec closes the pipe, and nothing is read.
  if (process_ > 0) static_cast<void>(!read(pipe[0], &reason, sizeof reason));
  close(pipe[0]);
  const bool ended = reason == 0 && has_ended(process_, 1s);
  if (reason == 0 && !ended) return {};
  if (ended) process_ = -1;
  static_cast<void>(stop());
  if (ended) {
    return failure(ErrorCode::kIo, "--load: %s ended immediately; run it separately: %s", program.c_str(),
                   description().c_str());
  }
  if (reason == ENOENT) {
    return failure(ErrorCode::kNotFound, "--load needs %s, which is not installed: sudo apt install stress-ng",
                   program.c_str());
  }
  return failure(ErrorCode::kIo, "--load cannot start %s: %s", program.c_str(), std::strerror(reason));
}

bool BackgroundLoad::stop() {
  if (process_ <= 0) return true;
  const pid_t process = process_;
  process_ = -1;
  if (has_ended(process, 0ms)) return false;
  kill(process, SIGTERM);  // stress-ng then ends its workers
  if (!has_ended(process, 5s)) {
    kill(-process, SIGKILL);
    waitpid(process, nullptr, 0);
  }
  return true;
}

}  // namespace touchline::latency
