#include "tools/programs/latency/planted_delay.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "hal/linux/monotonic_clock.h"
#include "tools/programs/latency/execution_meter.h"
#include "tools/programs/latency/latency_report.h"

namespace touchline::latency {
namespace {

constexpr std::array<std::string_view, 3> kWords{"stall", "preemption", "work"};

// ptrace stops a single thread and, unlike SIGSTOP, is invisible to the shell that started the program.
bool stop_thread(pid_t thread, Duration duration) {
  if (ptrace(PTRACE_SEIZE, thread, nullptr, nullptr) != 0) return false;
  if (ptrace(PTRACE_INTERRUPT, thread, nullptr, nullptr) != 0) return false;
  int status = 0;
  if (waitpid(thread, &status, __WALL) != thread) return false;
  hal::MonotonicClock::wait_for(hal::MonotonicClock::read() + duration);
  return ptrace(PTRACE_DETACH, thread, nullptr, nullptr) == 0;
}

// Answers each byte with 0 or an error number: the first byte starts a trial without a delay, every later byte starts
// the delay.
[[noreturn]] void run_helper(int socket, pid_t thread, Duration duration) {
  char byte = 0;
  for (Duration length{}; read(socket, &byte, 1) == 1; length = duration) {
    const char answer = stop_thread(thread, length) ? '\0' : static_cast<char>(errno);
    if (write(socket, &answer, 1) != 1) break;
  }
  _exit(0);
}

}  // namespace

PlantedDelay::~PlantedDelay() {
  if (to_helper_ >= 0) ::close(to_helper_);
  if (helper_ <= 0) return;
  kill(helper_, SIGKILL);
  waitpid(helper_, nullptr, 0);
}

std::string PlantedDelay::parse(const std::string& text) {
  const std::size_t sign = text.find('=');
  const std::string_view word = std::string_view(text).substr(0, sign);
  std::size_t kind = 0;
  while (kind < kWords.size() && kWords[kind] != word) ++kind;
  char* end = nullptr;
  const char* const number = sign == std::string::npos ? "" : text.c_str() + sign + 1;
  const double ms = std::strtod(number, &end);
  if (kind == kWords.size() || end == number || *end != '\0' || !(ms >= 0.1 && ms <= 10000.0)) {
    return text + ": must be stall=MS, preemption=MS or work=MS with 0.1 to 10000 milliseconds";
  }
  kind_ = static_cast<Kind>(kind);
  duration_ = from_seconds(ms * 1e-3);
  return "";
}

std::string PlantedDelay::description() const {
  if (duration_ == Duration::zero()) return "";
  return std::string(kWords[static_cast<std::size_t>(kind_)]) + " of " + text_of(duration_) + " in marker";
}

Result<void> PlantedDelay::prepare(std::uint64_t frame) {
  frame_ = frame;
  if (duration_ == Duration::zero() || kind_ != Kind::kPreemption) return {};
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return failure(ErrorCode::kIo, "--plant: %s", std::strerror(errno));
  }
  const pid_t thread = gettid();
  helper_ = fork();
  if (helper_ == 0) {
    ::close(ends[0]);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    run_helper(ends[1], thread, duration_);
  }
  const int fork_error = errno;
  ::close(ends[1]);
  to_helper_ = ends[0];
  if (helper_ < 0) return failure(ErrorCode::kIo, "--plant: %s", std::strerror(fork_error));
  prctl(PR_SET_PTRACER, helper_);  // fails on kernels without Yama, which do not forbid ptrace either
  char answer = 0;
  if (write(to_helper_, "", 1) != 1 || read(to_helper_, &answer, 1) != 1 || answer != 0) {
    return failure(ErrorCode::kPermission, "--plant preemption needs ptrace, which this system forbids: %s",
                   std::strerror(answer));
  }
  return {};
}

std::function<void(std::uint64_t)> PlantedDelay::intrusion() {
  if (duration_ == Duration::zero()) return {};
  return [this](std::uint64_t frame) {
    if (frame == frame_) delay();
  };
}

void PlantedDelay::delay() const {
  using hal::MonotonicClock;
  const Instant begin = MonotonicClock::read();
  switch (kind_) {
    case Kind::kStall:
      MonotonicClock::wait_for(begin + duration_);
      return;
    case Kind::kWork:
      for (const Duration start = ExecutionMeter::processor_time();
           ExecutionMeter::processor_time() - start < duration_;) {
      }
      return;
    case Kind::kPreemption:
      break;
  }
  if (write(to_helper_, "", 1) != 1) return;
  // Loops until the helper reports that it has stopped this thread and let it continue. The helper usually wakes up on
  // this processor. Without the yield, it would wait for the end of this thread's time slice, milliseconds that would
  // count as execution of the marker stage. If the helper gets no processor or fails, the limit keeps the loop from
  // hanging.
  constexpr Duration kLongest = std::chrono::seconds(2);
  const auto is_over = [this] {
    char answer = 1;
    return recv(to_helper_, &answer, 1, MSG_DONTWAIT) == 1 && answer == 0;
  };
  while (!is_over() && MonotonicClock::read() - begin < kLongest + duration_) sched_yield();
}

}  // namespace touchline::latency
