#include "hal/poses/packet_order.h"

#include <chrono>

namespace touchline::hal {
namespace {

// Another sender is heard after this silence: longer than pauses of a network, and shorter than the time after which
// the loop reopens a silent camera (faults.camera_timeout_s, 1 s).
constexpr Duration kSilence = std::chrono::milliseconds(500);
// No network delays a datagram by so many others. A number that is lower by more comes from a sender that began anew.
constexpr std::int32_t kMaxDelay = 100;
// A sender that began anew soon after its start: so many numbers in a row are too low.
constexpr int kMaxLate = 10;
// More missing numbers are a jump of the counter, not lost packets.
constexpr std::int32_t kMaxMissing = 1000;

}  // namespace

PacketPlace PacketOrder::place(std::uint32_t number, std::uint64_t sender, std::uint64_t content, Instant arrival) {
  const bool is_silent = arrival - heard_ > kSilence;
  if (has_sender_ && sender != sender_ && !is_silent) return PacketPlace::kForeign;
  const bool is_known = has_sender_ && sender == sender_ && !is_silent;
  heard_ = arrival;
  // Numbers wrap around.
  const auto ahead = static_cast<std::int32_t>(number - number_);
  if (is_known && ahead == 0 && content == content_) return PacketPlace::kDoubled;
  if (is_known && ahead < 0 && ahead >= -kMaxDelay && ++late_ < kMaxLate) return PacketPlace::kLate;
  missing_ = is_known && ahead > 0 && ahead <= kMaxMissing ? static_cast<std::uint32_t>(ahead - 1) : 0;
  has_sender_ = true;
  sender_ = sender;
  number_ = number;
  content_ = content;
  late_ = 0;
  return PacketPlace::kNext;
}

}  // namespace touchline::hal
