#include "firmware/radio_plan.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "firmware/config/error_list.h"
#include "hal/linux/device_files.h"

namespace touchline {
namespace {

using Robots = std::vector<config::RobotEntry>;

/// One entry of the board file while it is checked.
class RadioPlanner {
 public:
  RadioPlanner(const config::Configuration& configuration, config::ErrorList& errors)
      : configuration_(configuration), errors_(errors) {}

  void add(const std::string& key, const hal::RadioPortSettings& settings) {
    PlannedRadio radio;
    radio.key = key;
    radio.settings = settings;
    find_robots(radio);
    if (settings.backend == hal::RadioBackend::kUdp) find_endpoints(radio);
    check_telemetry(radio);
    plan_.push_back(std::move(radio));
  }

  std::vector<PlannedRadio> finish() {
    std::bitset<kMaxReceivers> reached;
    for (const PlannedRadio& radio : plan_) reached |= radio.reaches;
    for (std::size_t i = 0; i < robots().size(); ++i) {
      if (!reached[i]) refuse("radio", "robots", "no radio reaches robot " + std::to_string(robots()[i].id));
    }
    return std::move(plan_);
  }

  void refuse(const std::string& entry, const char* key, const std::string& message) {
    const std::string path = entry + "." + key;
    errors_.add(configuration_.board_where.of(path), path, message);
  }

 private:
  [[nodiscard]] const Robots& robots() const { return configuration_.team.own.robot; }

  void find_robots(PlannedRadio& radio) {
    if (radio.settings.robots.empty()) {
      radio.reaches.set();
      return;
    }
    radio.reaches.set(kAllRobots);
    for (const int id : radio.settings.robots) {
      const auto found = std::find_if(robots().begin(), robots().end(), [&](const auto& r) { return r.id == id; });
      const auto index = static_cast<std::size_t>(found - robots().begin());
      if (found == robots().end()) {
        refuse(radio.key, "robots",
               "there is no robot " + std::to_string(id) + " in " + configuration_.team_where.file());
      } else if (index < kMaxRobotsPerTeam) {
        radio.reaches.set(index);
      }
    }
  }

  void find_endpoints(PlannedRadio& radio) {
    const hal::RadioPortSettings& settings = radio.settings;
    const auto usual_port = static_cast<std::uint16_t>(settings.port);
    radio.udp.local_port = static_cast<std::uint16_t>(settings.local_port);
    radio.udp.interface = settings.interface;
    radio.udp.time_to_live = settings.time_to_live;
    if (!settings.interface.empty()) {
      // The parser checks the name.
      if (const auto named = hal::parse_network_address("udp://127.0.0.1:1%" + settings.interface); !named.ok()) {
        refuse(radio.key, "interface", "\"" + settings.interface + "\" cannot be the name of an interface");
      }
    }
    if (!settings.address.empty()) {
      const Result<hal::NetworkAddress> parsed = hal::parse_udp_destination(settings.address, usual_port);
      if (!parsed.ok()) return refuse(radio.key, "address", parsed.text());
      radio.udp.common = {parsed.value().ipv4, parsed.value().port};
    }
    const bool has_common = radio.udp.common.exists();
    if (robots().empty() && !has_common) {
      refuse(radio.key, "address", "is needed, because the team file lists no robots with addresses of their own");
    }
    for (std::size_t i = 0; i < std::min(robots().size(), kMaxRobotsPerTeam); ++i) {
      if (!radio.reaches[i]) continue;
      const std::string& address = robots()[i].address;
      const std::string path = "own.robot[" + std::to_string(i) + "].address";
      if (address.empty()) {
        if (has_common) continue;
        errors_.add(configuration_.team_where.of(path), path,
                    "is needed, because " + radio.key + ".address of the board file is empty");
        continue;
      }
      const Result<hal::NetworkAddress> parsed = hal::parse_udp_destination(address, usual_port);
      if (!parsed.ok()) {
        errors_.add(configuration_.team_where.of(path), path, parsed.text());
        continue;
      }
      radio.udp.robots[i] = {parsed.value().ipv4, parsed.value().port};
    }
  }

