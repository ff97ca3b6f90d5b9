#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <string>
#include <utility>

namespace touchline::testing {

struct CommandOutput {
  int code = -1;     // -1: a signal ended the command
  std::string text;  // standard output of the command
};

/// Runs a shell command. With "2>&1" in the command, the text includes standard error.
inline CommandOutput run_command(const std::string& command) {
  CommandOutput output;
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 4096> block{};
  while (const std::size_t size = std::fread(block.data(), 1, block.size(), pipe)) {
    output.text.append(block.data(), size);
  }
  const int status = ::pclose(pipe);
  output.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return output;
}

/// Returns the standard output of a shell command; empty if it failed.
inline std::string output_of(const std::string& command) {
  CommandOutput output = run_command(command);
  return output.code == 0 ? std::move(output.text) : std::string();
}

/// Sends SIGTERM to a child and returns its exit code. -1: a signal ended it, or it did not end in time and was killed.
inline int exit_code_after_termination(pid_t process, int timeout_s) {
  constexpr useconds_t kPause_us = 10'000;
  ::kill(process, SIGTERM);
  int status = 0;
  for (int i = 0; i < 100 * timeout_s; ++i) {
    if (::waitpid(process, &status, WNOHANG) == process) return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    ::usleep(kPause_us);
  }
  ::kill(process, SIGKILL);
  ::waitpid(process, &status, 0);
  return -1;
}

}  // namespace touchline::testing
