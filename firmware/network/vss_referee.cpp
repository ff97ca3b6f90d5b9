#include <firmware/network/proto/vss_referee.pb.h>

#include <optional>

#include "firmware/network/referee.h"
#include "hal/poses/protobuf.h"

namespace touchline::network {
namespace {

struct FoulMeaning {
  GamePhase phase = GamePhase::kHalt;
  Restart restart = Restart::kNone;
};

std::optional<FoulMeaning> meaning_of_foul(std::int32_t foul) {
  switch (foul) {
    // Robots are being placed.
    case VSSRef_Foul_FREE_KICK:
      return FoulMeaning{GamePhase::kPrepare, Restart::kFreeKick};
    case VSSRef_Foul_PENALTY_KICK:
      return FoulMeaning{GamePhase::kPrepare, Restart::kPenalty};
    case VSSRef_Foul_GOAL_KICK:
      return FoulMeaning{GamePhase::kPrepare, Restart::kGoalKick};
    case VSSRef_Foul_FREE_BALL:
      return FoulMeaning{GamePhase::kPrepare, Restart::kFreeBall};
    case VSSRef_Foul_KICKOFF:
      return FoulMeaning{GamePhase::kPrepare, Restart::kKickOff};
    case VSSRef_Foul_STOP:
      return FoulMeaning{GamePhase::kStop};
    case VSSRef_Foul_GAME_ON:
      return FoulMeaning{GamePhase::kRunning};
    case VSSRef_Foul_HALT:
      return FoulMeaning{GamePhase::kHalt};
    default:
      return std::nullopt;
  }
}

// Decodes a message of a version with a quadrant, or else of an older one.
Result<VSSRef_VSSRef_Command> decode_command(std::span<const std::byte> bytes) {
  VSSRef_VSSRef_Command message = VSSRef_VSSRef_Command_init_zero;
  const Result<void> decoded = hal::decode_message(VSSRef_VSSRef_Command_fields, bytes, &message);
  if (decoded.ok()) return message;
  VSSRef_VSSRef_OldCommand old = VSSRef_VSSRef_OldCommand_init_zero;
  if (!hal::decode_message(VSSRef_VSSRef_OldCommand_fields, bytes, &old).ok()) return decoded.error();
  message = VSSRef_VSSRef_Command_init_zero;
  message.foul = old.foul;
  message.teamcolor = old.teamcolor;
  return message;
}

// Returns 0 for a number that is not in the referee's list.
std::uint8_t number_up_to(std::int32_t most, std::int32_t number) {
  return number > 0 && number <= most ? static_cast<std::uint8_t>(number) : std::uint8_t{0};
}

}  // namespace

Result<RefereeMessage> decode_vss_referee(std::span<const std::byte> bytes, TeamColor own) {
  if (bytes.empty()) return failure(ErrorCode::kCorruptFrame, "the datagram is empty");
  TOUCHLINE_TRY_ASSIGN(const VSSRef_VSSRef_Command message, decode_command(bytes));
  const std::optional<FoulMeaning> meaning = meaning_of_foul(message.foul);
  if (!meaning) return failure(ErrorCode::kOutOfRange, "unknown foul %d", int{message.foul});
  RefereeState state;
  state.phase = meaning->phase;
  state.restart = meaning->restart;
  const std::int32_t our_color = own == TeamColor::kYellow ? VSSRef_Color_YELLOW : VSSRef_Color_BLUE;
  // A free ball is nobody's, whatever color the referee fills in.
  state.restart_is_ours =
      state.restart != Restart::kNone && state.restart != Restart::kFreeBall && message.teamcolor == our_color;
  state.quadrant = number_up_to(4, message.foul_quadrant);
  state.half = number_up_to(5, message.game_half);
  return RefereeMessage{state, std::nullopt};
}

}  // namespace touchline::network
