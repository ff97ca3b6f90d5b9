#include <firmware/network/proto/ssl_referee.pb.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <string_view>

#include "firmware/network/referee.h"
#include "hal/poses/protobuf.h"

namespace touchline::network {
namespace {

enum class Taker : std::uint8_t { kNobody, kYellow, kBlue };

struct Meaning {
  GamePhase phase = GamePhase::kHalt;
  Restart restart = Restart::kNone;
  Taker taker = Taker::kNobody;
};

std::optional<Meaning> meaning_of(std::int32_t command) {
  switch (command) {
    case ssl_Command_HALT:
    case ssl_Command_TIMEOUT_YELLOW:  // people are on the field
    case ssl_Command_TIMEOUT_BLUE:
      return Meaning{GamePhase::kHalt};
    case ssl_Command_STOP:
    case ssl_Command_GOAL_YELLOW:
    case ssl_Command_GOAL_BLUE:
    case ssl_Command_BALL_PLACEMENT_YELLOW:  // our robots place no ball
    case ssl_Command_BALL_PLACEMENT_BLUE:
      return Meaning{GamePhase::kStop};
    case ssl_Command_PREPARE_KICKOFF_YELLOW:
      return Meaning{GamePhase::kPrepare, Restart::kKickOff, Taker::kYellow};
    case ssl_Command_PREPARE_KICKOFF_BLUE:
      return Meaning{GamePhase::kPrepare, Restart::kKickOff, Taker::kBlue};
    case ssl_Command_PREPARE_PENALTY_YELLOW:
      return Meaning{GamePhase::kPrepare, Restart::kPenalty, Taker::kYellow};
    case ssl_Command_PREPARE_PENALTY_BLUE:
      return Meaning{GamePhase::kPrepare, Restart::kPenalty, Taker::kBlue};
    case ssl_Command_NORMAL_START:
    case ssl_Command_FORCE_START:
      return Meaning{GamePhase::kRunning};
    case ssl_Command_DIRECT_FREE_YELLOW:
    case ssl_Command_INDIRECT_FREE_YELLOW:
      return Meaning{GamePhase::kRunning, Restart::kFreeKick, Taker::kYellow};
    case ssl_Command_DIRECT_FREE_BLUE:
    case ssl_Command_INDIRECT_FREE_BLUE:
      return Meaning{GamePhase::kRunning, Restart::kFreeKick, Taker::kBlue};
    default:
      return std::nullopt;
  }
}

/// Returns whether this is a break or the game is over; then robots stand whatever the command is. Returns nullopt for
/// an unknown stage.
std::optional<bool> is_break(std::int32_t stage) {
  switch (stage) {
    case ssl_Stage_NORMAL_HALF_TIME:
    case ssl_Stage_EXTRA_TIME_BREAK:
    case ssl_Stage_EXTRA_HALF_TIME:
    case ssl_Stage_PENALTY_SHOOTOUT_BREAK:
    case ssl_Stage_POST_GAME:
      return true;
    default:
      if (stage < ssl_Stage_NORMAL_FIRST_HALF_PRE || stage > ssl_Stage_POST_GAME) return std::nullopt;
      return false;
  }
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

bool same_team(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  a = trimmed(a), b = trimmed(b);
  return !a.empty() &&
         std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return lower(x) == lower(y); });
}

float height_of(std::string_view team, const RefereeSettings& settings) {
  for (const TeamHeight& entry : settings.heights) {
    if (same_team(entry.team, team)) return entry.height_m;
  }
  return 0.0f;
}

}  // namespace

Result<RefereeMessage> decode_ssl_referee(std::span<const std::byte> bytes, const RefereeSettings& settings,
                                          TeamColor our_color) {
  ssl_Referee message = ssl_Referee_init_zero;
  TOUCHLINE_TRY(hal::decode_message(ssl_Referee_fields, bytes, &message));
  const std::optional<bool> in_break = is_break(message.stage);
  if (!in_break) return failure(ErrorCode::kOutOfRange, "unknown stage %d", int{message.stage});
  const std::optional<Meaning> meaning = meaning_of(message.command);
  if (!meaning) return failure(ErrorCode::kOutOfRange, "unknown command %d", int{message.command});

  RefereeState state;
  state.phase = *in_break ? GamePhase::kHalt : meaning->phase;
  state.restart = *in_break ? Restart::kNone : meaning->restart;
  state.lines_up = true;
  state.repeats = true;
  const std::string_view yellow = message.yellow.name, blue = message.blue.name;
  const bool own_is_yellow = same_team(settings.own_team, yellow);
  if (own_is_yellow != same_team(settings.own_team, blue)) {
    state.own_is_yellow = own_is_yellow;
    const ssl_TeamInfo& own = own_is_yellow ? message.yellow : message.blue;
    const ssl_TeamInfo& opponent = own_is_yellow ? message.blue : message.yellow;
    state.score = Score{own.score, opponent.score};
    if (message.has_blue_team_on_positive_half) {
      state.own_on_positive_half = message.blue_team_on_positive_half != own_is_yellow;
    }
    state.own_height_m = height_of(own_is_yellow ? yellow : blue, settings);
    state.opponent_height_m = height_of(own_is_yellow ? blue : yellow, settings);
  }
  const bool we_are_yellow = state.own_is_yellow.value_or(our_color == TeamColor::kYellow);
  state.restart_is_ours =
      state.restart != Restart::kNone && meaning->taker == (we_are_yellow ? Taker::kYellow : Taker::kBlue);
  RefereeOrder order{message.command_counter, message.packet_timestamp, 0};
  if (message.has_source_identifier) order.source = std::hash<std::string_view>()(message.source_identifier);
  return RefereeMessage{state, order};
}

}  // namespace touchline::network
