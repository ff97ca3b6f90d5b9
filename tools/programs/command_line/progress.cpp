#include "tools/programs/command_line/progress.h"

#include <unistd.h>
#include <cstdio>
#include <utility>

namespace touchline {

Progress::Progress(std::string what, std::size_t steps) : what_(std::move(what)), steps_(steps) {}

Progress::~Progress() {
  if (shown_) std::fprintf(stderr, "\r\033[K");
}

void Progress::step() {
  ++done_;
  if (std::chrono::steady_clock::now() - begin_ < std::chrono::seconds(1) || isatty(STDERR_FILENO) == 0) return;
  shown_ = true;
  std::fprintf(stderr, "\r%s: %zu of %zu", what_.c_str(), done_, steps_);
}

}  // namespace touchline
