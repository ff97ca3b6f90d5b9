#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/parameter.h"

// Section [network] of the board file: messages that Touchline sends to other programs and receives from them.
namespace touchline::config {

enum class OutputProtocol : std::uint8_t { kSslVision, kSslTracked, kFirasim, kJson, kVsssPlacement };
enum class InputProtocol : std::uint8_t { kFirasim, kJson, kSslReferee, kVsssReferee };

/// Word for a protocol in the board file and on the command line, and the usual address of the protocol in its league.
template <class Protocol>
struct ProtocolInfo {
  Protocol protocol;
  std::string_view word, default_address;
};

// The usual address of JSON is PlotJuggler's UDP port.
inline constexpr std::array<ProtocolInfo<OutputProtocol>, 5> kOutputProtocolTable{
    {{OutputProtocol::kSslVision, "ssl-vision", "udp://224.5.23.2:10006"},
     {OutputProtocol::kSslTracked, "ssl-tracked", "udp://224.5.23.2:10010"},
     {OutputProtocol::kFirasim, "firasim", "udp://224.0.0.1:10002"},
     {OutputProtocol::kJson, "json", "udp://127.0.0.1:9870"},
     {OutputProtocol::kVsssPlacement, "vsss-placement", "udp://224.5.23.2:10004"}}};
// Commands are received on all addresses of this computer; `senders` decides whose commands are obeyed.
inline constexpr std::array<ProtocolInfo<InputProtocol>, 4> kInputProtocolTable{
    {{InputProtocol::kFirasim, "firasim", "udp://0.0.0.0:20011"},
     {InputProtocol::kJson, "json", "udp://0.0.0.0:20012"},
     {InputProtocol::kSslReferee, "ssl-referee", "udp://224.5.23.1:10003"},
     {InputProtocol::kVsssReferee, "vsss-referee", "udp://224.5.23.2:10003"}}};

constexpr bool is_referee(InputProtocol protocol) {
  return protocol == InputProtocol::kSslReferee || protocol == InputProtocol::kVsssReferee;
}

template <class Protocol, std::size_t kCount>
constexpr std::array<Choice<Protocol>, kCount> words_of_protocols(
    const std::array<ProtocolInfo<Protocol>, kCount>& table) {
  std::array<Choice<Protocol>, kCount> choices{};
  for (std::size_t i = 0; i < kCount; ++i) choices[i] = {table[i].word, table[i].protocol};
  return choices;
}
inline constexpr auto kOutputProtocols = words_of_protocols(kOutputProtocolTable);
inline constexpr auto kInputProtocols = words_of_protocols(kInputProtocolTable);

/// [[network.output]]
struct OutputSettings {
  OutputProtocol protocol = OutputProtocol::kJson;
  std::string address, interface;
  double rate_hz = 0.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(self.protocol, kOutputProtocols, {.name = "protocol", .help = "What is sent (docs/network.md)"});
    visit.text(self.address, {.name = "address",
                              .help = "udp://ADDRESS:PORT, or unix:///PATH for json; empty: the protocol's usual one"});
    visit.text(self.interface,
               {.name = "interface", .help = "Network interface, such as eth0; empty: as the system's routes say"});
    visit.number(self.rate_hz, {.name = "rate_hz",
                                .range = {0.0, 1000.0},
                                .unit = "Hz",
                                .help = "Highest rate; frames that are too many are left out; 0: every frame"});
  }
};

/// [[network.input]]
struct InputSettings {
  InputProtocol protocol = InputProtocol::kJson;
  std::string address, interface;
  std::vector<std::string> senders;
  double rate_hz = 1000.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(self.protocol, kInputProtocols, {.name = "protocol", .help = "What is received (docs/network.md)"});
    visit.text(self.address, {.name = "address",
                              .help = "udp://ADDRESS:PORT, or unix:///PATH for json; empty: the protocol's usual one"});
    visit.text(self.interface,
               {.name = "interface", .help = "Network interface, such as eth0; empty: as the system's routes say"});
    visit.texts(self.senders, {.name = "senders",
                               .help = "Computers that are obeyed beside this one: addresses or networks, such as "
                                       "192.168.1.20 or 192.168.1.0/24"});
    visit.number(self.rate_hz,
                 {.name = "rate_hz",
                  .range = {1.0, 10000.0},
                  .unit = "Hz",
                  .help = "Highest rate of messages of each program; those that are too many are ignored"});
  }
};

/// [[network.team]]
struct NamedTeam {
  std::string name;
  float height_m = 0.0f;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text(self.name, {.name = "name", .help = "Name of the team as the referee writes it"});
    visit.number(self.height_m, {.name = "height_m",
                                 .range = {0.0, 0.5},
                                 .unit = "m",
                                 .help = "Height of its markers above the floor; 0: as the team file says"});
  }
};

/// [network] of the board file.
struct NetworkSettings {
  std::string own_team;
  std::uint32_t camera_id = 0;
  float wheel_radius_m = 0.02f;
  std::vector<NamedTeam> team;
  std::vector<OutputSettings> output;
  std::vector<InputSettings> input;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text(self.own_team, {.name = "own_team",
                               .help = "Name of our team as the referee writes it; empty: the referee does not decide "
                                       "on color and side"});
    visit.number(self.camera_id,
                 {.name = "camera_id",
                  .range = {0, 15},
                  .help = "Number of this camera in SSL-Vision packets, if several cameras publish to one group"});
    visit.number(self.wheel_radius_m,
                 {.name = "wheel_radius_m",
                  .range = {0.001, 0.5},
                  .unit = "m",
                  .help = "Radius of the wheels that FIRASim's clients assume; turns their rad/s into m/s"});
    visit.list(self.team, {.name = "team", .help = "A team whose markers have another height than the team file says"});
    visit.list(self.output, {.name = "output", .help = "An output; without one, nothing is sent"});
    visit.list(self.input,
               {.name = "input", .help = "An input of commands or of a referee; without one, nothing is received"});
  }
};

}  // namespace touchline::config
