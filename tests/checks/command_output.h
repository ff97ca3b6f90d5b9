#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace touchline::checks {

/// Runs a shell command and returns its output; empty if it failed.
inline std::string output_of(const std::string& command) {
  std::string text;
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return text;
  std::array<char, 4096> block{};
  while (const std::size_t size = std::fread(block.data(), 1, block.size(), pipe)) text.append(block.data(), size);
  return ::pclose(pipe) == 0 ? text : std::string();
}

}  // namespace touchline::checks
