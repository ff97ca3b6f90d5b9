#include "firmware/network/network_plan.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <span>
#include <utility>

#include "firmware/config/error_list.h"
#include "firmware/config/wording.h"

namespace touchline::network {
namespace {

using config::InputProtocol;
using config::OutputProtocol;

template <class Protocol, std::size_t kCount>
const config::ProtocolInfo<Protocol>& info_of(const std::array<config::ProtocolInfo<Protocol>, kCount>& table,
                                              Protocol protocol) {
  return *std::find_if(table.begin(), table.end(), [&](const auto& entry) { return entry.protocol == protocol; });
}

std::string word_of(OutputProtocol protocol) {
  return std::string(info_of(config::kOutputProtocolTable, protocol).word);
}
std::string word_of(InputProtocol protocol) { return std::string(info_of(config::kInputProtocolTable, protocol).word); }

// Returns whether messages are lines of text, which pass through streams; the messages of the other protocols are
// binary.
bool has_lines(OutputProtocol protocol) { return protocol == OutputProtocol::kJson; }
bool has_lines(InputProtocol protocol) { return protocol == InputProtocol::kJson; }

// An entry of the file or the command line that is being checked.
struct Entry {
  std::string option;  // option of the command line; empty: the entry is from the file
  std::string key;     // key in the file: "network.output[0]"
  std::string address, interface;
  std::vector<std::string> senders;
};

class Planner {
 public:
  Planner(const config::Locations& where, config::ErrorList& errors) : where_(where), errors_(errors) {}

  void refuse(const Entry& entry, const char* key, const std::string& message) {
    if (!entry.option.empty()) return errors_.add(entry.option, "", message);
    const std::string path = entry.key + "." + key;
    errors_.add(where_.of(path), path, message);
  }

  template <class Protocol>
  std::optional<hal::NetworkAddress> address_of(const Entry& entry, Protocol protocol, std::string_view usual) {
    Result<hal::NetworkAddress> parsed = hal::parse_network_address(entry.address.empty() ? usual : entry.address);
    if (!parsed.ok()) {
      refuse(entry, "address", parsed.text());
      return std::nullopt;
    }
    hal::NetworkAddress address = std::move(parsed).value();
    const bool is_unix = address.kind == hal::NetworkAddress::Kind::kUnix;
    if (is_unix && !has_lines(protocol)) {
      refuse(entry, "address", "only json can use a unix socket; use udp://ADDRESS:PORT");
      return std::nullopt;
    }
    if (!entry.interface.empty() && (is_unix || !address.interface.empty())) {
      refuse(entry, "interface", is_unix ? "a unix socket has no interface" : "the address names an interface already");
      return std::nullopt;
    }
    if (!entry.interface.empty()) {
      // The parser checks the name.
      Result<hal::NetworkAddress> named = hal::parse_network_address(address.text() + "%" + entry.interface);
      if (!named.ok()) {
        refuse(entry, "interface", named.text());
        return std::nullopt;
      }
      address = std::move(named).value();
    }
    return address;
  }

  void add(const Entry& entry, OutputProtocol protocol, double rate_hz) {
    const auto address = address_of(entry, protocol, info_of(config::kOutputProtocolTable, protocol).default_address);
    if (!address) return;
    if (address->kind == hal::NetworkAddress::Kind::kUdp && address->ipv4 == 0) {
      return refuse(entry, "address", "0.0.0.0 is no destination; name a computer or a multicast group");
    }
    const bool is_listed = std::any_of(plan_.outputs.begin(), plan_.outputs.end(), [&](const PlannedOutput& other) {
      return other.address == *address && (other.protocol == protocol || !other.address.path.empty());
    });
    if (is_listed) return refuse(entry, "address", address->text() + " is listed twice");
    plan_.outputs.push_back({protocol, *address, rate_hz});
    if (protocol == OutputProtocol::kVsssPlacement) placement_ = entry;
  }

  /// Reports an output that has nothing to answer.
  void check_placement() {
    if (!placement_) return;
    const bool is_asked = std::any_of(plan_.inputs.begin(), plan_.inputs.end(), [](const PlannedInput& input) {
      return input.protocol == InputProtocol::kVsssReferee;
    });
    if (!is_asked) refuse(*placement_, "protocol", "vsss-placement answers a VSSS referee; add --referee vsss");
  }

  void add_senders(const Entry& entry, PlannedInput& input) {
    for (const std::string& sender : entry.senders) {
      Result<hal::NetworkRange> range = hal::parse_network_range(sender);
      if (range.ok()) {
        input.senders.push_back(range.value());
        input.sender_names.push_back(sender);
      } else {
        refuse(entry, "senders", range.text());
      }
    }
  }

  void add(const Entry& entry, InputProtocol protocol, double rate_hz) {
    PlannedInput input;
    const auto address = address_of(entry, protocol, info_of(config::kInputProtocolTable, protocol).default_address);
    add_senders(entry, input);
    input.option = entry.option;
    if (input.option.empty()) input.key = entry.key + ".senders in " + where_.of(entry.key);
    if (!address) return;
    for (const PlannedInput& other : plan_.inputs) {
      if (other.address == *address) return refuse(entry, "address", address->text() + " is listed twice");
      if (is_referee(other.protocol) && is_referee(protocol)) {
        return refuse(entry, "protocol", "there is a referee already: " + word_of(other.protocol));
      }
    }
    input.protocol = protocol;
    input.address = *address;
    input.rate_hz = rate_hz;
    plan_.inputs.push_back(std::move(input));
  }

