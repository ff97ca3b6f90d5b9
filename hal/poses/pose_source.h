#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/camera.h"
#include "hal/poses/capture_estimate.h"
#include "hal/poses/packet_order.h"
#include "hal/poses/pose_decoder.h"
#include "hal/poses/pose_merger.h"

namespace touchline::hal {

struct PoseSourceSettings {
  PoseProtocol protocol = PoseProtocol::kFirasim;
  PoseTeams teams;
  Duration delay{};  // from the capture to the earliest time that the packets tell
};

/// Makes frames of the packets of one source, in fixed memory. Knows no socket and no clock.
class PoseSource {
 public:
  explicit PoseSource(const PoseSourceSettings& settings) : settings_(settings), merger_(settings.teams) {}

  /// Takes a packet. `sender`: its address and port. Returns whether it completes a frame, which is in `out` then.
  /// kCorruptFrame, kOutOfRange: it is malformed and was ignored.
  Result<bool> take(std::span<const std::byte> bytes, std::uint64_t sender, Instant arrival, MergedPoses& out);

  /// Returns the number of the last frame. Gaps are packets that did not arrive.
  [[nodiscard]] std::uint32_t sequence() const { return sequence_; }
  [[nodiscard]] const SourceCounters& counters() const { return counters_; }

 private:
  struct Stream {
    PacketOrder order;
    CaptureEstimate estimate;
  };

  const PoseSourceSettings settings_;
  std::array<Stream, kMaxPoseCameras> streams_{};  // by camera
  PoseMerger merger_;
  SentPoses poses_;
  std::uint32_t sequence_ = 0;
  SourceCounters counters_;
};

}  // namespace touchline::hal
