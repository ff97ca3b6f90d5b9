#include "firmware/network/receiver.h"

#include <chrono>
#include <cstring>
#include <deque>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

#include "hal/linux/monotonic_clock.h"

namespace touchline::network {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kFieldPc = 0xc0a80114, kStranger = 0xc0a80115;

// Messages: "1" drives robot 1; "y" and "b": the referee makes us yellow or blue; anything else is malformed.
class LetterDecoder final : public Decoder {
 public:
  Result<DecodedMessage> decode(std::span<const std::byte> message, TeamColor own) override {
    const char letter = message.empty() ? '?' : static_cast<char>(message[0]);
    DecodedMessage out;
    if (letter >= '0' && letter <= '9') {
      ExternalCommand command;
      command.id = static_cast<RobotId>(letter - '0');
      command.twist.v_mps = own == TeamColor::kYellow ? 2.0f : 1.0f;
      out.batch.commands.push_back(command);
    } else if (letter == 'y' || letter == 'b') {
      out.referee.emplace();
      out.referee->own_is_yellow = letter == 'y';
    } else if (letter == 'o') {
      out.batch.other_team = 1;
    } else {
      return failure(ErrorCode::kCorruptFrame, "no letter");
    }
    return out;
  }
};

struct Line {
  std::mutex mutex;
  std::deque<std::pair<std::string, hal::ReceivedMessage>> messages;
  std::atomic<bool> broken{false};
  std::atomic<int> opened{0};

  void add(const std::string& text, std::uint32_t sender, bool is_complete = true, std::uint16_t port = 1) {
    const std::scoped_lock lock(mutex);
    messages.push_back({text, {text.size(), is_complete, sender == 0, sender, port}});
  }
};

class FakeInput final : public hal::NetworkInput {
 public:
  explicit FakeInput(Line& line) : line_(line) {}
  Result<void> open() override {
    ++line_.opened;
    if (line_.broken) return failure(ErrorCode::kDisconnected, "no cable");
    return {};
  }
  [[nodiscard]] int descriptor() const override { return -1; }
  Result<std::optional<hal::ReceivedMessage>> receive(std::span<std::byte> into) override {
    if (line_.broken) return failure(ErrorCode::kDisconnected, "no cable");
    const std::scoped_lock lock(line_.mutex);
    if (line_.messages.empty()) return std::optional<hal::ReceivedMessage>();
    const auto [text, message] = line_.messages.front();
    line_.messages.pop_front();
    std::memcpy(into.data(), text.data(), text.size());
    return std::optional(message);
  }
  Result<void> check() override { return {}; }
  void close() override {}

 private:
  Line& line_;
};

class ThreadsReceiver : public ::testing::Test {
 protected:
  void start(double rate_hz = 1000.0) {
    ReceiverInputs inputs;
    inputs.push_back(std::make_unique<ReceiverInput>("fake", std::make_unique<LetterDecoder>(),
                                                     std::make_unique<FakeInput>(line_),
                                                     std::vector<hal::NetworkRange>{{kFieldPc, 32}}, rate_hz));
    receiver_ = std::make_unique<Receiver>(std::move(inputs), TeamColor::kBlue, std::vector<RobotId>{1, 2, 3, 4},
                                           *commands_, *referee_, [this](const std::string& line) {
                                             const std::scoped_lock lock(line_.mutex);
                                             printed_.push_back(line);
                                           });
  }
  [[nodiscard]] const InputCounts& counts() const { return receiver_->inputs()[0]->counts(); }
  // Waits until all messages are received.
  void finish() {
    for (int i = 0; i < 5000; ++i) {
      {
        const std::scoped_lock lock(line_.mutex);
        if (line_.messages.empty()) break;
      }
      std::this_thread::sleep_for(1ms);
    }
    receiver_->end();
  }