  NetworkPlan& plan() { return plan_; }

 private:
  const config::Locations& where_;
  config::ErrorList& errors_;
  NetworkPlan plan_;
  std::optional<Entry> placement_;  // of a vsss-placement output
};

// Splits NAME=ADDRESS,from=SENDER of an option and looks up the name; reports an unknown one and returns nullopt.
template <class Protocol>
std::optional<std::pair<Protocol, Entry>> parse_option(const std::string& option, const std::string& text,
                                                       std::span<const Choice<Protocol>> names,
                                                       config::ErrorList& errors) {
  constexpr std::string_view kFrom = ",from=";
  Entry entry;
  entry.option = option + " " + text;
  std::string rest = text;
  for (std::size_t at = rest.rfind(kFrom); at != std::string::npos; at = rest.rfind(kFrom)) {
    entry.senders.insert(entry.senders.begin(), rest.substr(at + kFrom.size()));
    rest.erase(at);
  }
  const std::size_t equals = rest.find('=');
  const std::string name = rest.substr(0, equals);
  if (equals != std::string::npos) entry.address = rest.substr(equals + 1);
  std::vector<std::string_view> words;
  for (const Choice<Protocol>& choice : names) {
    if (choice.word == name) return std::pair(choice.value, entry);
    words.push_back(choice.word);
  }
  errors.add(entry.option, "", "\"" + name + "\" is none of " + config::joined(words));
  return std::nullopt;
}

// Returns the entry of the board file to which an option without an address refers. Returns null if the file has no
// entry of this protocol.
template <class Planned, class Protocol>
Planned* find_planned(std::vector<Planned>& planned, std::size_t of_file, Protocol protocol, const Entry& entry) {
  const auto end = planned.begin() + static_cast<std::ptrdiff_t>(of_file);
  const auto found = entry.address.empty()
                         ? std::find_if(planned.begin(), end, [&](const Planned& p) { return p.protocol == protocol; })
                         : end;
  return found == end ? nullptr : &*found;
}

void add_options(const NetworkOptions& options, Planner& planner, config::ErrorList& errors) {
  const std::size_t outputs = planner.plan().outputs.size(), inputs = planner.plan().inputs.size();
  for (const std::string& text : options.publish) {
    const auto found = parse_option<OutputProtocol>("--publish", text, config::kOutputProtocols, errors);
    if (!found) continue;
    if (!found->second.senders.empty()) errors.add(found->second.option, "", "an output has no senders");
    if (find_planned(planner.plan().outputs, outputs, found->first, found->second) != nullptr) continue;
    planner.add(found->second, found->first, config::OutputSettings{}.rate_hz);
  }
  const auto add_inputs = [&](const char* option, const std::vector<std::string>& texts, const auto& names) {
    for (const std::string& text : texts) {
      const auto found = parse_option<InputProtocol>(option, text, names, errors);
      if (!found) continue;
      PlannedInput* const of_file = find_planned(planner.plan().inputs, inputs, found->first, found->second);
      if (of_file != nullptr) {
        planner.add_senders(found->second, *of_file);
      } else {
        planner.add(found->second, found->first, config::InputSettings{}.rate_hz);
      }
    }
  };
  add_inputs("--accept", options.accept, kCommandWords);
  add_inputs("--referee", options.referee, kRefereeWords);
}

std::string number_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

}  // namespace

std::string name_of(const PlannedOutput& output) { return word_of(output.protocol) + " to " + output.address.text(); }

std::string name_of(const PlannedInput& input) { return word_of(input.protocol) + " from " + input.address.text(); }

std::string how_to_permit(const PlannedInput& input, const std::string& sender) {
  if (!input.option.empty()) return "write " + input.option + ",from=" + sender;
  return "add " + sender + " to " + input.key;
}

std::string describe(const PlannedOutput& output) {
  const std::string rate = output.rate_hz > 0.0 ? "at most " + number_text(output.rate_hz) + " Hz" : "every frame";
  return name_of(output) + ", " + rate;
}

std::string describe(const PlannedInput& input) {
  std::string text = name_of(input) + ", of this computer";
  for (const std::string& name : input.sender_names) text += " and " + name;
  return text + ", at most " + number_text(input.rate_hz) + " messages a second from each";
}

Result<NetworkPlan> plan_network(const config::NetworkSettings& board, const config::Locations& where,
                                 const NetworkOptions& options) {
  config::ErrorList errors;
  Planner planner(where, errors);
  const auto entry_of = [&](const char* list, std::size_t index, const auto& settings) {
    return Entry{{}, config::element(list, index), settings.address, settings.interface, {}};
  };
  for (std::size_t i = 0; i < board.output.size(); ++i) {
    const config::OutputSettings& output = board.output[i];
    planner.add(entry_of("network.output", i, output), output.protocol, output.rate_hz);
  }
  for (std::size_t i = 0; i < board.input.size(); ++i) {
    const config::InputSettings& input = board.input[i];
    Entry entry = entry_of("network.input", i, input);
    entry.senders = input.senders;
    planner.add(entry, input.protocol, input.rate_hz);
  }
  add_options(options, planner, errors);
  planner.check_placement();
  TOUCHLINE_TRY(errors.result());
  return std::move(planner.plan());
}

Result<NetworkPlan> plan_network(const config::Configuration& configuration, const NetworkOptions& options) {
  return plan_network(configuration.board.network, configuration.board_where, options);
}

}  // namespace touchline::network
