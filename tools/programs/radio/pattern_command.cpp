#include <unistd.h>

#include <array>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>

#include "core/radio/packet.h"
#include "firmware/config/packet_text.h"
#include "firmware/crash_stop.h"
#include "firmware/devices.h"
#include "firmware/signals.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/radio/radio_commands.h"

namespace touchline::radio {
namespace {

using namespace std::chrono_literals;

constexpr Duration kPacketPause = 20ms;
constexpr int kFinalStops = 5, kStarts = 3;  // as touchline

int fail_radio(const std::string& message, int exit_code) { return fail("touchline-radio", message, exit_code); }

// The open radio. However this object ends, the robots get stop packets before.
class RobotLink {
 public:
  RobotLink(hal::Radio& radio, hal::Clock& clock, const PacketLayout& layout)
      : radio_(radio), clock_(clock), layout_(layout) {}
  RobotLink(const RobotLink&) = delete;
  RobotLink& operator=(const RobotLink&) = delete;
  ~RobotLink() {
    Commands stop;
    for (int i = 0; i < kFinalStops; ++i) {
      static_cast<void>(send(stop));
      pause(kPacketPause);
    }
    static_cast<void>(radio_.drain(clock_.now() + 1s));
    crash_stop::prepare({});
    radio_.close();
  }

  Result<void> send(const Commands& commands) {
    if (crash_stop::is_stopping()) return {};
    const Instant now = clock_.now();
    // The bytes for the start come before the first packets, as in the pipeline.
    const PacketValues values{commands.stop, sequence_ < kStarts, sequence_, now};
    ++sequence_;
    Commands stop;
    if (!encode(layout_, stop, {true, false, sequence_, now}, packets_).ok()) return {};
    crash_stop::prepare(radio_, packets_);
    if (!encode(layout_, commands, values, packets_).ok()) return {};
    for (const OutgoingPacket& outgoing : packets_) {
      const Result<void> sent = radio_.send(outgoing.packet, outgoing.receiver);
      if (!sent.ok() && sent.code() != ErrorCode::kBusy) return sent.error();
    }
    return {};
  }
  /// Waits, and sends a packet that waits for the line.
  void pause(Duration duration) {
    const Instant end = clock_.now() + duration;
    while (clock_.now() < end) {
      const Result<Duration> due = radio_.serve();
      clock_.sleep_until(
          std::min(end, clock_.now() + (due.ok() ? std::min<Duration>(due.value(), duration) : duration)));
    }
  }
  /// The last packet for the robot `id`, or for all robots.
  [[nodiscard]] std::span<const std::byte> last_packet(RobotId id) const {
    for (const OutgoingPacket& outgoing : packets_) {
      const bool is_for_all = outgoing.receiver == kAllRobots;
      if (is_for_all || layout_.receivers[outgoing.receiver].id == id) {
        return {outgoing.packet.data(), outgoing.packet.size()};
      }
    }
    return {};
  }