  Line line_;
  std::vector<std::string> printed_;
  const std::unique_ptr<Mailbox<ExternalCommands>> commands_ = std::make_unique<Mailbox<ExternalCommands>>();
  const std::unique_ptr<Mailbox<RefereeState>> referee_ = std::make_unique<Mailbox<RefereeState>>();
  std::unique_ptr<Receiver> receiver_;
};

TEST_F(ThreadsReceiver, TableHasTheLastCommandOfEachRobot) {
  const Instant begin = hal::MonotonicClock::read();
  for (const char* const text : {"3", "1", "y", "1", "o"}) line_.add(text, 0);
  start();
  finish();
  ExternalCommands commands;
  ASSERT_TRUE(commands_->take(commands));
  ASSERT_EQ(commands.size(), 2U);
  EXPECT_EQ(commands[0].id, 3);
  EXPECT_FLOAT_EQ(commands[0].twist.v_mps, 1.0f);
  EXPECT_EQ(commands[1].id, 1);
  EXPECT_FLOAT_EQ(commands[1].twist.v_mps, 2.0f) << "the referee has made us yellow";
  EXPECT_GE(commands[1].received, begin);
  EXPECT_LE(commands[1].received, hal::MonotonicClock::read());
  RefereeState referee;
  ASSERT_TRUE(referee_->take(referee));
  EXPECT_EQ(referee.own_is_yellow, std::optional(true));
  EXPECT_GE(referee.received, begin);
  EXPECT_EQ(counts().accepted, 5U);
  EXPECT_EQ(counts().other_team, 1U);
}

TEST_F(ThreadsReceiver, RobotsThatWeDoNotHaveTakeNoPlaceInTheTable) {
  for (const char* const text : {"0", "5", "9", "2"}) line_.add(text, 0);
  start();
  finish();
  ExternalCommands commands;
  ASSERT_TRUE(commands_->take(commands));
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(commands[0].id, 2);
  EXPECT_EQ(counts().unknown_robot, 3U);
}

TEST_F(ThreadsReceiver, ForeignAndMalformedMessagesChangeNothing) {
  line_.add("1", kStranger);
  line_.add("y", kStranger);
  line_.add("x", 0);
  line_.add("", 0);
  line_.add("2", 0, false);
  line_.add("4", kFieldPc);
  start();
  finish();
  ExternalCommands commands;
  ASSERT_TRUE(commands_->take(commands));
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(commands[0].id, 4);
  RefereeState referee;
  EXPECT_FALSE(referee_->take(referee));
  EXPECT_EQ(counts().refused, 2U);
  EXPECT_EQ(counts().malformed, 3U);
  EXPECT_EQ(counts().accepted, 1U);
  EXPECT_EQ(printed_,
            std::vector<std::string>{"network: fake: a message is ignored: no letter; further ones are counted"});
}

TEST_F(ThreadsReceiver, FloodIsLimited) {
  constexpr std::uint64_t kFlood = 20000;
  for (std::uint64_t i = 0; i < kFlood; ++i) line_.add("1", kFieldPc);
  for (std::uint64_t i = 0; i < kFlood; ++i) line_.add("1", kStranger);
  const Instant begin = hal::MonotonicClock::read();
  start(100.0);
  finish();
  const double elapsed_s = seconds(hal::MonotonicClock::read() - begin);
  EXPECT_EQ(counts().accepted + counts().over_rate, kFlood);
  EXPECT_GE(counts().accepted, 10U);
  EXPECT_LE(static_cast<double>(counts().accepted), 10.0 + 100.0 * elapsed_s + 1.0);
  EXPECT_EQ(counts().refused, kFlood);
}

TEST_F(ThreadsReceiver, FloodOfOneProgramDoesNotKeepAnotherAway) {
  constexpr std::uint64_t kFlood = 20000;
  for (std::uint64_t i = 0; i < kFlood; ++i) {
    line_.add("x", kFieldPc);
    // Ten messages are always permitted.
    if (i % (kFlood / 10) == kFlood / 20) line_.add("1", kFieldPc, true, 2);
  }
  start(10.0);
  finish();
  EXPECT_EQ(counts().accepted, 10U);
  EXPECT_GE(counts().over_rate, kFlood / 2);
}

TEST(SenderLimits, ManySendersShareOneLimitAndDoNotDriveOutTheFirst) {
  SenderLimits limits(10.0);
  const Instant begin{std::chrono::seconds(100)};
  hal::ReceivedMessage first;
  first.port = 1;
  EXPECT_TRUE(limits.pass(first, begin));
  std::uint64_t passed = 0;
  for (std::uint16_t port = 2; port < 60002; ++port) {
    hal::ReceivedMessage other;
    other.port = port;
    passed += limits.pass(other, begin) ? 1U : 0U;
  }
  EXPECT_EQ(passed, 15U + 10U);
  for (int i = 0; i < 9; ++i) EXPECT_TRUE(limits.pass(first, begin));
  EXPECT_FALSE(limits.pass(first, begin));
  // Those that are silent for a second are forgotten.
  hal::ReceivedMessage late;
  late.port = 60003;
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(limits.pass(late, begin + 2s));
}

TEST_F(ThreadsReceiver, LostNetworkIsReportedOnceAndUsedAgain) {
  line_.broken = true;
  start();
  std::this_thread::sleep_for(500ms);
  EXPECT_LT(line_.opened, 6) << "with growing pauses";
  line_.broken = false;
  line_.add("5", 0);
  finish();
  EXPECT_EQ(counts().accepted, 1U);
  const std::vector<std::string> expected = {"network: fake: no cable; trying again", "network: fake: works again"};
  EXPECT_EQ(printed_, expected);
}

}  // namespace
}  // namespace touchline::network
