#include "firmware/run_marker.h"

#include <fcntl.h>
#include <unistd.h>
#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace touchline {

RunMarker RunMarker::of_service() {
  const char* const folder = std::getenv("RUNTIME_DIRECTORY");
  return RunMarker(folder != nullptr ? folder : "");
}

bool RunMarker::exists() const { return !path_.empty() && ::access(path_.c_str(), F_OK) == 0; }

Result<void> RunMarker::create() const {
  if (path_.empty()) return {};
  const int file = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (file >= 0) {
    ::close(file);
    return {};
  }
  return failure(ErrorCode::kIo, "%s: cannot be created: %s; without it, robots would move again after a crash",
                 path_.c_str(), std::strerror(errno));
}

void RunMarker::remove() const {
  if (!path_.empty()) ::unlink(path_.c_str());
}

}  // namespace touchline
