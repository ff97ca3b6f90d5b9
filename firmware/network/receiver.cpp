#include "firmware/network/receiver.h"

#include <poll.h>
#include <algorithm>
#include <array>
#include <exception>
#include <utility>

#include "hal/linux/monotonic_clock.h"

namespace touchline::network {
namespace {

using namespace std::chrono_literals;

// The largest message that is decoded. A referee's packet has about 2 KB, one with all commands of a team less.
constexpr std::size_t kMaxMessageBytes = 16384;
// Time without a message after which closed sockets and the end of the thread are looked at.
constexpr int kPollMs = 50;
constexpr Duration kCheckPeriod = 1s;
constexpr int kMessagesPerTurn = 64;

void count(std::atomic<std::uint64_t>& counter, std::uint64_t add = 1) {
  counter.fetch_add(add, std::memory_order_relaxed);
}

}  // namespace

ReceiverInput::ReceiverInput(std::string name, std::unique_ptr<Decoder> decoder,
                             std::unique_ptr<hal::NetworkInput> socket, std::vector<hal::NetworkRange> senders,
                             double rate_hz)
    : name_(std::move(name)),
      decoder_(std::move(decoder)),
      socket_(std::move(socket)),
      senders_(std::move(senders)),
      limits_(rate_hz),
      reopening_(name_) {}

void ReceiverInput::fail(const Error& error, Instant now, const Print& print) {
  socket_->close();
  is_open_ = false;
  reopening_.on_failure(error, now, print);
}

void ReceiverInput::serve(Instant now, const Print& print) {
  if (is_open_ && now >= next_check_) {
    next_check_ = now + kCheckPeriod;
    if (const Result<void> checked = socket_->check(); !checked.ok()) fail(checked.error(), now, print);
  }
  if (is_open_ || !reopening_.is_due(now)) return;
  if (const Result<void> opened = socket_->open(); !opened.ok()) return fail(opened.error(), now, print);
  is_open_ = true;
  next_check_ = now + kCheckPeriod;
  reopening_.on_success(print);
}

bool ReceiverInput::is_permitted(const hal::ReceivedMessage& message) const {
  return message.is_local || std::any_of(senders_.begin(), senders_.end(), [&](const hal::NetworkRange& range) {
           return range.contains(message.sender);
         });
}

bool ReceiverInput::receive(Instant now, TeamColor own, std::span<std::byte> buffer, std::optional<DecodedMessage>& out,
                            const Print& print) {
  out.reset();
  if (!is_open_) return false;
  const Result<std::optional<hal::ReceivedMessage>> received = socket_->receive(buffer);
  if (!received.ok()) {
    fail(received.error(), now, print);
    return false;
  }
  if (!received.value()) return false;
  const hal::ReceivedMessage& message = *received.value();
  if (!is_permitted(message)) {
    count(counts_.refused);
  } else if (!limits_.pass(message, now)) {
    count(counts_.over_rate);
  } else if (!message.is_complete) {
    count(counts_.malformed);
  } else if (Result<DecodedMessage> decoded = decoder_->decode(buffer.first(message.size), own); decoded.ok()) {
    count(counts_.accepted);
    count(counts_.other_team, decoded.value().batch.other_team);
    out = std::move(decoded).value();
  } else {
    count(counts_.malformed);
    if (!std::exchange(malformed_reported_, true)) {
      print("network: " + name_ + ": a message is ignored: " + decoded.text() + "; further ones are counted");
    }
  }
  return true;
}

ReceiverInputs make_inputs(const NetworkPlan& plan, const config::Configuration& configuration) {
  ReceiverInputs out;
  for (const PlannedInput& planned : plan.inputs) {
    out.push_back(std::make_unique<ReceiverInput>(name_of(planned), make_decoder(planned.protocol, configuration),
                                                  hal::make_network_input(planned.address), planned.senders,
                                                  planned.rate_hz));
  }
  return out;
}

Receiver::Receiver(ReceiverInputs inputs, TeamColor own, std::vector<RobotId> robots,
                   Mailbox<ExternalCommands>& commands, Mailbox<RefereeState>& referee, Print print)
    : inputs_(std::move(inputs)),
      commands_(commands),
      referee_(referee),
      print_(std::move(print)),
      own_(own),
      robots_(std::move(robots)),
      buffer_(kMaxMessageBytes) {
  // Here, so that a wrong address is reported at once.
  for (const auto& input : inputs_) input->serve(hal::MonotonicClock::read(), print_);
  thread_ = std::thread([this] { work(); });
}

void Receiver::end() {
  end_.store(true, std::memory_order_release);
  if (thread_.joinable()) thread_.join();
}

void Receiver::work() {
  std::vector<pollfd> descriptors;
  while (!end_.load(std::memory_order_acquire)) {
    try {
      descriptors.clear();
      for (const auto& input : inputs_) descriptors.push_back({input->descriptor(), POLLIN, 0});
      ::poll(descriptors.data(), descriptors.size(), std::exchange(messages_wait_, false) ? 0 : kPollMs);
      receive_all();
    } catch (const std::exception& error) {  // memory is short: messages are missing, the game goes on
      if (!std::exchange(reported_, true)) print_("network: the receiver failed: " + std::string(error.what()));
      std::this_thread::sleep_for(std::chrono::milliseconds(kPollMs));
    }
  }
}

void Receiver::receive_all() {
  table_changed_ = false;
  for (const auto& input : inputs_) {
    input->serve(hal::MonotonicClock::read(), print_);
    drain(*input);
  }
  if (table_changed_) commands_.put(table_);
}

void Receiver::drain(ReceiverInput& input) {
  std::optional<DecodedMessage> message;
  for (int i = 0; i < kMessagesPerTurn; ++i) {
    const Instant now = hal::MonotonicClock::read();
    if (!input.receive(now, own_, buffer_, message, print_)) return;
    if (message) input.count_unknown_robots(apply(*message, now));
  }
  messages_wait_ = true;
}

std::uint64_t Receiver::apply(DecodedMessage& message, Instant now) {
  std::uint64_t unknown = 0;
  for (ExternalCommand& command : message.batch.commands) {
    // The table holds as many robots as a team has: others must not take their places.
    if (std::find(robots_.begin(), robots_.end(), command.id) == robots_.end()) {
      ++unknown;
      continue;
    }
    command.received = now;
    const auto known = std::find_if(table_.begin(), table_.end(),
                                    [&](const ExternalCommand& other) { return other.id == command.id; });
    if (known != table_.end()) {
      *known = command;
    } else {
      table_.push_back(command);
    }
    table_changed_ = true;
  }
  if (!message.referee) return unknown;
  message.referee->received = now;
  if (message.referee->own_is_yellow) own_ = *message.referee->own_is_yellow ? TeamColor::kYellow : TeamColor::kBlue;
  referee_.put(*message.referee);
  return unknown;
}

}  // namespace touchline::network
