#include "core/radio/packet_stream.h"

namespace touchline {

bool PacketStream::next(Commands& commands, std::uint8_t& sequence) {
  TeamNumber team = kNoTeamNumber;
  // A foreign packet is valid too: its bytes are not searched for another one.
  const auto decode_any = [&](std::span<const std::byte> bytes) {
    team = packet_team(bytes);
    Commands read;
    std::uint8_t number = 0;
    if (!decode(bytes, read, number, team).ok()) return false;
    if (team == team_) {
      commands = read;
      sequence = number;
    }
    return true;
  };
  while (sync_.next(decode_any)) {
    if (team == team_) return true;
    ++foreign_packets_;
  }
  return false;
}

bool SequenceFilter::obey(std::uint8_t sequence, bool stop) {
  const auto step = static_cast<std::uint8_t>(sequence - last_);
  const bool is_new = !last_known_ || (step >= 1 && step <= 127);
  if (is_new) {
    last_ = sequence;
    last_known_ = true;
  }
  return is_new || stop;
}

}  // namespace touchline
