#include "hal/packet_slot.h"

#include <algorithm>

namespace touchline::hal {

Result<void> PacketSlot::send(const Packet& packet, std::size_t receiver, ByteLine& line) {
  bool replaces = !waiting_[receiver].empty();
  if (receiver == kAllRobots) {
    replaces = next_receiver().has_value();
    for (Packet& waiting : waiting_) waiting.clear();
  }
  waiting_[receiver] = packet;
  TOUCHLINE_TRY(serve(line));
  if (replaces) return failure(ErrorCode::kBusy, "the line is still busy; a newer packet replaced an older one");
  return {};
}

Result<void> PacketSlot::serve(ByteLine& line) {
  if (unsent_begin_ < unsent_end_) {
    TOUCHLINE_TRY_ASSIGN(const std::size_t taken,
                         line.write(std::span(partly_sent_).subspan(unsent_begin_, unsent_end_ - unsent_begin_)));
    unsent_begin_ += taken;
    if (unsent_begin_ < unsent_end_) return {};
  }
  while (const std::optional<std::size_t> receiver = next_receiver()) {
    TOUCHLINE_TRY_ASSIGN(const std::size_t unsent, line.unsent_bytes());
    if (unsent > 0) return {};
    Packet& next = waiting_[*receiver];
    receiver_ = *receiver;
    TOUCHLINE_TRY_ASSIGN(const std::size_t taken, line.write({next.data(), next.size()}));
    if (taken == 0) return {};
    const bool is_split = taken < next.size();
    if (is_split) {
      ++split_packets_;
      unsent_begin_ = 0;
      unsent_end_ = next.size() - taken;
      std::copy(next.begin() + taken, next.end(), partly_sent_.begin());
    }
    next.clear();
    if (*receiver != kAllRobots) next_robot_ = (*receiver + 1) % kMaxRobotsPerTeam;
    if (is_split) return {};
  }
  return {};
}

std::optional<std::size_t> PacketSlot::next_receiver() const {
  if (!waiting_[kAllRobots].empty()) return kAllRobots;
  for (std::size_t i = 0; i < kMaxRobotsPerTeam; ++i) {
    const std::size_t robot = (next_robot_ + i) % kMaxRobotsPerTeam;
    if (!waiting_[robot].empty()) return robot;
  }
  return std::nullopt;
}

void PacketSlot::clear() {
  for (Packet& waiting : waiting_) waiting.clear();
  unsent_begin_ = unsent_end_ = 0;
}

std::size_t PacketSlot::bytes() const {
  std::size_t count = unsent_end_ - unsent_begin_;
  for (const Packet& packet : waiting_) count += packet.size();
  return count;
}

}  // namespace touchline::hal
