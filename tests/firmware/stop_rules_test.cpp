#include "firmware/stop_rules.h"

#include <gtest/gtest.h>

#include <utility>

#include "firmware/config/board_file.h"

namespace touchline {
namespace {

using namespace std::chrono_literals;

Instant after_start(double s) { return Instant(from_seconds(1000.0 + s)); }

constexpr hal::GpioInputs kAtRest{};
constexpr hal::GpioInputs kPulled{true, false, Duration::max()};
constexpr hal::GpioInputs kPressed{false, true, Duration::max()};

StopRuleSettings settings() {
  StopRuleSettings settings;
  settings.stop_after = 200ms;
  settings.radio_outage = 1s;
  settings.resume_after_emergency = true;
  return settings;
}

/// Rules with a good frame captured at 0 s, inputs at rest.
StopRules playing(const StopRuleSettings& settings = touchline::settings()) {
  StopRules rules(settings);
  rules.apply_inputs(kAtRest, after_start(0.0));
  rules.accept_frame(after_start(0.0), after_start(0.0));
  rules.check_last_frame(after_start(0.0));
  return rules;
}

TEST(StopRules, RobotsAreStoppedUntilTheFirstGoodFrame) {
  StopRules rules(settings());
  EXPECT_EQ(rules.halt(), kHaltNoFrames);
  rules.apply_inputs(kAtRest, after_start(0.0));
  rules.check_last_frame(after_start(0.0));
  EXPECT_EQ(rules.halt(), kHaltNoFrames);
  rules.accept_frame(after_start(0.0), after_start(0.01));
  rules.check_last_frame(after_start(0.01));
  EXPECT_TRUE(rules.may_move());
}

TEST(StopRules, AnOldFrameStopsRobots) {
  StopRules rules = playing();
  rules.check_last_frame(after_start(0.2));
  EXPECT_TRUE(rules.may_move()) << "its age is exactly the limit";
  rules.check_last_frame(after_start(0.2001));
  EXPECT_EQ(rules.halt(), kHaltNoFrames);
  rules.set_limits(300ms, 1s, true);
  rules.check_last_frame(after_start(0.3));
  EXPECT_TRUE(rules.may_move());
  rules.check_frame(after_start(0.0), after_start(0.31));
  EXPECT_EQ(rules.halt(), kHaltNoFrames) << "a frame that arrived too late";
}

TEST(StopRules, AnOlderFrameDoesNotReplaceANewerOne) {
  StopRules rules = playing();
  rules.accept_frame(after_start(-0.5), after_start(0.1));
  rules.check_last_frame(after_start(0.15));
  EXPECT_TRUE(rules.may_move());
}

TEST(StopRules, AStampInTheFutureCountsAsNow) {
  StopRules rules = playing();
  rules.accept_frame(after_start(3600.0), after_start(0.1));
  rules.check_last_frame(after_start(0.3));
  EXPECT_TRUE(rules.may_move());
  rules.check_last_frame(after_start(0.31));
  EXPECT_EQ(rules.halt(), kHaltNoFrames);
}

TEST(StopRules, AnEmergencyEndsATenthOfASecondAfterItsRelease) {
  StopRules rules = playing();
  rules.apply_inputs(kPulled, after_start(0.0));
  EXPECT_EQ(rules.halt(), kHaltEmergency);
  rules.apply_inputs(kAtRest, after_start(0.099));
  EXPECT_EQ(rules.halt(), kHaltEmergency);
  rules.apply_inputs(kAtRest, after_start(0.1));
  EXPECT_TRUE(rules.may_move());
}

TEST(StopRules, AnEmergencyMayNeedAStart) {
  StopRuleSettings latched = settings();
  latched.resume_after_emergency = false;
  StopRules rules = playing(latched);
  rules.apply_inputs(kPulled, after_start(0.0));
  rules.apply_inputs(hal::GpioInputs{true, true, Duration::max()}, after_start(0.01));
  rules.apply_inputs(kAtRest, after_start(10.0));
  EXPECT_EQ(rules.halt() & kHaltEmergency, kHaltEmergency) << "a press while the stop is pulled has no effect";
  rules.apply_inputs(kPressed, after_start(11.0));
  EXPECT_EQ(rules.halt() & kHaltEmergency, 0);
}

TEST(StopRules, ByDefaultAnEmergencyNeedsAStart) {
  EXPECT_FALSE(StopRuleSettings{}.resume_after_emergency);
  EXPECT_FALSE(config::FaultSettings{}.resume_after_emergency);
}

TEST(StopRules, OtherSettingsDoNotEndAnEmergencyThatNeedsAStart) {
  StopRuleSettings latched = settings();
  latched.resume_after_emergency = false;
  StopRules rules = playing(latched);
  rules.apply_inputs(kPulled, after_start(0.0));
  rules.set_limits(200ms, 1s, true);  // the file was read again while the switch is pulled
  rules.apply_inputs(kPulled, after_start(0.05));
  rules.apply_inputs(kAtRest, after_start(0.5));
  EXPECT_EQ(rules.halt(), kHaltEmergency);
  rules.apply_inputs(kPressed, after_start(1.0));
  EXPECT_EQ(rules.halt(), kHaltNone);
  rules.apply_inputs(kPulled, after_start(1.0));
  rules.set_limits(200ms, 1s, false);
  rules.apply_inputs(kPulled, after_start(1.1));
  rules.apply_inputs(kAtRest, after_start(1.5));
  EXPECT_EQ(rules.halt(), kHaltEmergency) << "pulled under the old setting, released under the new one";
}

TEST(StopRules, AStartOfThePageIsOneOfTheButton) {
  StopRuleSettings waiting = settings();
  waiting.resume_after_emergency = false;
  waiting.has_start_button = true;
  waiting.held.reasons = kHaltCrash;
  StopRules rules = playing(waiting);
  EXPECT_EQ(rules.halt(), kHaltStart | kHaltCrash);
  rules.start();
  EXPECT_EQ(rules.halt(), kHaltNone);
  EXPECT_TRUE(rules.is_started());
  rules.apply_inputs(kPulled, after_start(0.0));
  rules.start();
  rules.apply_inputs(kAtRest, after_start(0.5));
  EXPECT_EQ(rules.halt(), kHaltEmergency) << "a start while the switch is pulled has no effect";
  rules.start();
  EXPECT_EQ(rules.halt(), kHaltNone);
}

TEST(StopRules, AStopHasAnotherNumberThanTheOneBefore) {
  StopRuleSettings latched = settings();
  latched.resume_after_emergency = false;
  StopRules rules = playing(latched);
  EXPECT_FALSE(rules.is_held());
  std::uint32_t last = rules.held_number();
  const auto is_new = [&] { return std::exchange(last, rules.held_number()) != rules.held_number(); };
  for (int i = 0; i < 2; ++i) {
    rules.apply_inputs(kPulled, after_start(2.0 * i));
    EXPECT_TRUE(is_new());
    EXPECT_TRUE(rules.is_held());
    rules.apply_inputs(kPulled, after_start(2.0 * i + 0.5));
    EXPECT_FALSE(is_new());
    rules.apply_inputs(kAtRest, after_start(2.0 * i + 1.0));
    EXPECT_TRUE(is_new()) << "a start from before the release does not end it";
  }
  rules.start();
  EXPECT_FALSE(is_new());
  EXPECT_FALSE(rules.is_held());
  rules.hold(kHaltDriver, true);
  EXPECT_TRUE(is_new());
  rules.hold(kHaltDriver, false);
  EXPECT_FALSE(is_new()) << "with the driver's start it is heard again";
  EXPECT_EQ(rules.halt(), kHaltDriver);
}

TEST(StopRules, WhatHoldsUntilAStartHoldsInTheNextSession) {
  StopRuleSettings latched = settings();
  latched.resume_after_emergency = false;
  latched.has_start_button = true;
  StopRules former = playing(latched);
  former.apply_inputs(kPressed, after_start(0.0));
  former.hold(kHaltDriver, true);
  former.apply_inputs(kPulled, after_start(0.0));
  former.apply_inputs(kAtRest, after_start(0.15));
  StopRuleSettings next = settings();  // with other files: robots go on after an emergency
  next.has_start_button = true;
  next.held = former.held();
  StopRules rules = playing(next);
  EXPECT_EQ(rules.halt(), kHaltEmergency | kHaltDriver) << "the button was pressed before";
  EXPECT_GT(rules.held_number(), former.held_number());
  rules.start();
  EXPECT_EQ(rules.halt(), kHaltNone);
  StopRules pulled = playing();
  pulled.apply_inputs(kPulled, after_start(0.0));
  EXPECT_EQ(pulled.held().reasons, kHaltEmergency) << "nobody knows whether it is pulled meanwhile";
}

TEST(StopRules, AShortOutageOfTheRadioNeedsNoStart) {
  StopRules rules = playing();
  rules.apply_radio(std::nullopt);
  EXPECT_TRUE(rules.may_move());
  rules.apply_radio(0s);
  EXPECT_EQ(rules.halt(), kHaltRadio);
  rules.apply_radio(1s);
  rules.apply_radio(std::nullopt);
  EXPECT_TRUE(rules.may_move()) << "exactly the limit";
  rules.apply_radio(1s + 1ns);
  rules.start();
  EXPECT_EQ(rules.halt(), kHaltRadio) << "a start while it is away";
  rules.apply_radio(std::nullopt);
  EXPECT_EQ(rules.halt(), kHaltRadio);
  rules.start();
  EXPECT_TRUE(rules.may_move());
}

TEST(StopRules, AnEmergencyStopThatCannotBeReadCountsAsPulled) {
  StopRules rules = playing();
  rules.apply_inputs(std::nullopt, after_start(0.0));
  EXPECT_EQ(rules.halt(), kHaltUnreadableLine);
  rules.apply_inputs(kAtRest, after_start(0.05));
  EXPECT_EQ(rules.halt(), kHaltEmergency) << "readable again, but not yet inactive for long enough";
  StopRuleSettings without = settings();
  without.has_emergency_stop = false;
  StopRules other = playing(without);
  other.apply_inputs(std::nullopt, after_start(0.0));
  EXPECT_TRUE(other.may_move());
}

TEST(StopRules, RobotsWaitForTheStartButton) {
  StopRuleSettings button = settings();
  button.has_start_button = true;
  StopRules rules = playing(button);
  EXPECT_EQ(rules.halt(), kHaltStart);
  EXPECT_TRUE(rules.only_waits_for_start());
  EXPECT_FALSE(rules.is_started());
  rules.check_last_frame(after_start(1.0));
  EXPECT_FALSE(rules.only_waits_for_start());
  rules.apply_inputs(kPressed, after_start(1.0));
  EXPECT_EQ(rules.halt(), kHaltNoFrames) << "each reason stops robots by itself";
  EXPECT_TRUE(rules.is_started());
}

TEST(StopRules, AfterACrashRobotsWaitForAStart) {
  StopRuleSettings crashed = settings();
  crashed.held.reasons = kHaltCrash;
  StopRules rules = playing(crashed);
  EXPECT_EQ(rules.halt(), kHaltCrash);
  rules.accept_frame(after_start(100.0), after_start(100.0));
  rules.check_last_frame(after_start(100.0));
  rules.apply_inputs(kPulled, after_start(100.0));
  rules.apply_inputs(kAtRest, after_start(101.0));
  EXPECT_EQ(rules.halt() & ~kHaltNoFrames, kHaltCrash) << "neither frames nor a release of the emergency stop end it";
  crashed.has_start_button = true;
  StopRules with_button = playing(crashed);
  EXPECT_EQ(with_button.halt(), kHaltStart | kHaltCrash);
  EXPECT_TRUE(with_button.only_waits_for_start());
  with_button.apply_inputs(kPressed, after_start(0.1));
  EXPECT_TRUE(with_button.may_move());
}

TEST(StopRules, RefereeStopsRobotsWhateverTheInputsAre) {
  StopRules rules = playing();
  rules.apply_external(kHaltReferee);
  EXPECT_EQ(rules.halt(), kHaltReferee);
  rules.apply_inputs(kAtRest, after_start(0.1));
  rules.check_last_frame(after_start(0.1));
  EXPECT_EQ(rules.halt(), kHaltReferee);
  rules.apply_inputs(kPulled, after_start(0.1));
  rules.apply_external(kHaltTeams | kHaltSilence);
  EXPECT_EQ(rules.halt(), kHaltTeams | kHaltSilence | kHaltEmergency);
  rules.apply_inputs(kAtRest, after_start(0.19));
  rules.apply_inputs(kAtRest, after_start(0.21));
  rules.apply_external(kHaltNone);
  rules.check_last_frame(after_start(0.2));
  EXPECT_TRUE(rules.may_move());
}

TEST(StopRules, APictureThatIsNotTheTruthStopsUntilItIsRightAgain) {
  for (const auto& [member, halt] : {std::pair{&PictureTrace::repeats, kHaltRepeats},
                                     {&PictureTrace::overloads, kHaltOverload},
                                     {&PictureTrace::hides_field, kHaltField}}) {
    StopRules rules = playing();
    PictureTrace picture;
    picture.*member = true;
    rules.apply_picture(picture);
    EXPECT_EQ(rules.halt(), halt);
    rules.apply_inputs(kAtRest, after_start(0.1));
    rules.apply_external(kHaltNone);
    rules.check_last_frame(after_start(0.1));
    EXPECT_EQ(rules.halt(), halt) << "other rules do not end it";
    rules.apply_picture({});
    EXPECT_TRUE(rules.may_move());
  }
}

TEST(StopRules, WhatCannotBeCheckedWhileRobotsStandHoldsUntilAStart) {
  for (const auto& [member, halt] :
       {std::pair{&PictureTrace::replays, kHaltRepeats}, {&PictureTrace::contradicts, kHaltMotion}}) {
    StopRules rules = playing();
    PictureTrace picture;
    picture.*member = true;
    rules.apply_picture(picture);
    rules.apply_picture({});
    EXPECT_EQ(rules.halt(), halt);
    StopRules started = rules;
    started.start();
    started.apply_picture({});
    EXPECT_TRUE(started.may_move());
    rules.apply_inputs(kPressed, after_start(0.1));
    rules.apply_picture({});
    EXPECT_TRUE(rules.may_move());
  }
}

TEST(StopRules, EveryReasonIsDescribed) {
  std::uint32_t described = 0;
  for (const HaltDescription& reason : kHaltDescriptions) {
    EXPECT_EQ(described & reason.bit, 0u) << reason.word << " is described twice";
    described |= reason.bit;
    for (const std::string_view text : {reason.word, reason.reason, reason.robots, reason.ends_by}) {
      EXPECT_FALSE(text.empty()) << reason.word;
    }
  }
  // Bits are given in order, without gaps.
  EXPECT_EQ(described & (described + 1), 0u);
  EXPECT_EQ(described & (kExternalHalts | kPictureHalts), kExternalHalts | kPictureHalts);
}

}  // namespace
}  // namespace touchline
