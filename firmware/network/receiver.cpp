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

// Size of the largest message that is decoded. A referee's packet has about 2 KB, one with all commands of a team less.
constexpr std::size_t kMaxMessageBytes = 16384;
// Longest wait for a message. After it, the thread checks closed sockets and whether it has to end.
constexpr int kPollMs = 50;
constexpr Duration kCheckPeriod = 1s;
constexpr int kMessagesPerTurn = 64;
// Rate of refused messages above which the system drops them. No league sends as many to a port, and the burst of 50 is
// a quarter of what the smallest usual buffer holds (net.core.rmem_default, 208 KB).
constexpr double kRefusedHz = 500.0;

void count(std::atomic<std::uint64_t>& counter, std::uint64_t add = 1) {
  counter.fetch_add(add, std::memory_order_relaxed);
}

}  // namespace

ReceiverInput::ReceiverInput(PlannedInput plan, std::unique_ptr<Decoder> decoder,
                             std::unique_ptr<hal::NetworkInput> socket, Duration referee_silence)
    : plan_(std::move(plan)),
      name_(name_of(plan_)),
      decoder_(std::move(decoder)),
      socket_(std::move(socket)),
      limits_(plan_.rate_hz),
      reopening_(name_),
      referee_(name_, referee_silence),
      refused_(kRefusedHz) {}

void ReceiverInput::fail(const Error& error, Instant now, const Print& print) {
  socket_->close();
  is_open_ = is_gate_closed_ = false;
  reopening_.on_failure(error, now, print);
}

void ReceiverInput::serve(Instant now, const Print& print) {
  if (is_open_ && now >= next_check_) {
    next_check_ = now + kCheckPeriod;
    if (const Result<void> checked = socket_->check(); !checked.ok()) fail(checked.error(), now, print);
    if (is_gate_closed_) update_gate();
  }
  if (is_open_ || !reopening_.is_due(now)) return;
  if (const Result<void> opened = socket_->open(); !opened.ok()) return fail(opened.error(), now, print);
  is_open_ = true;
  next_check_ = now + kCheckPeriod;
  reopening_.on_success(print);
}

bool ReceiverInput::is_permitted(const hal::ReceivedMessage& message) const {
  return message.is_local ||
         std::any_of(plan_.senders.begin(), plan_.senders.end(),
                     [&](const hal::NetworkRange& range) { return range.contains(message.sender); });
}

void ReceiverInput::refuse(const hal::ReceivedMessage& message, Instant now, const Print& print) {
  count(counts_.refused);
  if (explained_.add(message.sender, "refused") != ExplainedKinds::Answer::kCount) {
    const std::string sender = hal::ipv4_text(message.sender);
    print("network: " + name_ + ": messages of " + sender + " are refused; to obey them, " +
          how_to_permit(plan_, sender));
  }
  if (is_gate_closed_ || refused_.pass(now)) return;
  is_gate_closed_ = true;
  count(counts_.refused, socket_->drop_others(plan_.senders));
}

// Updates the filter once a second, because addresses of this computer may have changed, too.
void ReceiverInput::update_gate() {
  const std::uint64_t dropped = socket_->drop_others(plan_.senders);
  count(counts_.refused, dropped);
  if (static_cast<double>(dropped) > kRefusedHz * seconds(kCheckPeriod)) return;
  is_gate_closed_ = false;
  count(counts_.refused, socket_->drop_others(std::nullopt));
}

void ReceiverInput::explain(const hal::ReceivedMessage& message, const std::string& cause, const Print& print) {
  const ExplainedKinds::Answer answer = explained_.add(message.sender, cause);
  if (answer == ExplainedKinds::Answer::kCount) return;
  print("network: " + name_ + ": a message of " + sender_text(message.sender, message.port) + " is ignored: " + cause +
        (answer == ExplainedKinds::Answer::kExplain ? "; further ones of this kind are counted"
                                                    : "; all further ones of this sender are counted"));
}

