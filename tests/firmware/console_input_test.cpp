// Tests the input of the console's clients, from the mailbox to the robots, and pictures from the loop to the console.
#include "firmware/console_input.h"

#include "firmware/external_input.h"
#include "firmware/picture_exchange.h"
#include "hal/linux/monotonic_clock.h"
#include "tests/color/owned_picture.h"
#include "tests/firmware/loop_fixture.h"
#include "tools/programs/latency/allocation_counter.h"

namespace touchline::testing {
namespace {

using namespace std::chrono_literals;

constexpr Instant kLoopTime{1000s}, kMachineTime{77s};

ExternalCommand turn(RobotId id, float radps, Instant received) {
  ExternalCommand command;
  command.id = id;
  command.twist = {0.0f, radps};
  command.received = received;
  return command;
}

class ConsoleInputTest : public ::testing::Test {
 protected:
  ConsoleInputTest() {
    ExternalInputSettings settings;
    settings.commands = &commands;
    settings.console = &console;
    input.emplace(settings);
  }
  Mailbox<ExternalCommands> commands;
  ConsoleLink console;
  std::optional<ExternalInput> input;
};

TEST_F(ConsoleInputTest, AStopIsAReasonToHaltUntilItIsTakenBack) {
  EXPECT_EQ(input->halt(kLoopTime, 1s), kHaltNone);
  console.input.put({true, {}});
  input->take(kLoopTime, kMachineTime);
  EXPECT_EQ(input->halt(kLoopTime, 1s), kHaltConsole);
  input->take(kLoopTime + 1h, kMachineTime + 1h);
  EXPECT_EQ(input->halt(kLoopTime + 1h, 1s), kHaltConsole) << "also if the console's thread is gone";
  console.input.put({false, {}});
  input->take(kLoopTime + 1h, kMachineTime + 1h);
  EXPECT_EQ(input->halt(kLoopTime + 1h, 1s), kHaltNone);
}

// After Save, "Stop was pressed" would be wrong.
TEST_F(ConsoleInputTest, TheEndOfASetupIsAReasonOfItsOwn) {
  ConsoleInput wanted;
  wanted.stop = wanted.setup_ended = true;
  console.input.put(wanted);
  input->take(kLoopTime, kMachineTime);
  EXPECT_EQ(input->halt(kLoopTime, 1s), kHaltConsole | kHaltSetupEnded);
}

TEST_F(ConsoleInputTest, AStartLetsAnotherRefereeBeFollowed) {
  std::atomic<std::uint32_t> releases{0};
  ExternalInputSettings settings;
  settings.console = &console;
  settings.referee_releases = &releases;
  input.emplace(settings);
  StopRules rules({});
  ConsoleInput wanted;
  const auto expect_releases = [&](std::uint32_t expected) {
    console.input.put(wanted);
    input->take(kLoopTime, kMachineTime);
    input->apply_to(rules, kLoopTime, 1s);
    EXPECT_EQ(releases, expected);
  };
  expect_releases(0);
  wanted.stop = true;
  expect_releases(0);
  wanted.stop = false;
  ++wanted.starts;
  wanted.start_number = rules.held_number();
  expect_releases(1);
  expect_releases(1);
}

TEST_F(ConsoleInputTest, ADraftOfTheFilesMovesNothingUnlessTheConsolePermits) {
  const auto halt_of = [this](SetupMode mode, SetupWish wish) {
    ExternalInputSettings settings;
    settings.console = &console;
    settings.setup = mode;
    input.emplace(settings);
    EXPECT_EQ(input->halt(kLoopTime, 1s), mode == SetupMode::kCalibrated ? kHaltNone : kHaltSetup) << "at first";
    ConsoleInput wanted;
    wanted.setup = wish;
    console.input.put(wanted);
    input->take(kLoopTime, kMachineTime);
    return input->halt(kLoopTime, 1s);
  };
  EXPECT_EQ(halt_of(SetupMode::kCalibrated, SetupWish::kNone), kHaltNone);
  EXPECT_EQ(halt_of(SetupMode::kCalibrated, SetupWish::kStand), kHaltSetup);
  EXPECT_EQ(halt_of(SetupMode::kDraft, SetupWish::kNone), kHaltSetup);
  EXPECT_EQ(halt_of(SetupMode::kDraft, SetupWish::kStand), kHaltSetup);
  EXPECT_EQ(halt_of(SetupMode::kDraft, SetupWish::kPermit), kHaltNone);
  EXPECT_EQ(halt_of(SetupMode::kUncalibrated, SetupWish::kPermit), kHaltSetup);
}

TEST_F(ConsoleInputTest, TheConsoleComesBeforeOtherPrograms) {
  ExternalCommands table;
  table.push_back(turn(1, 1.0f, kMachineTime));
  table.push_back(turn(2, 2.0f, kMachineTime));
  commands.put(table);
  ConsoleInput wanted;
  wanted.commands.push_back(turn(2, 9.0f, kMachineTime));
  console.input.put(wanted);
  input->take(kLoopTime, kMachineTime);
  ASSERT_EQ(input->commands().size(), 2U);
  EXPECT_EQ(input->commands()[0].id, 2);
  EXPECT_EQ(input->commands()[0].twist.w_radps, 9.0f);
  EXPECT_EQ(input->commands()[1].id, 1);
  EXPECT_EQ(input->commands()[1].twist.w_radps, 1.0f);
  console.input.put({});
  input->take(kLoopTime, kMachineTime);
  ASSERT_EQ(input->commands().size(), 2U);
  EXPECT_EQ(input->commands()[1].twist.w_radps, 2.0f) << "given back";
}

TEST_F(ConsoleInputTest, ACommandCountsForThreeTenthsOfASecond) {
  ConsoleInput wanted;
  wanted.commands.push_back(turn(2, 9.0f, kMachineTime));
  console.input.put(wanted);
  input->take(kLoopTime, kMachineTime + 300ms);
  EXPECT_EQ(input->commands()[0].received, kLoopTime) << "as new";
  input->take(kLoopTime + 1ms, kMachineTime + 300ms + 1ns);
  EXPECT_EQ(input->commands()[0].received, Instant{}) << "too old for every limit";
}

StopRules rules_without_reasons() {
  StopRules rules({.stop_after = 1h, .has_emergency_stop = false});
  rules.accept_frame(kLoopTime, kLoopTime);
  rules.check_last_frame(kLoopTime);
  return rules;
}

TEST_F(ConsoleInputTest, ADriverThatIsSilentForASecondStopsRobotsWhateverTheConsolesThreadDoes) {
  StopRules rules = rules_without_reasons();
  const auto halt_after = [&](Duration time) {
    input->take(kLoopTime + time, kMachineTime + time);
    input->apply_to(rules, kLoopTime + time, 1s);
    return rules.halt();
  };
  ConsoleInput wanted;
  console.input.put(wanted);
  EXPECT_EQ(halt_after(1h), kHaltNone) << "nobody drives";
  wanted.driver_heard = kMachineTime;
  console.input.put(wanted);
  // From here on the console's thread hangs.
  EXPECT_EQ(halt_after(1s), kHaltNone);
  const std::uint32_t before = console.held_number;
  EXPECT_FALSE(console.is_held);
  EXPECT_EQ(halt_after(1s + 1ns), kHaltDriver);
  EXPECT_EQ(console.held_number, before + 1) << "the console learns it when it goes on";
  EXPECT_TRUE(console.is_held);
  // The thread continues. Neither messages that waited in the socket nor a start for an earlier stop move robots.
  wanted.driver_heard = kMachineTime + 5s;
  wanted.starts = 1;
  wanted.start_number = before;
  console.input.put(wanted);
  EXPECT_EQ(halt_after(5s), kHaltDriver);
  EXPECT_EQ(halt_after(5s + 10ms), kHaltDriver);
  wanted.starts = 2;
  wanted.start_number = before + 1;
  console.input.put(wanted);
  EXPECT_EQ(halt_after(5s + 20ms), kHaltNone);
  // A start counts once.
  EXPECT_EQ(halt_after(7s), kHaltDriver);
  wanted.driver_heard.reset();
  console.input.put(wanted);
  EXPECT_EQ(halt_after(8s), kHaltDriver) << "until a start, also if the driver has gone";
}

TEST_F(ConsoleInputTest, AStartOfAnEarlierSessionIsNotOneOfThisSession) {
  ConsoleInput wanted;
  wanted.starts = 1;
  console.input.put(wanted);
  StopRules former = rules_without_reasons();
  input->take(kLoopTime, kMachineTime);
  input->apply_to(former, kLoopTime, 1s);
  StopRuleSettings next;
  next.stop_after = 1h;
  next.has_emergency_stop = false;
  next.held = former.held();
  next.held.reasons = kHaltCrash;
  StopRules rules(next);
  wanted.start_number = rules.held_number();
  ExternalInputSettings settings;
  settings.console = &console;
  ExternalInput other(settings);
  console.input.put(wanted);
  other.take(kLoopTime, kMachineTime);
  other.apply_to(rules, kLoopTime, 1s);
  EXPECT_EQ(rules.halt() & kHaltCrash, kHaltCrash);
}

class ConsoleLoop : public LoopTest {
 protected:
  ConsoleLoop() {
    settings.external.console = &console;
    settings.pictures = &pictures;
    camera.show_robot();
  }
  ConsoleLink console;
  PictureExchange pictures;
};

TEST_F(ConsoleLoop, AStopDoesNotWaitForTheNextFrameAndEndsWithAStart) {
  start();
  run_until(1.0);
  EXPECT_FALSE(all_stop(0.0, 1.0));
  const std::size_t sent = radio.sent.size();
  console.input.put({true, {}});
  static_cast<void>(loop->iterate());
  ASSERT_GT(radio.sent.size(), sent);
  EXPECT_TRUE(radio.sent[sent].stop);
  EXPECT_NEAR(radio.sent[sent].at_s, 1.0, 1e-6);
  run_until(2.0);
  EXPECT_TRUE(all_stop(1.001, 2.0));
  console.input.put({false, {}});
  run_until(3.0);
  EXPECT_FALSE(all_stop(2.03, 3.0));
}

// CLOCK_MONOTONIC passes while the test runs, but not by an hour.
TEST_F(ConsoleLoop, ASilentDriverStopsRobotsWithoutAnyHelpOfTheConsole) {
  ConsoleInput driven;
  driven.driver_heard = hal::MonotonicClock::read() + 1h;
  console.input.put(driven);
  start();
  run_until(1.0);
  EXPECT_FALSE(all_stop(0.0, 1.0));
  driven.driver_heard = hal::MonotonicClock::read() - kDriverSilence - 1ms;
  console.input.put(driven);
  run_until(2.0);
  EXPECT_TRUE(all_stop(1.001, 2.0));
  EXPECT_EQ(loop->halt(), kHaltDriver);
}

TEST_F(ConsoleLoop, AStartOfTheDriverEndsAnEmergencyAsTheButtonDoes) {
  settings.faults.resume_after_emergency = false;
  settings.start_button = true;
  gpio.pull(1.0, 1.5);
  start();
  ConsoleInput input;
  const auto press_start = [&](std::uint32_t number) {
    ++input.starts;
    input.start_number = number;
    console.input.put(input);
  };
  run_until(0.5);
  EXPECT_EQ(loop->halt(), kHaltStart);
  press_start(console.held_number);
  run_until(0.9);
  EXPECT_FALSE(all_stop(0.55, 0.9));
  const std::uint32_t before = console.held_number;
  run_until(1.6);
  press_start(before);  // it was sent before the switch was pulled
  run_until(2.0);
  EXPECT_TRUE(all_stop(1.001, 2.0));
  EXPECT_EQ(loop->halt(), kHaltEmergency);
  press_start(console.held_number);
  run_until(3.0);
  EXPECT_FALSE(all_stop(2.03, 3.0));
}

TEST_F(ConsoleLoop, AnotherStopOfStandingRobotsIsReportedWithItsNumber) {
  camera.add({1.0, 9.0, ErrorCode::kTimeout});  // without frames, clients learn of a stop from reports
  start();
  ConsoleInput stopped;
  stopped.stop = true;
  for (const double until_s : {2.0, 2.2}) {
    ++stopped.stops;
    console.input.put(stopped);
    run_until(until_s);
  }
  std::vector<std::uint32_t> numbers;
  for (const Report& report : reports()) {
    if (report.kind == Report::Kind::kHalt && report.halt.halt != kHaltNone) numbers.push_back(report.halt.stop_number);
  }
  ASSERT_GE(numbers.size(), 2U);
  EXPECT_EQ(numbers.back(), 2U);
  EXPECT_EQ(*(numbers.end() - 2), 1U);
}

TEST_F(ConsoleLoop, APictureIsCopiedOnlyIfItIsWanted) {
  pictures.allocate(std::size_t{3} * FakeCamera::kWidth * FakeCamera::kHeight);
  start();
  run_until(0.5);
  EXPECT_FALSE(pictures.has_arrived());
  pictures.request();
  run_until(0.6);
  ASSERT_TRUE(pictures.has_arrived());
  EXPECT_EQ(pictures.frame().width_px, FakeCamera::kWidth);
  const std::uint64_t number = pictures.number();
  EXPECT_GE(number, 20U);
  EXPECT_LE(number, 30U);
  run_until(1.0);
  EXPECT_EQ(pictures.number(), number) << "it belongs to the reader until the next request";
  EXPECT_EQ(pictures.findings(), nullptr) << "not asked for";
  pictures.request(true);
  run_until(1.1);
  ASSERT_TRUE(pictures.has_arrived());
  ASSERT_NE(pictures.findings(), nullptr);
  const PictureFindings& findings = *pictures.findings();
  ASSERT_FALSE(findings.regions.empty());
  ASSERT_EQ(findings.verdicts.size(), findings.regions.size());
  const Region& region = findings.regions[0];
  const auto u = static_cast<std::uint16_t>(region.centroid.u_px), v = static_cast<std::uint16_t>(region.centroid.v_px);
  EXPECT_EQ(findings.classifier.color_at(pictures.frame(), u, v), region.color);
  pictures.request();
  run_until(1.2);
  ASSERT_TRUE(pictures.has_arrived());
  EXPECT_EQ(pictures.findings(), nullptr);
}

class PictureExchangeTest : public ::testing::TestWithParam<PixelFormat> {};

TEST_P(PictureExchangeTest, ThePictureArrivesWithoutItsPadding) {
  for (const auto& [width, height] : std::vector<std::pair<int, int>>{{64, 48}, {7, 5}}) {
    OwnedPicture picture(GetParam(), width, height, 24);
    std::mt19937 random(1);
    picture.fill([&] { return static_cast<std::uint8_t>(random()); });
    const Frame frame = picture.frame();
    PictureExchange exchange;
    exchange.allocate(picture_layout(frame.format, frame.width_px, frame.height_px).bytes);
    EXPECT_FALSE(exchange.is_wanted());
    exchange.request();
    EXPECT_TRUE(exchange.is_wanted());
    const std::uint64_t before = latency::allocations_of_this_thread();
    exchange.put(frame, 5);
    EXPECT_EQ(latency::allocations_of_this_thread(), before);
    ASSERT_TRUE(exchange.has_arrived());
    EXPECT_EQ(exchange.number(), 5U);
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) ASSERT_EQ(channels_at(exchange.frame(), u, v), channels_at(frame, u, v));
    }
  }
}

TEST_P(PictureExchangeTest, APictureThatDoesNotFitArrivesEmpty) {
  const OwnedPicture picture(GetParam(), 64, 48, 0);
  const Frame frame = picture.frame();
  PictureExchange exchange;
  exchange.allocate(picture_layout(frame.format, frame.width_px, frame.height_px).bytes - 1);
  exchange.request();
  exchange.put(frame, 5);
  ASSERT_TRUE(exchange.has_arrived());
  EXPECT_EQ(exchange.frame().width_px, 0);
}

INSTANTIATE_TEST_SUITE_P(Formats, PictureExchangeTest, ::testing::ValuesIn(kAllFormats),
                         [](const auto& test) { return name_of(test.param); });

}  // namespace
}  // namespace touchline::testing
