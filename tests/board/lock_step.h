#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/radio/packet_stream.h"
#include "firmware/config/board_file.h"
#include "hal/mock/arena.h"
#include "tests/board/wire.h"

namespace touchline::board {

/// What came of some frames.
struct Played {
  std::string
      frames;  // a letter each: 'd' driven, 's' stopped, 'm' both, '.' no packet came; upper case: frame not shown
  std::uint64_t shown = 0, late = 0, packets = 0, stops = 0;
  std::int32_t latest_us = 0;              // by the guest's clock, the frame that came most behind its time
  int last_error = 0;                      // why a frame was not shown; errno of the guest
  double own_path_m = 0.0;                 // of all own robots, as the arena has it
  std::vector<hal::mock::Placement> ball;  // as the arena has it, frame by frame
};

/// The arena's robots, ball, camera and air on this side, a board with a program that drives them on the other. Time
/// goes on frame by frame: the next picture is taken when the packet that the last one led to has come.
class LockStep {
 public:
  /// `pictures`, `radio`: connected sockets. `frame_timeout_s`, of this machine's time: for how long an answer or a
  /// packet may stay away.
  LockStep(const config::BoardFile& board, std::uint64_t seed, int pictures, int radio, double frame_timeout_s);

  enum class Expect : std::uint8_t { kSpeeds, kPacket, kNothing };
  /// `count` frames; with `expect` kPacket it is an error when a frame is shown and no packet follows, with kSpeeds,
  /// when none with speeds does: packets that stop the robots come of themselves too, while there is no frame.
  /// `reason`: what went wrong; what was played so far is in `out`.
  /// `kind`: kFrame, kNoFrame or kTornFrame.
  bool play(std::uint64_t count, ToGuest kind, Expect expect, Played& out, std::string& reason);
  /// The guest opens or closes its end of the camera.
  bool plug(bool in, std::string& reason);
  /// What is on the line until nothing comes for `quiet_s` of this machine's time.
  bool listen(double quiet_s, Played& out, std::string& reason);

  [[nodiscard]] const hal::mock::Arena& arena() const { return arena_; }
  /// Of the line, not of the air: bytes that belonged to no good packet.
  [[nodiscard]] std::uint64_t damaged_bytes() const { return stream_.skipped_bytes(); }
  [[nodiscard]] std::uint64_t sequence_gaps() const { return sequence_gaps_; }

 private:
  struct Heard {
    std::uint64_t drives = 0, stops = 0;
  };
  [[nodiscard]] FrameHeader next_header(ToGuest kind);
  bool exchange(const FrameHeader& header, FrameAnswer& answer, std::string& reason);
  bool hear(double timeout_s, Expect expect, Heard& heard, std::string& reason);
  bool one_frame(ToGuest kind, Expect expect, Played& out, std::string& reason);

  hal::mock::Arena arena_;
  std::uint32_t fourcc_, period_us_;
  double frame_timeout_s_;
  int pictures_, radio_;
  std::vector<bool> is_own_;  // in the order of the arena's robots
  std::vector<std::uint8_t> picture_;
  PacketStream stream_;
  std::uint32_t number_ = 0;
  int last_sequence_ = -1;
  std::uint64_t sequence_gaps_ = 0;
};

}  // namespace touchline::board
