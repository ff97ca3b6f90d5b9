#include <firmware/network/proto/vss_referee.pb.h>

#include <optional>

#include "firmware/network/referee.h"
#include "hal/poses/protobuf.h"

namespace touchline::network {
namespace {

std::optional<GamePhase> phase_of_foul(std::int32_t foul) {
  switch (foul) {
    case VSSRef_Foul_FREE_KICK:
    case VSSRef_Foul_PENALTY_KICK:
    case VSSRef_Foul_GOAL_KICK:
    case VSSRef_Foul_FREE_BALL:
    case VSSRef_Foul_KICKOFF:
      return GamePhase::kPrepare;  // robots are being placed
    case VSSRef_Foul_STOP:
      return GamePhase::kStop;
    case VSSRef_Foul_GAME_ON:
      return GamePhase::kRunning;
    case VSSRef_Foul_HALT:
      return GamePhase::kHalt;
    default:
      return std::nullopt;
  }
}

}  // namespace

Result<RefereeMessage> decode_vss_referee(std::span<const std::byte> bytes) {
  if (bytes.empty()) return failure(ErrorCode::kCorruptFrame, "the datagram is empty");
  VSSRef_VSSRef_Command message = VSSRef_VSSRef_Command_init_zero;
  TOUCHLINE_TRY(hal::decode_message(VSSRef_VSSRef_Command_fields, bytes, &message));
  const std::optional<GamePhase> phase = phase_of_foul(message.foul);
  if (!phase) return failure(ErrorCode::kOutOfRange, "unknown foul %d", int{message.foul});
  RefereeState state;
  state.phase = *phase;
  return RefereeMessage{state, std::nullopt};
}

}  // namespace touchline::network
