#include "firmware/network/explained_kinds.h"

#include "hal/linux/network/network_address.h"

namespace touchline::network {
namespace {

// Removes the numbers from a text, so that "commands[1].v = 12.5 is not within -10 to 10" and "commands[0].v = 99 is
// ..." are of the same kind.
std::string without_numbers(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool is_digit = c >= '0' && c <= '9';
    const bool continues = !out.empty() && out.back() == '#' && (is_digit || c == '.');
    if (!continues) out += is_digit ? '#' : c;
  }
  return out;
}

}  // namespace

std::string sender_text(std::uint32_t address, std::uint16_t port) {
  if (address == 0) return "a program at the unix socket";
  return hal::ipv4_text(address) + ":" + std::to_string(port);
}

ExplainedKinds::Answer ExplainedKinds::add(std::uint32_t address, std::string_view kind) {
  const auto sender = kinds_.find(address);
  if (sender == kinds_.end() && kinds_.size() == kMaxSenders) return Answer::kCount;
  std::set<std::string>& kinds = sender == kinds_.end() ? kinds_[address] : sender->second;
  if (kinds.size() == kMaxKinds || !kinds.insert(without_numbers(kind)).second) return Answer::kCount;
  return kinds.size() == kMaxKinds ? Answer::kExplainLast : Answer::kExplain;
}

}  // namespace touchline::network
