#include "hal/packet_slot.h"

#include <algorithm>

namespace touchline::hal {

Result<void> PacketSlot::send(const Packet& packet, ByteLine& line) {
  const bool replaces = !waiting_.empty();
  waiting_ = packet;
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
  if (waiting_.empty()) return {};
  TOUCHLINE_TRY_ASSIGN(const std::size_t unsent, line.unsent_bytes());
  if (unsent > 0) return {};
  TOUCHLINE_TRY_ASSIGN(const std::size_t taken, line.write({waiting_.data(), waiting_.size()}));
  if (taken == 0) return {};
  if (taken < waiting_.size()) {
    ++split_packets_;
    unsent_begin_ = 0;
    unsent_end_ = waiting_.size() - taken;
    std::copy(waiting_.begin() + taken, waiting_.end(), partly_sent_.begin());
  }
  waiting_.clear();
  return {};
}

void PacketSlot::clear() {
  waiting_.clear();
  unsent_begin_ = unsent_end_ = 0;
}

}  // namespace touchline::hal
