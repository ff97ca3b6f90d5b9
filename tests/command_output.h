#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>
#include <utility>

namespace touchline::testing {

struct CommandOutput {
  int code = -1;     // -1: a signal ended the command
  std::string text;  // its standard output
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

/// The standard output of a shell command; empty if it failed.
inline std::string output_of(const std::string& command) {
  CommandOutput output = run_command(command);
  return output.code == 0 ? std::move(output.text) : std::string();
}

}  // namespace touchline::testing
