#include "hal/poses/pose_source.h"

#include "hal/fnv1a.h"

namespace touchline::hal {
namespace {

std::uint64_t content_hash(std::span<const std::byte> bytes) {
  Fnv1a hash;
  hash.add(bytes);
  return hash.value();
}

}  // namespace

Result<bool> PoseSource::take(std::span<const std::byte> bytes, std::uint64_t sender, Instant arrival,
                              MergedPoses& out) {
  Result<bool> decoded = decode_poses(settings_.protocol, bytes, poses_);
  if (!decoded.ok()) {
    ++counters_.malformed;
    return decoded;
  }
  if (!decoded.value()) return false;
  Stream& stream = streams_[poses_.camera];
  switch (stream.order.place(poses_.number, sender ^ poses_.source, content_hash(bytes), arrival)) {
    case PacketPlace::kNext:
      break;
    case PacketPlace::kDoubled:
      ++counters_.doubled;
      return false;
    case PacketPlace::kLate:
      ++counters_.late;
      return false;
    case PacketPlace::kForeign:
      ++counters_.foreign;
      return false;
  }
  sequence_ += stream.order.missing();
  const Instant captured = stream.estimate.capture_time(poses_.captured_s, poses_.sent_s, arrival) - settings_.delay;
  if (!merger_.add(poses_, captured, arrival, out)) return false;
  ++sequence_;
  return true;
}

}  // namespace touchline::hal
