#include "firmware/radio_group.h"

#include <algorithm>
#include <utility>

#include "firmware/fault_policy.h"

namespace touchline {
namespace {

Result<void> reopen_port(void* device) {
  auto& radio = *static_cast<hal::Radio*>(device);
  radio.close();
  return radio.open();
}

/// The robot whose port it is; kAllRobots: several may use it.
std::size_t only_robot(const GroupMember& member) {
  std::size_t robot = kAllRobots;
  for (std::size_t i = 0; i < kMaxRobotsPerTeam; ++i) {
    if (!member.reaches[i]) continue;
    if (robot != kAllRobots) return kAllRobots;
    robot = i;
  }
  return robot;
}

}  // namespace

RadioGroup::RadioGroup(std::vector<GroupMember> members, hal::Clock& clock, Duration first_pause, bool wait_for_driver)
    : clock_(clock), first_pause_(first_pause), wait_for_driver_(wait_for_driver) {
  for (GroupMember& member : members) ports_.push_back({std::move(member), nullptr, {}, 0, std::nullopt});
}

Result<void> RadioGroup::do_open() {
  do_close();
  std::vector<Result<void>> results;
  for (Port& port : ports_) {
    results.push_back(port.member.radio->open());
    // At the first time, a port that cannot be opened is a mistake in the file.
    if (was_open_ || results.back().ok()) continue;
    for (Port& opened : ports_) opened.member.radio->close();
    return results.back();
  }
  if (std::none_of(results.begin(), results.end(), [](const auto& result) { return result.ok(); })) {
    return results.front();
  }
  was_open_ = true;
  description_.clear();
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    Port& port = ports_[i];
    port.reconnector =
        std::make_unique<DeviceReconnector>(reopen_port, port.member.radio.get(), first_pause_, wait_for_driver_);
    if (!results[i].ok()) mark_lost(port, results[i].error());
    const std::string& described = port.member.radio->description();
    description_ += (description_.empty() || described.empty() ? "" : "; ") + described;
  }
  return {};
}

void RadioGroup::mark_lost(Port& port, Error error) {
  port.lost_at = clock_.now();
  port.reconnector->mark_lost(port.lost_at);
  port.event = std::move(error);
}

Result<void> RadioGroup::lose_if_broken(Port& port, Error error) {
  if (action_for(error.code) != FaultAction::kReopen) return error;
  mark_lost(port, std::move(error));
  return {};
}

void RadioGroup::add_routes(std::size_t receiver, hal::RadioRoutes& out) const {
  for (const Port& port : ports_) {
    if (is_open(port) && port.member.reaches[receiver]) port.member.radio->add_routes(receiver, out);
  }
}

std::optional<Instant> RadioGroup::partly_lost_since() const {
  std::optional<Instant> since;
  for (const Port& port : ports_) {
    if (port.reconnector && !is_open(port)) since = std::min(since.value_or(port.lost_at), port.lost_at);
  }
  return since;
}

std::optional<Error> RadioGroup::take_port_event() {
  for (Port& port : ports_) {
    if (port.event) return std::exchange(port.event, std::nullopt);
  }
  return std::nullopt;
}

Result<void> RadioGroup::do_send(const Packet& packet, std::size_t receiver) {
  Result<void> result;
  bool is_sent = false;
  for (Port& port : ports_) {
    if (!port.member.reaches[receiver] || !is_open(port)) continue;
    Result<void> sent = port.member.radio->send(packet, receiver);
    is_sent = is_sent || sent.ok() || sent.code() == ErrorCode::kBusy;
    if (!sent.ok()) sent = lose_if_broken(port, std::move(sent).error());
    if (!sent.ok()) result = std::move(sent);
  }
  if (is_sent || !result.ok()) return result;
  return failure(ErrorCode::kTimeout, "the radio for these robots is being reopened");
}

Result<Duration> RadioGroup::do_serve() {
  Duration due = Duration::max();
  const Instant now = clock_.now();
  for (Port& port : ports_) {
    if (!is_open(port)) {
      std::optional<Result<void>> attempt = port.reconnector->poll(now);
      if (attempt) port.event = attempt->ok() ? Error{ErrorCode::kOk, {}} : std::move(*attempt).error();
      continue;
    }
    const std::uint64_t unreachable = port.member.radio->counters().unreachable;
    count_unreachable(unreachable - std::exchange(port.unreachable, unreachable));
    Result<Duration> served = port.member.radio->serve();
    if (served.ok()) {
      due = std::min(due, served.value());
    } else {
      TOUCHLINE_TRY(lose_if_broken(port, std::move(served).error()));
    }
  }
  return due;
}

Result<std::size_t> RadioGroup::do_receive(std::span<std::byte> into, std::size_t& sender) {
  // The ports take turns, because the bytes of one call come from one robot.
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    Port& port = ports_[next_port_];
    next_port_ = (next_port_ + 1) % ports_.size();
    if (!is_open(port)) continue;
    Result<std::size_t> received = port.member.radio->receive(into, sender);
    if (!received.ok()) {
      TOUCHLINE_TRY(lose_if_broken(port, std::move(received).error()));
    } else if (received.value() > 0) {
      if (sender == kAllRobots) sender = only_robot(port.member);
      return received;
    }
  }
  return std::size_t{0};
}

Result<void> RadioGroup::do_drain(Instant deadline) {
  Result<void> result;
  for (Port& port : ports_) {
    if (!is_open(port)) continue;
    Result<void> drained = port.member.radio->drain(deadline);
    if (!drained.ok()) result = std::move(drained);
  }
  return result;
}

void RadioGroup::do_close() {
  for (Port& port : ports_) port.reconnector.reset();  // waits for an attempt in progress
  for (Port& port : ports_) port.member.radio->close();
}

}  // namespace touchline