  // Reports without id and address are those of the robot that the port or the network address belongs to.
  void check_telemetry(const PlannedRadio& radio) {
    const PacketLayout& layout = configuration_.pipeline.telemetry;
    const bool is_line = radio.settings.backend == hal::RadioBackend::kSerial;
    const bool is_network = radio.settings.backend == hal::RadioBackend::kUdp;
    if (!configuration_.board.radio.telemetry || layout.fields.empty() || layout.names_robots()) return;
    std::size_t count = 0, told = 0;
    for (std::size_t i = 0; i < std::min(robots().size(), kMaxRobotsPerTeam); ++i) {
      if (!radio.reaches[i]) continue;
      ++count;
      const auto& endpoints = radio.udp.robots;
      const auto is_same = [&](const hal::UdpEndpoint& other) {
        return other.ipv4 == endpoints[i].ipv4 && other.port == endpoints[i].port;
      };
      told += endpoints[i].exists() && std::count_if(endpoints.begin(), endpoints.end(), is_same) == 1 ? 1U : 0U;
    }
    if (!(is_line || is_network) || count <= 1 || told == count) return;
    const std::string key = "radio.telemetry";
    errors_.add(configuration_.team_where.of(key), key,
                "no field carries the id or the address, and " + radio.key + " of " +
                    configuration_.board_where.file() +
                    " does not tell which robot has sent a report: give each robot "
                    "a port of its own ([[radio.more]] and robots), or an address of its own with backend = \"udp\"; "
                    "or set radio.telemetry = false there");
  }

  const config::Configuration& configuration_;
  config::ErrorList& errors_;
  std::vector<PlannedRadio> plan_;
};

std::string more_key(std::size_t index) { return "radio.more[" + std::to_string(index) + "]"; }

/// The name that an adapter keeps at any port and in any order; "" if `device` is such a name or has none.
std::string lasting_name(const std::string& device) {
  const bool is_numbered = hal::is_numbered(device, "/dev/ttyUSB") || hal::is_numbered(device, "/dev/ttyACM");
  return is_numbered ? hal::stable_link("/dev/serial/by-id", device) : std::string();
}

}  // namespace

Result<std::vector<PlannedRadio>> plan_radios(const config::Configuration& configuration) {
  const hal::RadioSettings& radio = configuration.board.radio;
  config::ErrorList errors;
  RadioPlanner planner(configuration, errors);
  if (radio.more.size() >= hal::kMaxRadios) {
    const std::string key = more_key(hal::kMaxRadios - 1);
    errors.add(configuration.board_where.of(key), key,
               "is too many: at most " + std::to_string(hal::kMaxRadios) + " radios are used at once");
    return errors.result().error();
  }
  planner.add("radio", radio);
  for (std::size_t i = 0; i < radio.more.size(); ++i) planner.add(more_key(i), radio.more[i]);
  std::vector<PlannedRadio> plan = planner.finish();
  if (!errors.empty()) return errors.result().error();
  return plan;
}

std::string radio_hints(const config::Configuration& configuration) {
  const hal::RadioSettings& radio = configuration.board.radio;
  std::string hints;
  const auto add = [&](const std::string& key, const hal::RadioPortSettings& port) {
    if (port.backend != hal::RadioBackend::kSerial) return;
    const std::string name = lasting_name(port.device);
    if (name.empty()) return;
    const std::string path = key + ".device";
    hints += config::error_line(configuration.board_where.of(path), path,
                                port.device + " may be another device after the next start; " + name + " lasts") +
             "\n";
  };
  add("radio", radio);
  for (std::size_t i = 0; i < radio.more.size(); ++i) add(more_key(i), radio.more[i]);
  return hints;
}

}  // namespace touchline