bool ReceiverInput::receive(Instant now, TeamColor own, std::span<std::byte> buffer,
                            std::optional<AcceptedMessage>& out, const Print& print) {
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
    refuse(message, now, print);
    return true;
  }
  // A referee's message is always decoded, however many arrive, because a stop must not be lost.
  const bool is_in_rate = limits_.pass(message, now);
  if (!is_in_rate && !config::is_referee(plan_.protocol)) {
    count(counts_.over_rate);
    return true;
  }
  Result<DecodedMessage> decoded =
      message.is_complete ? decoder_->decode(buffer.first(message.size), own)
                          : failure(ErrorCode::kCorruptFrame, "it is longer than %zu bytes", buffer.size());
  const auto is_stop = [&] {
    return decoded.ok() && decoded.value().referee && !may_play_in(decoded.value().referee->state.phase);
  };
  if (!is_in_rate && !is_stop()) {
    count(counts_.over_rate);
  } else if (!decoded.ok()) {
    count(counts_.malformed);
    explain(message, decoded.text(), print);
  } else {
    accept(message, decoded.value(), now, out, print);
  }
  return true;
}

void ReceiverInput::accept(const hal::ReceivedMessage& message, DecodedMessage& decoded, Instant now,
                           std::optional<AcceptedMessage>& out, const Print& print) {
  count(counts_.accepted);
  count(counts_.other_team, decoded.batch.other_team);
  out.emplace(AcceptedMessage{decoded.batch, std::nullopt, std::move(decoded.arena)});
  for (ExternalCommand& command : out->batch.commands) command.received = now;
  if (!decoded.referee) return;
  out->referee = referee_.follow(message, *decoded.referee, now, print);
  if (!out->referee) count(counts_.without_effect);
}

ReceiverInputs make_inputs(const NetworkPlan& plan, const config::Configuration& configuration) {
  ReceiverInputs out;
  const Duration silence = from_seconds(configuration.board.faults.referee_timeout_s);
  for (const PlannedInput& planned : plan.inputs) {
    out.push_back(std::make_unique<ReceiverInput>(planned, make_decoder(planned.protocol, configuration),
                                                  hal::make_network_input(planned.address), silence));
  }
  return out;
}

Receiver::Receiver(ReceiverInputs inputs, TeamColor own, std::vector<RobotId> robots,
                   Mailbox<ExternalCommands>& commands, Mailbox<RefereeState>& referee,
                   const std::atomic<std::uint32_t>& referee_releases, Print print, std::shared_ptr<ArenaObjects> arena)
    : inputs_(std::move(inputs)),
      commands_(commands),
      referee_(referee),
      referee_releases_(referee_releases),
      releases_seen_(referee_releases.load(std::memory_order_relaxed)),
      print_(std::move(print)),
      arena_(std::move(arena)),
      own_(own),
      robots_(std::move(robots)),
      buffer_(kMaxMessageBytes) {
  // The sockets are opened here, so that a wrong address is reported at once.
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
    } catch (const std::exception& error) {  // out of memory: messages are missing, but the game goes on
      if (!std::exchange(reported_, true)) print_("network: the receiver failed: " + std::string(error.what()));
      std::this_thread::sleep_for(std::chrono::milliseconds(kPollMs));
    }
  }
}

void Receiver::receive_all() {
  table_changed_ = false;
  const std::uint32_t releases = referee_releases_.load(std::memory_order_relaxed);
  const bool is_released = std::exchange(releases_seen_, releases) != releases;
  for (const auto& input : inputs_) {
    input->serve(hal::MonotonicClock::read(), print_);
    if (is_released) input->release_referee();
    drain(*input);
  }
  if (table_changed_) commands_.put(table_);
}

void Receiver::drain(ReceiverInput& input) {
  std::optional<AcceptedMessage> message;
  for (int i = 0; i < kMessagesPerTurn; ++i) {
    const Instant now = hal::MonotonicClock::read();
    if (!input.receive(now, own_, buffer_, message, print_)) return;
    if (!message) continue;
    input.count_unknown_robots(apply(*message));
    if (message->arena) control_arena(input, *message->arena);
  }
  messages_wait_ = true;
}

void Receiver::control_arena(const ReceiverInput& input, const ArenaRequest& request) {
  const Result<void> done = arena_ != nullptr ? arena_->control(request) : ArenaObjects().control(request);
  if (!done.ok()) input.refuse_request(done.error(), print_);
}

std::uint64_t Receiver::apply(const AcceptedMessage& message) {
  std::uint64_t unknown = 0;
  for (const ExternalCommand& command : message.batch.commands) {
    // The table only has room for the robots of a team, so commands for unknown robots must not take their places.
    if (std::find(robots_.begin(), robots_.end(), command.id) == robots_.end()) {
      ++unknown;
      continue;
    }
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
  if (message.referee->own_is_yellow) own_ = *message.referee->own_is_yellow ? TeamColor::kYellow : TeamColor::kBlue;
  referee_.put(*message.referee);
  return unknown;
}

}  // namespace touchline::network
