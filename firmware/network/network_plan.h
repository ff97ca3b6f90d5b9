#pragma once

#include <array>
#include <string>
#include <vector>

#include "firmware/config/configuration.h"
#include "firmware/config/locations.h"
#include "firmware/config/network_settings.h"
#include "hal/linux/network/network_address.h"
#include "hal/result.h"

// Plans which messages are sent to and received from other programs: combines [network] of the board file with the
// command line.
namespace touchline::network {

/// Words of --accept and --referee.
inline constexpr std::array<Choice<config::InputProtocol>, 2> kCommandWords{
    {{"firasim", config::InputProtocol::kFirasim}, {"json", config::InputProtocol::kJson}}};
inline constexpr std::array<Choice<config::InputProtocol>, 2> kRefereeWords{
    {{"ssl", config::InputProtocol::kSslReferee}, {"vsss", config::InputProtocol::kVsssReferee}}};

/// Options of the command line: "NAME" or "NAME=ADDRESS"; inputs also name senders: "NAME=ADDRESS,from=SENDER".
struct NetworkOptions {
  std::vector<std::string> publish;  // --publish: config::kOutputProtocols
  std::vector<std::string> accept;   // --accept: kCommandWords
  std::vector<std::string> referee;  // --referee: kRefereeWords; at most one
};

struct PlannedOutput {
  config::OutputProtocol protocol = config::OutputProtocol::kJson;
  hal::NetworkAddress address;
  double rate_hz = 0.0;  // 0: send every frame
};

struct PlannedInput {
  config::InputProtocol protocol = config::InputProtocol::kJson;
  hal::NetworkAddress address;
  std::vector<hal::NetworkRange> senders;  // computers that are obeyed in addition to this one
  std::vector<std::string> sender_names;   // the same computers as written in the file
  double rate_hz = 0.0;
  std::string key;     // key that lists the senders: "network.input[0].senders in board.toml:14"; empty: none does
  std::string option;  // option of the command line: "--referee ssl"; empty: the input is planned in the board file
};

struct NetworkPlan {
  std::vector<PlannedOutput> outputs;
  std::vector<PlannedInput> inputs;

  [[nodiscard]] bool empty() const { return outputs.empty() && inputs.empty(); }
};

/// Returns a text that says how to make Touchline obey a sender: "add 192.168.1.21 to network.input[0].senders in
/// board.toml:14", or "write --referee ssl,from=192.168.1.21".
std::string how_to_permit(const PlannedInput& input, const std::string& sender);

/// Returns "ssl-vision to udp://224.5.23.2:10006%eth0".
std::string name_of(const PlannedOutput& output);
/// Returns "firasim from udp://0.0.0.0:20011".
std::string name_of(const PlannedInput& input);
/// Returns "ssl-vision to udp://224.5.23.2:10006%eth0, every frame".
std::string describe(const PlannedOutput& output);
/// Returns "firasim from udp://0.0.0.0:20011, of this computer and 192.168.1.20, at most 1000 messages a second from
/// each".
std::string describe(const PlannedInput& input);

/// Adds the command line's entries to the board file's. An entry of the command line without an address only adds its
/// senders if the board file has one of that protocol. kInconsistent: the message has a line for each error.
Result<NetworkPlan> plan_network(const config::NetworkSettings& board, const config::Locations& where,
                                 const NetworkOptions& options);
Result<NetworkPlan> plan_network(const config::Configuration& configuration, const NetworkOptions& options);

}  // namespace touchline::network
