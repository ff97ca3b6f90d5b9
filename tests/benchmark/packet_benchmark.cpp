// Prints the time that the packets of eleven robots take, for Touchline's packet and every preset: packet-benchmark
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

#include "core/radio/packet.h"
#include "firmware/config/resolve_radio.h"
#include "tests/config/preset_team.h"

namespace touchline {
namespace {

constexpr int kRuns = 15, kPacketsPerRun = 2000;

Commands all_robots(const PacketLayout& layout) {
  Commands commands;
  commands.stop = false;
  for (const Receiver& receiver : layout.receivers) {
    const float speed = 0.123f * static_cast<float>(receiver.id + 1);
    commands.robots.push_back({receiver.id, {}, {speed, -0.7f * speed}});
  }
  return commands;
}

// Median of several runs, in nanoseconds for the packets of one frame.
double time_of(const PacketLayout& layout) {
  const Commands commands = all_robots(layout);
  const auto packets = std::make_unique<OutgoingPackets>();
  std::array<double, kRuns> times{};
  for (double& time : times) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < kPacketsPerRun; ++i) {
      PacketValues values;
      values.sequence = static_cast<std::uint8_t>(i);
      if (!encode(layout, commands, values, *packets).ok()) return -1.0;
    }
    time = std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count() / kPacketsPerRun;
  }
  std::sort(times.begin(), times.end());
  return times[kRuns / 2];
}

bool print(const std::string& format, double& touchline_ns) {
  const auto parameters = std::make_unique<PipelineParameters>();
  const config::TeamFile team = config::team_of(format);
  const config::Locations where("team.toml");
  if (const Result<void> resolved = config::resolve_radio(team, where, *parameters); !resolved.ok()) {
    std::fprintf(stderr, "%s: %s\n", format.c_str(), resolved.error().text.c_str());
    return false;
  }
  const double time = time_of(parameters->radio);
  if (touchline_ns == 0.0) touchline_ns = time;
  std::printf("%-20s %2zu robots  %7.2f us  %5.2f x\n", format.c_str(), team.own.robot.size(), time / 1000,
              time / touchline_ns);
  return time > 0.0;
}

}  // namespace
}  // namespace touchline

int main() {
  double touchline_ns = 0.0;
  bool ok = touchline::print("touchline", touchline_ns);
  for (const touchline::config::RadioPreset& preset : touchline::config::radio_presets()) {
    ok = touchline::print(std::string(preset.name), touchline_ns) && ok;
  }
  return ok ? 0 : 1;
}
