#include "hal/packet_slot.h"

#include <algorithm>

namespace touchline::hal {

Status PacketSlot::send(const Packet& packet, ByteLine& line) {
  const bool drops = !held_.empty();
  held_ = packet;
  if (const Status status = serve(line); !status.ok()) return status;
  return drops ? Status(ErrorCode::kBusy) : Status();
}

Status PacketSlot::serve(ByteLine& line) {
  if (rest_begin_ < rest_end_) {
    const Result<std::size_t> taken = line.write(std::span(rest_).subspan(rest_begin_, rest_end_ - rest_begin_));
    if (!taken.ok()) return taken.error();
    rest_begin_ += taken.value();
    if (rest_begin_ < rest_end_) return {};
  }
  if (held_.empty()) return {};
  const Result<std::size_t> waiting = line.waiting();
  if (!waiting.ok()) return waiting.error();
  if (waiting.value() > 0) return {};
  const Result<std::size_t> taken = line.write({held_.data(), held_.size()});
  if (!taken.ok()) return taken.error();
  if (taken.value() == 0) return {};
  if (taken.value() < held_.size()) {
    ++split_packets_;
    rest_begin_ = 0;
    rest_end_ = held_.size() - taken.value();
    std::copy(held_.begin() + taken.value(), held_.end(), rest_.begin());
  }
  held_.clear();
  return {};
}

void PacketSlot::clear() {
  held_.clear();
  rest_begin_ = rest_end_ = 0;
}

}  // namespace touchline::hal
