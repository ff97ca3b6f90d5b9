#include "firmware/config/poses.h"

#include <array>
#include <memory>

#include "firmware/config/core_rules.h"
#include "firmware/config/error_list.h"

namespace touchline::config {
namespace {

// Both simulators listen at this port of their computer.
constexpr const char* kSimulatorAddress = "127.0.0.1:20011";

struct ShownColor {
  std::string_view name;
  std::array<std::uint8_t, 3> rgb;
};
// Those of the arena's paints.
constexpr std::array<ShownColor, 3> kShownColors{
    {{"blue", {25, 70, 205}}, {"yellow", {250, 205, 20}}, {"orange", {255, 115, 10}}}};

void add_color(const std::string& name, VenueFile& venue) {
  if (name.empty() || color_id(venue, name) != kBackground) return;
  ColorEntry color;
  color.name = name;
  for (const ShownColor& shown : kShownColors) {
    if (shown.name == name) color.shown_rgb = shown.rgb;
  }
  venue.color.push_back(color);
}

void add_colors(const TeamFile& team, VenueFile& venue) {
  for (const TeamEntry* side : {&team.own, &team.opponent}) {
    add_color(side->color, venue);
    for (const RobotEntry& robot : side->robot) {
      for (const std::string& color : robot.colors) add_color(color, venue);
    }
  }
  add_color(team.ball.color, venue);
}

}  // namespace

Result<void> resolve_for_poses(Configuration& configuration) {
  ErrorList errors;
  const TeamFile& team = configuration.team;
  if (!own_is_yellow(team)) {
    errors.add(configuration.team_where.of("own.color"), "own.color",
               "is \"" + team.own.color +
                   "\"; poses are of a blue and a yellow team, so it is \"blue\" or \"yellow\" (or opponent.color is)");
  }
  if (team.own.robot.empty() && configuration.team_where.has("own")) {
    errors.add(configuration.team_where.of("own"), "own.robot",
               "is missing; add an [[own.robot]] with the id of each robot to drive");
  }
  PipelineParameters& out = configuration.pipeline;
  const float low_battery_v = out.low_battery_v;
  out = *std::make_unique<PipelineParameters>();  // on the heap, because it is too large for the stack
  out.has_pictures = false;
  out.low_battery_v = low_battery_v;
  out.adaptation.mode = AdaptationMode::kOff;
  out.marker.field = configuration.venue.field;
  add_colors(team, configuration.venue);
  if (!errors.empty()) return errors.result();
  errors.add(resolve_team(team, configuration.team_where, configuration.venue, configuration.venue_where,
                          Markers::kUnseen, out));
  if (errors.empty()) add_core_refusals(configuration, errors);
  return errors.result();
}

void use_simulator(hal::RadioPortSettings& port) {
  if (port.backend != hal::RadioBackend::kFirasim && port.backend != hal::RadioBackend::kGrsim) return;
  port.simulator = port.backend == hal::RadioBackend::kFirasim ? "firasim" : "grsim";
  port.backend = hal::RadioBackend::kUdp;
  if (port.address.empty()) port.address = kSimulatorAddress;
}

std::string simulator_format(const hal::RadioSettings& radio) {
  if (!radio.simulator.empty()) return radio.simulator;
  for (const hal::RadioPortSettings& port : radio.more) {
    if (!port.simulator.empty()) return port.simulator;
  }
  return {};
}

}  // namespace touchline::config
