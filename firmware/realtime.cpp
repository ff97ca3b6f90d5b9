#include "firmware/realtime.h"

#include <fcntl.h>
#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>

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
  asm volatile("" : : "r"(stack) : "memory");  // without this, the compiler removes the writes
}

std::vector<std::string> lock_memory(const config::RealtimeSettings& settings) {
  if (!settings.lock_memory) return {};
  // Freed memory stays with the process: after a return to the kernel, its next use would cause page faults.
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
  // By default the kernel wakes ordinary threads up to 50 us late to combine wake-ups; 0 would select this default.
  if (prctl(PR_SET_TIMERSLACK, 1UL) != 0) {
    refused.push_back(refusal("the timer slack of the loop remains 50 us", errno,
                              "a real-time priority also removes it (realtime.priority)"));
  }
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

NormalScheduling::NormalScheduling() {
  static_cast<void>(pthread_getaffinity_np(pthread_self(), sizeof processors_, &processors_));
  static_cast<void>(pthread_getschedparam(pthread_self(), &policy_, &parameters_));
}

void NormalScheduling::restore() const {
  // The kernel permits a thread to give up its priority.
  static_cast<void>(pthread_setschedparam(pthread_self(), policy_, &parameters_));
  static_cast<void>(pthread_setaffinity_np(pthread_self(), sizeof processors_, &processors_));
}

CpuLatencyRequest::CpuLatencyRequest(const config::RealtimeSettings& settings, const std::string& root) {
  if (settings.wake_within_us < 0) return;
  const std::string path = root + "/dev/cpu_dma_latency";
  // The kernel's PM QoS interface: a 32-bit number that applies while the file is open.
  const auto microseconds = static_cast<std::int32_t>(settings.wake_within_us);
  file_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file_ >= 0 && ::write(file_, &microseconds, sizeof microseconds) == sizeof microseconds) return;
  refused_.push_back(refusal("processors may sleep deeply between frames (" + path + ")", errno,
                             "let the user write that file, as boards/x86-usb/README.md shows, or set "
                             "realtime.wake_within_us = -1"));
}

CpuLatencyRequest::~CpuLatencyRequest() {
  if (file_ >= 0) ::close(file_);
}

bool is_realtime() { return ::sched_getscheduler(0) == SCHED_FIFO; }

std::vector<std::string> realtime_hints(const config::RealtimeSettings& settings, bool realtime,
                                        const std::string& root) {
  std::vector<std::string> hints;
  if (settings.cpu < 0 && settings.priority == 0) return hints;
  const std::string processor = std::to_string(settings.cpu >= 0 ? settings.cpu : ::sched_getcpu());
  const std::string path = "/sys/devices/system/cpu/cpu" + processor + "/cpufreq/scaling_governor";
  std::string governor;
  if (std::ifstream(root + path) >> governor && governor != "performance") {
    hints.push_back("processor " + processor + " slows down between frames (governor " + governor +
                    "); cpupower frequency-set -g performance, or: echo performance | sudo tee " + path);
  }
  long runtime_us = -1, period_us = 0;
  std::ifstream(root + "/proc/sys/kernel/sched_rt_runtime_us") >> runtime_us;
  std::ifstream(root + "/proc/sys/kernel/sched_rt_period_us") >> period_us;
  if (realtime && runtime_us >= 0 && runtime_us < period_us) {
    hints.push_back("a loop that is never idle is paused for " + std::to_string((period_us - runtime_us) / 1000) +
                    " ms of every " + std::to_string(period_us / 1000) +
                    " ms; if other programs have their own processors: "
                    "sudo sysctl -w kernel.sched_rt_runtime_us=-1");
  }
  return hints;
}

}  // namespace touchline
