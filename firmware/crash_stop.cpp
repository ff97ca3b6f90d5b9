#include "firmware/crash_stop.h"

#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <exception>

namespace touchline::crash_stop {
namespace {

// Number of stop packets, as at a normal end (firmware/loop.cpp).
constexpr int kStopPackets = 5;
constexpr long kPacketPause_ms = 20, kRetryPause_ms = 1, kDrainTime_ms = 500, kOtherThreadTime_ms = 1000;
// A datagram fails without effect if an error of an earlier one is pending, perhaps one for each robot.
constexpr std::size_t kDatagramAttempts = 1 + kMaxRobotsPerTeam;

enum class State : int { kIdle, kStopping, kStopped };
std::atomic<State> state{State::kIdle};
// prepare() writes one of the two while a handler may read the other one.
std::array<StopTargets, 2> prepared;
std::atomic<std::size_t> newest{0};
std::terminate_handler previous_terminate_handler = nullptr;
static_assert(std::atomic<State>::is_always_lock_free && std::atomic<std::size_t>::is_always_lock_free,
              "a signal handler must not lock");

void pause_ms(long milliseconds) noexcept {
  timespec left{milliseconds / 1000, milliseconds % 1000 * 1000000};
  while (::nanosleep(&left, &left) != 0 && errno == EINTR) continue;
}

void send_datagram(const StopTarget& target) noexcept {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(target.route.ipv4);
  to.sin_port = htons(target.route.port);
  const auto* const destination = reinterpret_cast<const sockaddr*>(&to);
  for (std::size_t i = 0; i < kDatagramAttempts; ++i) {
    if (::sendto(target.route.descriptor, target.bytes.data(), target.bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                 destination, sizeof(to)) >= 0) {
      return;
    }
  }
}

// Writes a packet. While the port is full, tries again for at most `time_ms`, which it reduces.
void write_packet(const StopTarget& target, long& time_ms) noexcept {
  const Packet& packet = target.bytes;
  for (std::size_t written = 0; written < packet.size();) {
    const ssize_t count = ::write(target.route.descriptor, packet.data() + written, packet.size() - written);
    if (count > 0) {
      written += static_cast<std::size_t>(count);
    } else if ((count < 0 && errno != EAGAIN && errno != EINTR) || time_ms <= 0) {
      return;
    } else {
      pause_ms(kRetryPause_ms);
      time_ms -= kRetryPause_ms;
    }
  }
}

void send_round(const StopTargets& targets) noexcept {
  // A port that is full must not delay the packets of the others.
  long time_ms = kPacketPause_ms;
  for (const StopTarget& target : targets) {
    if (target.route.is_datagram) send_datagram(target);
  }
  for (const StopTarget& target : targets) {
    if (!target.route.is_datagram) write_packet(target, time_ms);
  }
}

void wait_until_sent(const StopTargets& targets) noexcept {
  long time_ms = kDrainTime_ms;
  for (const StopTarget& target : targets) {
    int waiting = 0;
    while (time_ms > 0 && ::ioctl(target.route.descriptor, TIOCOUTQ, &waiting) == 0 && waiting != 0) {
      pause_ms(kRetryPause_ms);
      time_ms -= kRetryPause_ms;
    }
  }
}

void on_fatal_signal(int signal) {
  send_stop_packets();
  std::signal(signal, SIG_DFL);
  static_cast<void>(std::raise(signal));  // delivered when this handler returns
}

[[noreturn]] void on_terminate() {
  send_stop_packets();
  if (previous_terminate_handler != nullptr) previous_terminate_handler();
  std::abort();
}

void install(int signal) {
  struct sigaction current {};
  sigaction(signal, nullptr, &current);
  if (current.sa_handler == SIG_IGN) return;
  struct sigaction action {};
  action.sa_handler = on_fatal_signal;
  action.sa_flags = SA_ONSTACK;
  sigaction(signal, &action, nullptr);
}

}  // namespace

void install_handlers() {
  // AVX-512 registers alone take 2.5 KiB of a signal frame; sending takes some hundred bytes.
  alignas(64) static std::array<std::byte, std::size_t{64} * 1024> stack;
  stack_t signal_stack{};
  signal_stack.ss_sp = stack.data();
  signal_stack.ss_size = stack.size();
  static_cast<void>(::sigaltstack(&signal_stack, nullptr));
  for (const int signal : {SIGABRT, SIGALRM, SIGBUS, SIGFPE, SIGILL, SIGPOLL, SIGPROF, SIGPWR, SIGQUIT, SIGSEGV,
                           SIGSTKFLT, SIGSYS, SIGTRAP, SIGVTALRM, SIGXCPU, SIGXFSZ}) {
    install(signal);
  }
  previous_terminate_handler = std::set_terminate(on_terminate);
  static_cast<void>(std::atexit([] { send_stop_packets(); }));
}

// send_stop_packets() sets the state and then reads `newest`; this function reads the state and then overwrites the
// other list. In the order of these sequentially consistent operations, a call that overwrites a list has seen kIdle,
// so whoever stops reads an index that is at least as new as that of the call before, which is the other list.
void prepare(const StopTargets& targets) {
  if (is_stopping()) return;
  const std::size_t other = 1 - newest.load(std::memory_order_relaxed);
  prepared[other] = targets;
  newest.store(other);
}

void prepare(const hal::Radio& radio, const OutgoingPackets& stops) {
  StopTargets targets;
  for (const OutgoingPacket& outgoing : stops) {
    hal::RadioRoutes routes;
    radio.add_routes(outgoing.receiver, routes);
    for (const hal::RadioRoute& route : routes) targets.push_back({route, outgoing.packet});
  }
  prepare(targets);
}

bool is_stopping() { return state.load() != State::kIdle; }

void send_stop_packets() noexcept {
  if (prepared[newest.load()].empty()) return;
  State expected = State::kIdle;
  if (!state.compare_exchange_strong(expected, State::kStopping)) {
    for (long waited = 0; state.load() == State::kStopping && waited < kOtherThreadTime_ms; ++waited) pause_ms(1);
    return;
  }
  const int interrupted_errno = errno;
  const StopTargets& targets = prepared[newest.load()];
  for (int i = 0; i < kStopPackets; ++i) {
    if (i > 0) pause_ms(kPacketPause_ms);
    send_round(targets);
  }
  wait_until_sent(targets);
  state.store(State::kStopped);
  errno = interrupted_errno;
}

}  // namespace touchline::crash_stop
