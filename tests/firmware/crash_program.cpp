// Runs a loop that drives a robot over the serial line given as the first argument. The second argument says how the
// process ends. Further arguments are UDP ports of this computer to which the packets are sent at the same time.
#undef NDEBUG  // an assertion that fails
#include <fcntl.h>
#include <sys/resource.h>
#include <termios.h>
#include <unistd.h>
#include <cassert>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "firmware/crash_stop.h"
#include "firmware/radio_group.h"
#include "hal/linux/monotonic_clock.h"
#include "hal/linux/network/udp_radio.h"
#include "tests/firmware/loop_fixture.h"

namespace touchline::testing {
namespace {

/// Writes packets to a terminal as to a serial port.
class TerminalRadio final : public hal::Radio {
 public:
  explicit TerminalRadio(const char* device) : file_(::open(device, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    termios line{};
    ::tcgetattr(file_, &line);
    ::cfmakeraw(&line);
    ::tcsetattr(file_, TCSANOW, &line);
  }
  void add_routes(std::size_t /*receiver*/, hal::RadioRoutes& out) const override {
    out.push_back({.descriptor = file_});
  }

 private:
  Result<void> do_open() override {
    if (file_ >= 0) return {};
    return failure(ErrorCode::kNotFound, "no terminal");
  }
  Result<void> do_send(const Packet& packet, std::size_t /*receiver*/) override {
    if (::write(file_, packet.data(), packet.size()) == static_cast<ssize_t>(packet.size())) return {};
    return failure(ErrorCode::kIo, "the terminal is full");
  }
  Result<Duration> do_serve() override { return Duration::max(); }
  Result<std::size_t> do_receive(std::span<std::byte> /*into*/, std::size_t& /*sender*/) override {
    return std::size_t{0};
  }
  Result<void> do_drain(Instant) override { return {}; }
  void do_close() override {}
  int file_;
};

// The function must neither be called in tail position nor have a result that the compiler knows.
int overflow_stack(int depth) {
  if (depth < 0) return 0;
  volatile char block[4096] = {};
  block[0] = static_cast<char>(depth);
  return overflow_stack(depth + 1) + block[0];
}

using Ending = void (*)();
const std::map<std::string_view, Ending> kEndings{
    {"abort", [] { std::abort(); }},
    {"assertion", [] { assert(std::getenv("PATH") == nullptr); }},
    {"exception-in-loop", [] { throw std::runtime_error("a driver failed"); }},
    {"exception-in-thread", [] { std::thread([] { throw std::bad_alloc(); }).detach(); }},
    {"exit", [] { std::exit(3); }},
    {"quit", [] { static_cast<void>(std::raise(SIGQUIT)); }},
    {"segmentation-fault", [] { *static_cast<volatile int*>(nullptr) = 1; }},
    {"stack-overflow", [] { std::printf("%d", overflow_stack(0)); }},
    {"none", [] {}},
};

struct Context {
  Ending end;
  int steps = 0;
};

void end_after_20_frames(void* context, const StepTrace&, const StepTiming&) {
  Context& seen = *static_cast<Context*>(context);
  if (++seen.steps == 20) seen.end();
}

}  // namespace
}  // namespace touchline::testing

int main(int argc, char** argv) {
  using namespace touchline;
  using namespace touchline::testing;
  if (argc < 3 || !kEndings.contains(argv[2])) return 64;
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  crash_stop::install_handlers();
  hal::MonotonicClock clock;
  FakeCamera camera(clock);
  camera.show_robot();
  std::vector<GroupMember> radios;
  radios.push_back({std::make_unique<TerminalRadio>(argv[1]), std::bitset<kMaxReceivers>().set()});
  hal::UdpRadioSettings network;
  for (int i = 3; i < argc; ++i) {
    network.robots[static_cast<std::size_t>(i - 3)] = {0x7f000001, static_cast<std::uint16_t>(std::atoi(argv[i]))};
  }
  if (argc > 3) radios.push_back({std::make_unique<hal::UdpRadio>(network), std::bitset<kMaxReceivers>().set()});
  RadioGroup radio(std::move(radios), clock, std::chrono::seconds(1), false);
  FakeGpio gpio(clock);
  const auto pipeline = std::make_unique<Pipeline>();
  PipelineParameters parameters = fake_camera_parameters();
  parameters.radio = touchline_layout(7);
  if (!pipeline->configure(parameters).ok()) return 65;
  const auto ring = std::make_unique<ReportRing>();
  LoopSettings settings;
  settings.frames = 100;
  Context context{kEndings.find(argv[2])->second};
  Loop loop({camera, radio, gpio, clock}, *pipeline, settings, *ring, {end_after_20_frames, &context});
  if (!loop.open().ok()) return 66;
  const std::atomic<bool> stop{false};
  static_cast<void>(loop.run(stop));
  return 0;
}
