#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/config/board_file.h"
#include "hal/mock/arena.h"
#include "hal/result.h"
#include "tests/board/wire.h"
#include "tests/radio/touchline_packets.h"

namespace touchline::board {

/// Result of playing some frames.
struct PlayResult {
  // One letter per frame: 'd' packets with speeds, 's' stop packets, 'm' both, '.' none; upper case: frame not shown.
  std::string frames;
  std::uint64_t shown = 0, late = 0, packets = 0, stops = 0;
  std::int32_t latest_us = 0;              // largest delay of a frame, by the guest's clock
  int last_error = 0;                      // errno of the guest for the last frame that was not shown
  double own_path_m = 0.0;                 // distance that all own robots drove in the arena
  std::vector<hal::mock::Placement> ball;  // true position of the ball in each frame
};

/// Runs the mock arena in lockstep with an emulated board: robots, ball, camera and radio channel are simulated here,
/// and the firmware runs on the board. The arena takes the next picture after the packet for the previous one arrived.
class Lockstep {
 public:
  /// `pictures`, `radio`: connected sockets. `frame_timeout_s`: longest time to wait for an answer or a packet, in the
  /// host's time.
  Lockstep(const config::BoardFile& board, std::uint64_t seed, int pictures, int radio, double frame_timeout_s);

  enum class Expect : std::uint8_t { kSpeeds, kPacket, kNothing };
  /// Plays `count` frames. `kind`: kFrame, kNoFrame or kTornFrame. With kPacket, each frame that is shown must be
  /// followed by a packet, with kSpeeds by a packet with wheel speeds (the board sends stop packets even without
  /// frames). On an error, `out` has the frames so far.
  Result<void> play(std::uint64_t count, ToGuest kind, Expect expect, PlayResult& out);
  /// Makes the guest open or close the camera device.
  Result<void> plug(bool in);
  /// Receives packets until none arrives for `quiet_s` seconds of the host's time.
  Result<void> listen(double quiet_s, PlayResult& out);

  [[nodiscard]] const hal::mock::Arena& arena() const { return arena_; }
  /// Returns the number of bytes on the serial line that belong to no valid packet. Losses of the simulated radio do
  /// not count.
  [[nodiscard]] std::uint64_t damaged_bytes() const { return stream_.skipped_bytes(); }
  [[nodiscard]] std::uint64_t sequence_gaps() const { return sequence_gaps_; }

 private:
  struct Received {
    std::uint64_t drives = 0, stops = 0;
  };
  [[nodiscard]] FrameHeader next_header(ToGuest kind);
  Result<FrameAnswer> exchange(const FrameHeader& header);
  Result<Received> receive(double timeout_s, Expect expect);
  Result<void> play_frame(ToGuest kind, Expect expect, PlayResult& out);

  hal::mock::Arena arena_;
  std::uint32_t fourcc_, period_us_;
  double frame_timeout_s_;
  int pictures_, radio_;
  std::vector<bool> is_own_;  // for each robot, in the order of the arena's robots
  std::vector<std::uint8_t> picture_;
  CommandStream stream_;
  std::uint32_t number_ = 0;
  int last_sequence_ = -1;
  std::uint64_t sequence_gaps_ = 0;
};

}  // namespace touchline::board
