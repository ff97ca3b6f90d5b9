#include "hal/packet_slot.h"

#include <algorithm>

namespace touchline::hal {

Result<void> PacketSlot::send(const Packet& packet, ByteLine& line) {
  const bool drops = !held_.empty();
  held_ = packet;
  TOUCHLINE_TRY(serve(line));
  if (drops) return failure(ErrorCode::kBusy, "the line is still busy, an older packet was dropped for a newer one");
  return {};
}

Result<void> PacketSlot::serve(ByteLine& line) {
  if (rest_begin_ < rest_end_) {
    TOUCHLINE_TRY_ASSIGN(const std::size_t taken,
                         line.write(std::span(rest_).subspan(rest_begin_, rest_end_ - rest_begin_)));
    rest_begin_ += taken;
    if (rest_begin_ < rest_end_) return {};
  }
  if (held_.empty()) return {};
  TOUCHLINE_TRY_ASSIGN(const std::size_t waiting, line.waiting());
  if (waiting > 0) return {};
  TOUCHLINE_TRY_ASSIGN(const std::size_t taken, line.write({held_.data(), held_.size()}));
  if (taken == 0) return {};
  if (taken < held_.size()) {
    ++split_packets_;
    rest_begin_ = 0;
    rest_end_ = held_.size() - taken;
    std::copy(held_.begin() + taken, held_.end(), rest_.begin());
  }
  held_.clear();
  return {};
}

void PacketSlot::clear() {
  held_.clear();
  rest_begin_ = rest_end_ = 0;
}

}  // namespace touchline::hal
