// What the clients of the console want, from the mailbox to the robots, and pictures from the loop to the console.
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
  Mailbox<ConsoleInput> console;
  std::optional<ExternalInput> input;
};

TEST_F(ConsoleInputTest, AStopIsAReasonToHaltUntilItIsTakenBack) {
  EXPECT_EQ(input->halt(kLoopTime, 1s), kHaltNone);
  console.put({true, {}});
  input->take(kLoopTime, kMachineTime);
  EXPECT_EQ(input->halt(kLoopTime, 1s), kHaltConsole);
  input->take(kLoopTime + 1h, kMachineTime + 1h);
  EXPECT_EQ(input->halt(kLoopTime + 1h, 1s), kHaltConsole) << "also if the console's thread is gone";
  console.put({false, {}});
  input->take(kLoopTime + 1h, kMachineTime + 1h);
  EXPECT_EQ(input->halt(kLoopTime + 1h, 1s), kHaltNone);
}

TEST_F(ConsoleInputTest, AStartCountsOnce) {
  ConsoleInput wanted;
  wanted.starts = 3;
  console.put(wanted);
  input->take(kLoopTime, kMachineTime);
  EXPECT_FALSE(input->take_start()) << "pressed in a former session";
  wanted.starts = 4;
  console.put(wanted);
  input->take(kLoopTime, kMachineTime);
  EXPECT_TRUE(input->take_start());
  input->take(kLoopTime, kMachineTime);
  EXPECT_FALSE(input->take_start());
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
    console.put(wanted);
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
  console.put(wanted);
  input->take(kLoopTime, kMachineTime);
  ASSERT_EQ(input->commands().size(), 2U);
  EXPECT_EQ(input->commands()[0].id, 2);
  EXPECT_EQ(input->commands()[0].twist.w_radps, 9.0f);
  EXPECT_EQ(input->commands()[1].id, 1);
  EXPECT_EQ(input->commands()[1].twist.w_radps, 1.0f);
  console.put({});
  input->take(kLoopTime, kMachineTime);
  ASSERT_EQ(input->commands().size(), 2U);
  EXPECT_EQ(input->commands()[1].twist.w_radps, 2.0f) << "given back";
}

TEST_F(ConsoleInputTest, ACommandCountsForThreeTenthsOfASecond) {
  ConsoleInput wanted;
  wanted.commands.push_back(turn(2, 9.0f, kMachineTime));
  console.put(wanted);
  input->take(kLoopTime, kMachineTime + 300ms);
  EXPECT_EQ(input->commands()[0].received, kLoopTime) << "as new";
  input->take(kLoopTime + 1ms, kMachineTime + 300ms + 1ns);
  EXPECT_EQ(input->commands()[0].received, Instant{}) << "too old for every limit";
}

class ConsoleLoop : public LoopTest {
 protected:
  ConsoleLoop() {
    settings.external.console = &console;
    settings.pictures = &pictures;
    camera.show_robot();
  }
  Mailbox<ConsoleInput> console;
  PictureExchange pictures;
};

TEST_F(ConsoleLoop, AStopDoesNotWaitForTheNextFrameAndEndsWithAStart) {
  start();
  run_until(1.0);
  EXPECT_FALSE(all_stop(0.0, 1.0));
  const std::size_t sent = radio.sent.size();
  console.put({true, {}});
  static_cast<void>(loop->iterate());
  ASSERT_GT(radio.sent.size(), sent);
  EXPECT_TRUE(radio.sent[sent].stop);
  EXPECT_NEAR(radio.sent[sent].at_s, 1.0, 1e-6);
  run_until(2.0);
  EXPECT_TRUE(all_stop(1.001, 2.0));
  console.put({false, {}});
  run_until(3.0);
  EXPECT_FALSE(all_stop(2.03, 3.0));
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
