#include "tools/programs/latency/kernel_trace.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace touchline::latency {

KernelTrace::~KernelTrace() {
  for (const int file : {tracing_on_, marker_}) {
    if (file >= 0) ::close(file);
  }
}

Result<void> KernelTrace::open(Duration limit, const std::string& folder) {
  limit_ = limit;
  const std::string path = folder + "/tracing_on";
  tracing_on_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (tracing_on_ < 0) {
    return failure(errno == EACCES || errno == EPERM ? ErrorCode::kPermission : ErrorCode::kNotFound,
                   "--stop-trace-ms: %s: %s; mount tracefs and run as root", path.c_str(), std::strerror(errno));
  }
  marker_ = ::open((folder + "/trace_marker").c_str(), O_WRONLY | O_CLOEXEC);
  return {};
}

void KernelTrace::check(std::uint64_t number, Duration latency) {
  if (tracing_on_ < 0 || stopped_at_ != 0 || latency <= limit_) return;
  std::array<char, 96> text{};
  const int length =
      std::snprintf(text.data(), text.size(), "touchline-latency: frame %llu took %lld us\n",
                    static_cast<unsigned long long>(number), static_cast<long long>(latency.count() / 1000));
  if (marker_ >= 0) static_cast<void>(!::write(marker_, text.data(), static_cast<std::size_t>(length)));
  if (::write(tracing_on_, "0", 1) == 1) stopped_at_ = number;
}

}  // namespace touchline::latency
