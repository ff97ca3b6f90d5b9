#include "firmware/realtime.h"

#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <cerrno>
#include <cstring>

namespace touchline {
namespace {

std::string refusal(const std::string& what, int error, const std::string& remedy) {
  return what + ": " + std::strerror(error) + "; " + remedy;
}

}  // namespace

[[gnu::noinline]] void prefault_stack() {
  constexpr std::size_t kPage = 4096;
  std::byte stack[kStackBytes];
  for (std::size_t i = 0; i < kStackBytes; i += kPage) stack[i] = std::byte{0};
  asm volatile("" : : "r"(stack) : "memory");  // else the compiler sees that nobody reads them
}

std::vector<std::string> lock_memory(const config::RealtimeSettings& settings) {
  if (!settings.lock_memory) return {};
  // Memory that is given back to the kernel would fault again when it is next used.
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return {};
  return {refusal("memory is not locked", errno,
                  "give the program CAP_IPC_LOCK, or raise the limit of locked memory (ulimit -l)")};
}

std::vector<std::string> become_realtime(const config::RealtimeSettings& settings) {
  std::vector<std::string> refused;
  if (settings.cpu >= 0) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(settings.cpu), &set);
    if (const int error = pthread_setaffinity_np(pthread_self(), sizeof set, &set); error != 0) {
      refused.push_back(refusal("the loop is not pinned to processor " + std::to_string(settings.cpu), error,
                                "realtime.cpu must be one that this machine has and the process may use"));
    }
  }
  prefault_stack();
  if (settings.priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = settings.priority;
    if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters); error != 0) {
      refused.push_back(refusal("no SCHED_FIFO priority " + std::to_string(settings.priority), error,
                                "give the program CAP_SYS_NICE, or raise the limit of real-time priority (ulimit -r)"));
    }
  }
  return refused;
}

}  // namespace touchline
