// Packets of the two referees, written by protobuf's own library with their definitions.
#include "firmware/network/referee.h"

#include <gtest/gtest.h>
#include <tests/network/ssl_referee.pb.h>
#include <tests/network/vss_referee.pb.h>

#include <string>

#include "tests/network/example_frame.h"

namespace touchline::network {
namespace {

Referee example_message() {
  Referee message;
  message.set_source_identifier("test");
  message.set_packet_timestamp(1700000000123456);
  message.set_stage(Referee::NORMAL_FIRST_HALF);
  message.set_stage_time_left(-5);
  message.set_command(Referee::NORMAL_START);
  message.set_command_counter(7);
  message.set_command_timestamp(1700000000000000);
  for (Referee::TeamInfo* team : {message.mutable_yellow(), message.mutable_blue()}) {
    team->set_score(1);
    team->set_red_cards(0);
    team->add_yellow_card_times(1000);
    team->set_yellow_cards(0);
    team->set_timeouts(4);
    team->set_timeout_time(300000000);
    team->set_goalkeeper(0);
  }
  message.mutable_yellow()->set_name("Lemons");
  message.mutable_blue()->set_name("Plums");
  message.mutable_designated_position()->set_x(1);
  message.mutable_designated_position()->set_y(2);
  message.add_game_events("\x08\x01");
  message.set_blue_team_on_positive_half(true);
  return message;
}

Result<RefereeState> state_of(Result<RefereeMessage> message) {
  if (!message.ok()) return std::move(message).error();
  return message.value().state;
}

Result<RefereeState> decoded(const Referee& message, const RefereeSettings& settings,
                             TeamColor own = TeamColor::kBlue) {
  const std::string bytes = message.SerializeAsString();
  return state_of(decode_ssl_referee(bytes_of(bytes), settings, own));
}

TEST(SslReferee, CommandsBecomePhases) {
  for (const auto& [command, phase] :
       std::map<Referee::Command, GamePhase>{{Referee::HALT, GamePhase::kHalt},
                                             {Referee::STOP, GamePhase::kStop},
                                             {Referee::NORMAL_START, GamePhase::kRunning},
                                             {Referee::FORCE_START, GamePhase::kRunning},
                                             {Referee::PREPARE_KICKOFF_YELLOW, GamePhase::kPrepare},
                                             {Referee::PREPARE_KICKOFF_BLUE, GamePhase::kPrepare},
                                             {Referee::PREPARE_PENALTY_YELLOW, GamePhase::kPrepare},
                                             {Referee::PREPARE_PENALTY_BLUE, GamePhase::kPrepare},
                                             {Referee::DIRECT_FREE_YELLOW, GamePhase::kRunning},
                                             {Referee::DIRECT_FREE_BLUE, GamePhase::kRunning},
                                             {Referee::INDIRECT_FREE_YELLOW, GamePhase::kRunning},
                                             {Referee::INDIRECT_FREE_BLUE, GamePhase::kRunning},
                                             {Referee::TIMEOUT_YELLOW, GamePhase::kHalt},
                                             {Referee::TIMEOUT_BLUE, GamePhase::kHalt},
                                             {Referee::GOAL_YELLOW, GamePhase::kStop},
                                             {Referee::GOAL_BLUE, GamePhase::kStop},
                                             {Referee::BALL_PLACEMENT_YELLOW, GamePhase::kStop},
                                             {Referee::BALL_PLACEMENT_BLUE, GamePhase::kStop}}) {
    Referee message = example_message();
    message.set_command(command);
    const Result<RefereeState> state = decoded(message, {});
    ASSERT_TRUE(state.ok()) << state.text();
    EXPECT_EQ(state.value().phase, phase) << Referee::Command_Name(command);
    EXPECT_TRUE(state.value().repeats);
  }
}

TEST(SslReferee, RobotsStandInBreaks) {
  for (const Referee::Stage stage : {Referee::NORMAL_HALF_TIME, Referee::EXTRA_TIME_BREAK, Referee::EXTRA_HALF_TIME,
                                     Referee::PENALTY_SHOOTOUT_BREAK, Referee::POST_GAME}) {
    Referee message = example_message();
    message.set_stage(stage);
    const Result<RefereeState> state = decoded(message, {});
    ASSERT_TRUE(state.ok());
    EXPECT_EQ(state.value().phase, GamePhase::kHalt) << Referee::Stage_Name(stage);
  }
}

TEST(SslReferee, NamesTellColorSideAndHeights) {
  const RefereeSettings settings{"plums ", {{"Lemons", 0.14f}, {"PLUMS", 0.15f}}};
  Referee message = example_message();
  message.mutable_blue()->set_score(2);
  Result<RefereeState> state = decoded(message, settings);
  ASSERT_TRUE(state.ok());
  EXPECT_EQ(state.value().own_is_yellow, false);
  EXPECT_EQ(state.value().own_on_positive_half, true);
  EXPECT_EQ(state.value().own_height_m, 0.15f);
  EXPECT_EQ(state.value().opponent_height_m, 0.14f);
  EXPECT_EQ(state.value().score, (Score{2, 1}));
  message.mutable_yellow()->Swap(message.mutable_blue());
  state = decoded(message, settings);
  ASSERT_TRUE(state.ok());
  EXPECT_EQ(state.value().own_is_yellow, true);
  EXPECT_EQ(state.value().own_on_positive_half, false);
  EXPECT_EQ(state.value().own_height_m, 0.15f);
  EXPECT_EQ(state.value().opponent_height_m, 0.14f);
}

TEST(SslReferee, UnclearNamesTellNothing) {
  Referee message = example_message();
  for (const char* own : {"", "Cherries"}) {
    const Result<RefereeState> state = decoded(message, {own, {{"Lemons", 0.14f}}});
    ASSERT_TRUE(state.ok());
    EXPECT_FALSE(state.value().own_is_yellow.has_value());
    EXPECT_FALSE(state.value().own_on_positive_half.has_value());
    EXPECT_FALSE(state.value().score.has_value());
    EXPECT_EQ(state.value().opponent_height_m, 0.0f);
  }
  message.mutable_yellow()->set_name("Plums");
  EXPECT_FALSE(decoded(message, {"Plums", {}}).value().own_is_yellow.has_value());
  message = example_message();
  message.clear_blue_team_on_positive_half();
  const Result<RefereeState> state = decoded(message, {"Plums", {}});
  EXPECT_EQ(state.value().own_is_yellow, false);
  EXPECT_FALSE(state.value().own_on_positive_half.has_value());
}

TEST(SslReferee, RejectsUnknownNumbersAndAbsentFields) {
  // Field 4 (command) with 18, then 300, then -1, appended: the last value counts.
  const std::string message = example_message().SerializeAsString();
  EXPECT_EQ(decode_ssl_referee(bytes_of(message + "\x20\x12"), {}, TeamColor::kBlue).text(), "unknown command 18");
  EXPECT_EQ(decode_ssl_referee(bytes_of(message + "\x20\xac\x02"), {}, TeamColor::kBlue).text(), "unknown command 300");
  EXPECT_EQ(decode_ssl_referee(bytes_of(message + "\x20\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01"), {}, TeamColor::kBlue)
                .text(),
            "unknown command -1");
  EXPECT_EQ(decode_ssl_referee(bytes_of(message + "\x10\x0e"), {}, TeamColor::kBlue).text(), "unknown stage 14");
  Referee incomplete = example_message();
  incomplete.clear_blue();
  const std::string bytes = incomplete.SerializePartialAsString();
  EXPECT_EQ(decode_ssl_referee(bytes_of(bytes), {}, TeamColor::kBlue).text(),
            "not a valid message: missing required field");
  EXPECT_FALSE(decode_ssl_referee({}, {}, TeamColor::kBlue).ok());
  Referee long_name = example_message();
  long_name.mutable_blue()->set_name(std::string(128, 'a'));
  EXPECT_EQ(decoded(long_name, {}).code(), ErrorCode::kCorruptFrame);
}

TEST(SslReferee, CommandsTellTheRestartAndWhoTakesIt) {
  struct Expected {
    Referee::Command command;
    Restart restart;
    bool of_yellow;
  };
  for (const auto& [command, restart, of_yellow] : {Expected{Referee::PREPARE_KICKOFF_YELLOW, Restart::kKickOff, true},
                                                    Expected{Referee::PREPARE_KICKOFF_BLUE, Restart::kKickOff, false},
                                                    Expected{Referee::PREPARE_PENALTY_YELLOW, Restart::kPenalty, true},
                                                    Expected{Referee::PREPARE_PENALTY_BLUE, Restart::kPenalty, false},
                                                    Expected{Referee::DIRECT_FREE_YELLOW, Restart::kFreeKick, true},
                                                    Expected{Referee::DIRECT_FREE_BLUE, Restart::kFreeKick, false},
                                                    Expected{Referee::INDIRECT_FREE_BLUE, Restart::kFreeKick, false}}) {
    Referee message = example_message();
    message.set_command(command);
    const RefereeState state = decoded(message, {"Lemons", {}}).value();
    EXPECT_EQ(state.restart, restart);
    EXPECT_EQ(state.restart_is_ours, of_yellow) << "the yellow team is ours by its name";
    EXPECT_TRUE(state.lines_up);
    EXPECT_EQ(decoded(message, {}, TeamColor::kBlue).value().restart_is_ours, !of_yellow) << "by the team file";
  }
  Referee stop = example_message();
  stop.set_command(Referee::STOP);
  EXPECT_EQ(decoded(stop, {"Lemons", {}}).value().restart, Restart::kNone);
  EXPECT_FALSE(decoded(stop, {"Lemons", {}}).value().restart_is_ours);
}

template <class Message>
Result<RefereeState> decoded_vss(const Message& message, TeamColor own = TeamColor::kBlue) {
  const std::string bytes = message.SerializeAsString();
  return state_of(decode_vss_referee(bytes_of(bytes), own));
}

TEST(VssReferee, FoulsBecomePhases) {
  for (const auto& [foul, phase] : std::map<VSSRef::Foul, GamePhase>{{VSSRef::FREE_KICK, GamePhase::kPrepare},
                                                                     {VSSRef::PENALTY_KICK, GamePhase::kPrepare},
                                                                     {VSSRef::GOAL_KICK, GamePhase::kPrepare},
                                                                     {VSSRef::FREE_BALL, GamePhase::kPrepare},
                                                                     {VSSRef::KICKOFF, GamePhase::kPrepare},
                                                                     {VSSRef::STOP, GamePhase::kStop},
                                                                     {VSSRef::GAME_ON, GamePhase::kRunning},
                                                                     {VSSRef::HALT, GamePhase::kHalt}}) {
    VSSRef::VSSRef_Command message;
    message.set_foul(foul);
    message.set_teamcolor(VSSRef::YELLOW);
    message.set_foulquadrant(VSSRef::QUADRANT_3);
    message.set_timestamp(12.5);
    const Result<RefereeState> state = decoded_vss(message);
    ASSERT_TRUE(state.ok()) << state.text();
    EXPECT_EQ(state.value().phase, phase);
    EXPECT_FALSE(state.value().repeats);
    EXPECT_FALSE(state.value().own_is_yellow.has_value());
  }
}

TEST(VssReferee, ReadsOlderVersions) {
  VSSRef::VSSRef_CommandOfOlderVersions message;
  message.set_foul(VSSRef::STOP);
  message.set_timestamp(12.5);
  const Result<RefereeState> state = decoded_vss(message);
  ASSERT_TRUE(state.ok()) << state.text();
  EXPECT_EQ(state.value().phase, GamePhase::kStop);
  EXPECT_EQ(state.value().quadrant, 0);
  message.set_foul(VSSRef::KICKOFF);
  message.set_teamcolor(VSSRef::YELLOW);
  EXPECT_TRUE(decoded_vss(message, TeamColor::kYellow).value().restart_is_ours);
}

TEST(VssReferee, KeepsRestartTeamQuadrantAndHalf) {
  VSSRef::VSSRef_Command message;
  message.set_teamcolor(VSSRef::YELLOW);
  message.set_foulquadrant(VSSRef::QUADRANT_3);
  message.set_gamehalf(VSSRef::SECOND_HALF);
  for (const auto& [foul, restart] : std::map<VSSRef::Foul, Restart>{{VSSRef::FREE_KICK, Restart::kFreeKick},
                                                                     {VSSRef::PENALTY_KICK, Restart::kPenalty},
                                                                     {VSSRef::GOAL_KICK, Restart::kGoalKick},
                                                                     {VSSRef::FREE_BALL, Restart::kFreeBall},
                                                                     {VSSRef::KICKOFF, Restart::kKickOff},
                                                                     {VSSRef::GAME_ON, Restart::kNone}}) {
    message.set_foul(foul);
    const Result<RefereeState> yellow = decoded_vss(message, TeamColor::kYellow), blue = decoded_vss(message);
    ASSERT_TRUE(yellow.ok() && blue.ok());
    EXPECT_EQ(yellow.value().restart, restart);
    EXPECT_EQ(yellow.value().restart_is_ours, restart != Restart::kNone && restart != Restart::kFreeBall);
    EXPECT_FALSE(blue.value().restart_is_ours);
    EXPECT_EQ(yellow.value().quadrant, 3);
    EXPECT_EQ(yellow.value().half, 2);
    EXPECT_FALSE(yellow.value().lines_up) << "people place the robots";
  }
  message.set_teamcolor(VSSRef::NONE);
  message.set_foul(VSSRef::KICKOFF);
  EXPECT_FALSE(decoded_vss(message).value().restart_is_ours);
}

TEST(VssReferee, RejectsUnknownFoulsAndEmptyDatagrams) {
  EXPECT_EQ(decode_vss_referee(bytes_of("\x08\x08"), TeamColor::kBlue).text(), "unknown foul 8");
  EXPECT_EQ(decode_vss_referee({}, TeamColor::kBlue).text(), "the datagram is empty");
}

}  // namespace
}  // namespace touchline::network
