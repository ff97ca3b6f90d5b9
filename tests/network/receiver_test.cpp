#include "firmware/network/receiver.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <deque>
#include <limits>
#include <mutex>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "hal/linux/monotonic_clock.h"

namespace touchline::network {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kFieldPc = 0xc0a80114, kOtherSender = 0xc0a80115;

// Messages: "1" drives robot 1; "y" and "b": the referee makes us yellow or blue; "h" and "g": it halts the game, or
// lets it go on; anything else is malformed.
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
      out.referee->state.own_is_yellow = letter == 'y';
    } else if (letter == 'h' || letter == 'g') {
      out.referee.emplace();
      out.referee->state.phase = letter == 'h' ? GamePhase::kHalt : GamePhase::kRunning;
    } else if (letter == 'v') {
      return failure(ErrorCode::kOutOfRange, "v = %d is too fast", static_cast<int>(message.size()));
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
  std::size_t capacity = std::numeric_limits<std::size_t>::max();  // as that of a socket's buffer
  std::optional<std::vector<hal::NetworkRange>> filter;
  std::uint64_t dropped = 0;

  void add(const std::string& text, std::uint32_t sender, bool is_complete = true, std::uint16_t port = 1) {
    const std::scoped_lock lock(mutex);
    const auto contains = [&](const hal::NetworkRange& range) { return range.contains(sender); };
    const bool passes = !filter || sender == 0 || std::any_of(filter->begin(), filter->end(), contains);
    if (!passes || messages.size() >= capacity) {
      ++dropped;
      return;
    }
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
  std::uint64_t drop_others(const std::optional<std::vector<hal::NetworkRange>>& senders) override {
    line_.filter = senders;
    return std::exchange(line_.dropped, 0);
  }

 private:
  Line& line_;
};

PlannedInput plan(config::InputProtocol protocol, double rate_hz) {
  PlannedInput out;
  out.protocol = protocol;
  out.address = hal::parse_network_address("udp://0.0.0.0:5").value();
  out.senders = {{kFieldPc, 32}};
  out.rate_hz = rate_hz;
  out.key = "network.input[0].senders in board.toml:14";
  return out;
}

class ThreadsReceiver : public ::testing::Test {
 protected:
  void start(double rate_hz = 1000.0) {
    ReceiverInputs inputs;
    inputs.push_back(std::make_unique<ReceiverInput>(plan(config::InputProtocol::kJson, rate_hz),
                                                     std::make_unique<LetterDecoder>(),
                                                     std::make_unique<FakeInput>(line_), 1s));
    receiver_ = std::make_unique<Receiver>(std::move(inputs), TeamColor::kBlue, std::vector<RobotId>{1, 2, 3, 4},
                                           *commands_, *referee_, releases_, [this](const std::string& line) {
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
  std::atomic<std::uint32_t> releases_{0};
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
  line_.add("1", kOtherSender);
  line_.add("y", kOtherSender);
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
}

// One input without a thread; the test sets its time.
class Input : public ::testing::Test {
 protected:
  explicit Input(config::InputProtocol protocol = config::InputProtocol::kVsssReferee)
      : input_(plan(protocol, 1000.0), std::make_unique<LetterDecoder>(), std::make_unique<FakeInput>(line_), 1s) {
    input_.serve(now_, print_);
  }

  // Receives all messages that wait.
  std::vector<AcceptedMessage> receive() {
    std::vector<AcceptedMessage> accepted;
    std::optional<AcceptedMessage> message;
    input_.serve(now_, print_);
    while (input_.receive(now_, TeamColor::kBlue, buffer_, message, print_)) {
      if (message) accepted.push_back(*message);
    }
    return accepted;
  }

  Line line_;
  std::vector<std::string> printed_;
  const Print print_ = [this](const std::string& line) { printed_.push_back(line); };
  std::array<std::byte, 100> buffer_{};
  Instant now_{100s};
  ReceiverInput input_;
};

TEST_F(Input, ExplainsEachDistinctBadMessageOfEachSenderOnce) {
  for (const auto& [text, sender] : std::vector<std::pair<std::string, std::uint32_t>>{
           {"x", kFieldPc}, {"v", kFieldPc}, {"vv", kFieldPc}, {"x", kFieldPc}, {"", 0}, {"v", kFieldPc}, {"x", 0}}) {
    line_.add(text, sender);
  }
  line_.add("1", kFieldPc, false);
  EXPECT_TRUE(receive().empty());
  const std::string begin = "network: vsss-referee from udp://0.0.0.0:5: a message of ",
                    end = "; further ones of this kind are counted";
  const std::vector<std::string> expected{begin + "192.168.1.20:1 is ignored: no letter" + end,
                                          begin + "192.168.1.20:1 is ignored: v = 1 is too fast" + end,
                                          begin + "a program at the unix socket is ignored: no letter" + end,
                                          begin + "192.168.1.20:1 is ignored: it is longer than 100 bytes" + end};
  EXPECT_EQ(printed_, expected);
  EXPECT_EQ(input_.counts().malformed, 8U);
}

TEST_F(Input, NamesARefusedSenderOnceAndTheKeyThatPermitsIt) {
  for (int i = 0; i < 3; ++i) line_.add("1", kOtherSender, true, static_cast<std::uint16_t>(i));
  line_.add("1", kOtherSender + 1);
  EXPECT_TRUE(receive().empty());
  const std::string begin = "network: vsss-referee from udp://0.0.0.0:5: messages of ";
  const std::vector<std::string> expected{
      begin + "192.168.1.21 are refused; to obey them, add 192.168.1.21 to network.input[0].senders in board.toml:14",
      begin + "192.168.1.22 are refused; to obey them, add 192.168.1.22 to network.input[0].senders in board.toml:14"};
  EXPECT_EQ(printed_, expected);
}

TEST_F(Input, AFloodOfDifferentMessagesPrintsFewLines) {
  std::mt19937 random(1);
  for (std::uint32_t i = 0; i < 10000; ++i) {
    line_.add("x", kOtherSender + i);
    line_.add(std::string(1 + random() % 90, 'v'), 0, true, static_cast<std::uint16_t>(i));
  }
  receive();
  EXPECT_LE(printed_.size(), ExplainedKinds::kMaxSenders + 1);
  ExplainedKinds kinds;
  int explained = 0;
  for (int i = 0; i < 10000; ++i) {
    std::string text(1 + random() % 20, 'a');
    for (char& c : text) c = static_cast<char>('a' + random() % 26);
    explained += kinds.add(static_cast<std::uint32_t>(random() % 100), text) != ExplainedKinds::Answer::kCount ? 1 : 0;
  }
  EXPECT_EQ(explained, ExplainedKinds::kMaxSenders * ExplainedKinds::kMaxKinds);
}

// 100 messages of refused senders in each millisecond, and a socket that holds as many as one of the usual size. The
// receiver's thread wakes up with the first ones, and later gets the processor only every 20 ms.
TEST_F(Input, NoStopIsLostInAFloodOfRefusedMessages) {
  line_.capacity = 270;
  std::size_t halts = 0, sent = 0;
  for (int ms = 0; ms < 3000; ++ms) {
    now_ += 1ms;
    for (int i = 0; i < 100; ++i) line_.add("g", kOtherSender + static_cast<std::uint32_t>(i % 3));
    if (ms % 32 == 5 && sent < 93) {
      line_.add("h", kFieldPc);
      ++sent;
    }
    if (ms > 2 && ms % 20 != 0) continue;
    for (const AcceptedMessage& message : receive()) {
      halts += message.referee && message.referee->phase == GamePhase::kHalt ? 1U : 0U;
    }
  }
  EXPECT_EQ(sent, 93U);
  EXPECT_EQ(halts, 93U);
  EXPECT_EQ(input_.counts().accepted, 93U);
  // When the flood is over, all messages are counted, and rejected ones reach the receiver again.
  for (int i = 0; i < 30; ++i) {
    now_ += 100ms;
    receive();
  }
  EXPECT_EQ(input_.counts().refused, 300000U);
  EXPECT_FALSE(line_.filter);
  line_.add("g", kOtherSender);
  receive();
  EXPECT_EQ(input_.counts().refused, 300001U);
}

TEST_F(Input, AStopOfAPermittedSenderIsNeverOverTheRate) {
  for (int i = 0; i < 5000; ++i) line_.add("g", 0);
  line_.add("h", 0);
  const std::vector<AcceptedMessage> accepted = receive();
  ASSERT_FALSE(accepted.empty());
  EXPECT_GT(input_.counts().over_rate, 4000U);
  EXPECT_EQ(accepted.back().referee->phase, GamePhase::kHalt);
}

TEST_F(ThreadsReceiver, FloodIsLimited) {
  constexpr std::uint64_t kFlood = 20000;
  for (std::uint64_t i = 0; i < kFlood; ++i) line_.add("1", kFieldPc);
  for (std::uint64_t i = 0; i < kFlood; ++i) line_.add("1", kOtherSender);
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
  // Senders that are silent for a second are forgotten.
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
  const std::vector<std::string> expected = {"network: json from udp://0.0.0.0:5: no cable; trying again",
                                             "network: json from udp://0.0.0.0:5: works again"};
  EXPECT_EQ(printed_, expected);
}

}  // namespace
}  // namespace touchline::network
