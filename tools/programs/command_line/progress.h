#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace touchline {

/// Shows "pictures: 3 of 12" on a terminal if the work takes longer than a second. Prints nothing if standard error is
/// not a terminal.
class Progress {
 public:
  Progress(std::string what, std::size_t steps);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Counts one step as done.
  void step();

 private:
  std::string what_;
  std::size_t steps_, done_ = 0;
  bool shown_ = false;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace touchline