 private:
  hal::Radio& radio_;
  hal::Clock& clock_;
  const PacketLayout& layout_;
  OutgoingPackets packets_;
  std::uint32_t sequence_ = 0;
};

void show(double time_s, const char* direction, std::size_t count, const std::string& fields) {
  std::printf("%.3f s  %s %zu bytes\n%s", time_s, direction, count, fields.c_str());
}

}  // namespace

bool is_confirmed(const char* question) {
  if (::isatty(STDIN_FILENO) == 0) return false;
  std::cerr << question << " [y/N] " << std::flush;
  std::string answer;
  return std::getline(std::cin, answer) && (answer == "y" || answer == "yes");
}

int send_pattern(const RadioOptions& options, Pattern pattern) {
  const auto session = std::make_unique<Session>();
  // Neither camera nor field are needed.
  if (const Result<void> loaded = session->load_uncalibrated(options.session); !loaded.ok()) {
    std::cerr << loaded.text() << '\n';
    return kExitBadFile;
  }
  const config::Configuration& configuration = session->configuration();
  if (configuration.board.radio.backend == hal::RadioBackend::kNone) {
    return fail_radio(configuration.board_where.file() + ": radio.backend = \"none\": choose the radio first",
                      kExitBadFile);
  }
  const double duration_s = options.duration_s > 0.0 ? options.duration_s : kPatternDuration_s;
  const double speed_mps = options.speed_mps > 0.0 ? options.speed_mps : kPatternSpeed_mps;
  std::fprintf(stderr, "robot %d, %.1f s at %.2f m/s: %s\nAll other robots get no command and stand.\n", options.robot,
               duration_s, speed_mps, expectation_of(pattern));
  if (!options.yes && !is_confirmed("Are the robot's wheels in the air?")) {
    return fail_radio("nothing was sent: answer y, or use --yes", kExitBadCommandLine);
  }
  crash_stop::install_handlers();
  const std::atomic<bool>& stop = handle_stop_signals();
  Devices devices;
  if (const Result<void> made = devices.make(configuration, options.session.seed); !made.ok()) {
    return fail_radio(made.text(), kExitBadFile);
  }
  const HalDevices hal = devices.hal_devices();
  const bool has_emergency_stop = configuration.board.gpio.emergency_stop_line != hal::kNoLine;
  if (has_emergency_stop) {
    if (const Result<void> opened = hal.gpio.open(); !opened.ok()) {
      return fail_radio(std::string("emergency stop: ") + std::string(opened.text()), kExitDeviceFailure);
    }
  }
  if (const Result<void> opened = hal.radio.open(); !opened.ok()) {
    return fail_radio(opened.text(), kExitDeviceFailure);
  }
  if (!hal.radio.description().empty()) std::printf("%s\n", hal.radio.description().c_str());
  const PacketLayout& layout = configuration.pipeline.radio;
  RobotLink link(hal.radio, hal.clock, layout);
  const Instant begin = hal.clock.now();
  std::array<std::byte, 512> received{};
  WheelSpeeds shown;
  bool has_shown = false;
  std::size_t packets = 0, bytes = 0;
  for (Instant now = begin; !stop.load() && seconds(now - begin) < duration_s; now = hal.clock.now()) {
    const double time_s = seconds(now - begin);
    if (has_emergency_stop) {
      const Result<hal::GpioInputs> inputs = hal.gpio.inputs(now);
      if (!inputs.ok())
        return fail_radio(std::string("emergency stop: ") + std::string(inputs.text()), kExitDeviceFailure);
      if (inputs.value().emergency_stop)
        return fail_radio("emergency stop: the robots were stopped", kExitDeviceFailure);
    }
    Commands commands;
    commands.stop = false;
    RobotCommand command;
    command.id = static_cast<RobotId>(options.robot);
    command.wheels = speeds_of(pattern, time_s, speed_mps);
    commands.robots.push_back(command);
    if (const Result<void> sent = link.send(commands); !sent.ok()) return fail_radio(sent.text(), kExitDeviceFailure);
    ++packets;
    const bool is_new =
        !has_shown || shown.left_mps != command.wheels.left_mps || shown.right_mps != command.wheels.right_mps;
    if (is_new || options.all) {
      const std::span<const std::byte> packet = link.last_packet(command.id);
      show(time_s, "sent", packet.size(), config::received_text(layout, packet));
    }
    shown = command.wheels;
    has_shown = true;
    const Result<std::size_t> count = hal.radio.receive(received);
    if (!count.ok()) return fail_radio(count.text(), kExitDeviceFailure);
    bytes += count.value();
    if (count.value() > 0) {
      show(time_s, "received", count.value(),
           config::received_text(configuration.pipeline.telemetry, std::span(received).first(count.value())));
    }
    link.pause(kPacketPause);
  }
  std::printf("sent %zu packets, received %zu bytes; now the robots stop\n", packets, bytes);
  return kExitOk;
}

}  // namespace touchline::radio
