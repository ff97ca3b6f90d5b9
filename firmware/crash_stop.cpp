#include "firmware/crash_stop.h"

#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <exception>

namespace touchline::crash_stop {
namespace {

// Number of stop packets, as at a normal end (firmware/loop.cpp).
constexpr int kStopPackets = 5;
constexpr long kPacketPause_ms = 20, kRetryPause_ms = 1, kDrainTime_ms = 500;
// No round but the first one begins if it would end later than this, which is well before the 5 s after which the
// service's watchdog kills this process (toolchain/package/touchline.service).
constexpr long kRoundsTime_ms = 1000;
// What another thread waits for the first one: its rounds without their first one, the pauses, and the drain time.
constexpr long kOtherThreadTime_ms = kRoundsTime_ms + kDrainTime_ms + 500;
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

Instant now() noexcept {
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return Instant(std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec));
}

/// A serial port while stop packets are written to it.
struct Line {
  int descriptor = -1;
  hal::LineTime time;
  Duration round{};    // what the packets of a round take
  Instant free_at{};   // when its robots can tell the next packet from the one before
  bool waits = false;  // its next packet cannot be written yet
};
using Lines = FixedVector<Line, StopTargets::capacity()>;

Line& line_of(Lines& lines, const StopTarget& target) noexcept {
  for (Line& line : lines) {
    if (line.descriptor == target.route.descriptor) return line;
  }
  lines.push_back({target.route.descriptor, target.route.line});
  return lines.back();
}

/// Finds the ports. Those with pauses begin with one: the last byte of the loop's packets may just have left, or one
/// packet may still be in the driver, because SerialRadio gives it no second one.
void find_lines(const StopTargets& targets, Lines& lines) noexcept {
  const Instant begin = now();
  for (const StopTarget& target : targets) {
    if (target.route.is_datagram) continue;
    Line& line = line_of(lines, target);
    if (line.time.pause <= Duration::zero()) continue;
    const Duration time = line.time.of(target.bytes.size()) + line.time.pause;
    line.round += time;
    line.free_at = std::max(line.free_at, begin + time);
  }
}

Duration longest_round(const Lines& lines) noexcept {
  Duration longest{};
  for (const Line& line : lines) longest = std::max(longest, line.round);
  return longest;
}

enum class Written : std::uint8_t { kPart, kAll, kFailed };

Written write_packet(const StopTarget& target, std::size_t& written) noexcept {
  const Packet& packet = target.bytes;
  while (written < packet.size()) {
    const ssize_t count = ::write(target.route.descriptor, packet.data() + written, packet.size() - written);
    if (count > 0) {
      written += static_cast<std::size_t>(count);
    } else if (count == 0 || errno == EAGAIN || errno == EINTR) {
      return Written::kPart;
    } else {
      return Written::kFailed;
    }
  }
  return Written::kAll;
}

/// Writes each packet once. Each line gets its packets in their order, with its pauses; lines do not wait for each
/// other. A full port is tried again for at most 20 ms more than the pauses take.
void send_round(const StopTargets& targets, Lines& lines, Duration round) noexcept {
  for (const StopTarget& target : targets) {
    if (target.route.is_datagram) send_datagram(target);
  }
  std::array<std::size_t, StopTargets::capacity()> written{};
  std::array<bool, StopTargets::capacity()> done{};
  Instant begin = now();
  for (const Line& line : lines) begin = std::max(begin, line.free_at);
  for (const Instant end = begin + round + std::chrono::milliseconds(kPacketPause_ms);;) {
    bool waits = false;
    for (Line& line : lines) line.waits = false;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (targets[i].route.is_datagram || done[i]) continue;
      Line& line = line_of(lines, targets[i]);
      line.waits = line.waits || now() < line.free_at;
      if (!line.waits) {
        const Written result = write_packet(targets[i], written[i]);
        done[i] = result != Written::kPart;
        line.waits = !done[i];
        if (result == Written::kAll && line.time.pause > Duration::zero()) {
          line.free_at = now() + line.time.of(targets[i].bytes.size()) + line.time.pause;
        }
      }
      waits = waits || line.waits;
    }
    if (!waits || now() >= end) return;
    pause_ms(kRetryPause_ms);
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
  const StopTargets& latest = prepared[newest.load()];
  if (latest.empty()) return;
  State expected = State::kIdle;
  if (!state.compare_exchange_strong(expected, State::kStopping)) {
    Lines lines;
    find_lines(latest, lines);
    const Instant end = now() + std::chrono::milliseconds(kOtherThreadTime_ms) + 2 * longest_round(lines);
    while (state.load() == State::kStopping && now() < end) pause_ms(kRetryPause_ms);
    return;
  }
  const int interrupted_errno = errno;
  const StopTargets& targets = prepared[newest.load()];
  Lines lines;
  find_lines(targets, lines);
  const Duration round = longest_round(lines);
  const Instant last_begin = now() + std::chrono::milliseconds(kRoundsTime_ms) - round;
  for (int i = 0; i < kStopPackets && (i == 0 || now() <= last_begin); ++i) {
    if (i > 0) pause_ms(kPacketPause_ms);
    send_round(targets, lines, round);
  }
  wait_until_sent(targets);
  state.store(State::kStopped);
  errno = interrupted_errno;
}

}  // namespace touchline::crash_stop
