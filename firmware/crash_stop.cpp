#include "firmware/crash_stop.h"

#include <sys/ioctl.h>
#include <unistd.h>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <exception>

#include "core/radio/packet.h"

namespace touchline::crash_stop {
namespace {

// Number of stop packets, as at a normal end (firmware/loop.cpp).
constexpr int kStopPackets = 5;
constexpr long kPacketPause_ms = 20, kRetryPause_ms = 1, kDrainTime_ms = 500, kOtherThreadTime_ms = 1000;
// A packet begins with "TL", version, flags, sequence, and the byte that packet_team() reads (docs/radio.md).
constexpr std::size_t kSequenceOffset = 4, kMinBytes = 6;

enum class State : int { kIdle, kStopping, kStopped };
std::atomic<State> state{State::kIdle};
std::atomic<int> radio{-1};
std::atomic<std::uint8_t> last_sequence{0}, last_team{kNoTeamNumber};
std::terminate_handler previous_terminate_handler = nullptr;
static_assert(std::atomic<State>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
                  std::atomic<std::uint8_t>::is_always_lock_free,
              "a signal handler must not lock");

void pause_ms(long milliseconds) noexcept {
  timespec left{milliseconds / 1000, milliseconds % 1000 * 1000000};
  while (::nanosleep(&left, &left) != 0 && errno == EINTR) continue;
}

// Writes a packet. If the port is full, tries again until the next packet is due.
void write_packet(int descriptor, const Packet& packet) noexcept {
  std::size_t written = 0;
  for (long waited = 0; written < packet.size() && waited < kPacketPause_ms; waited += kRetryPause_ms) {
    const ssize_t count = ::write(descriptor, packet.data() + written, packet.size() - written);
    if (count > 0) {
      written += static_cast<std::size_t>(count);
    } else if (count < 0 && errno != EAGAIN && errno != EINTR) {
      return;
    } else {
      pause_ms(kRetryPause_ms);
    }
  }
}

void wait_until_sent(int descriptor) noexcept {
  for (long waited = 0; waited < kDrainTime_ms; waited += kRetryPause_ms) {
    int waiting = 0;
    if (::ioctl(descriptor, TIOCOUTQ, &waiting) != 0 || waiting == 0) return;
    pause_ms(kRetryPause_ms);
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
  // AVX-512 registers alone take 2.5 KiB of a signal frame; encoding a packet takes some hundred bytes.
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

void set_radio(int descriptor) { radio.store(descriptor, std::memory_order_release); }

void record_sent(const Packet& packet) {
  if (packet.size() < kMinBytes) return;
  last_sequence.store(std::to_integer<std::uint8_t>(packet[kSequenceOffset]), std::memory_order_relaxed);
  last_team.store(packet_team({packet.data(), packet.size()}), std::memory_order_relaxed);
}

bool is_stopping() { return state.load(std::memory_order_acquire) != State::kIdle; }

void send_stop_packets() noexcept {
  const int descriptor = radio.load(std::memory_order_acquire);
  if (descriptor < 0) return;
  State expected = State::kIdle;
  if (!state.compare_exchange_strong(expected, State::kStopping)) {
    for (long waited = 0; state.load() == State::kStopping && waited < kOtherThreadTime_ms; ++waited) pause_ms(1);
    return;
  }
  const int interrupted_errno = errno;
  std::uint8_t sequence = last_sequence.load(std::memory_order_relaxed);
  const TeamNumber team = last_team.load(std::memory_order_relaxed);
  Commands stop;
  stop.stop = true;  // with an empty list: all robots
  Packet packet;
  for (int i = 0; i < kStopPackets; ++i) {
    if (i > 0) pause_ms(kPacketPause_ms);
    if (encode(stop, ++sequence, packet, team).ok()) write_packet(descriptor, packet);
  }
  wait_until_sent(descriptor);
  state.store(State::kStopped);
  errno = interrupted_errno;
}

}  // namespace touchline::crash_stop
