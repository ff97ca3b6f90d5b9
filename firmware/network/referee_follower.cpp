#include "firmware/network/referee_follower.h"

#include <array>
#include <cstdio>

namespace touchline::network {
namespace {

// Returns the difference of sequence numbers as in RFC 1982, so that a counter may wrap.
std::int32_t steps(std::uint32_t from, std::uint32_t to) { return static_cast<std::int32_t>(to - from); }

std::string seconds_text(Duration duration) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f s", seconds(duration));
  return text.data();
}

}  // namespace

std::optional<RefereeState> RefereeFollower::follow(const hal::ReceivedMessage& message, const RefereeMessage& content,
                                                    Instant now, const Print& print) {
  const Sender sender{message.sender, message.port, content.order ? content.order->source : 0};
  if (followed_ && followed_->state.repeats && now - followed_->state.received > silence_) followed_.reset();
  switch (followed_ ? relation(sender, content) : Relation::kNext) {
    case Relation::kSuperseded:
      return std::nullopt;
    case Relation::kOther:
      if (may_play_in(content.state.phase)) {
        explain(sender, "start",
                "a start of " + sender_text(sender.address, sender.port) + " is ignored, because " +
                    sender_text(followed_->sender.address, followed_->sender.port) + " is followed until " +
                    (followed_->state.repeats ? "it is silent for " + seconds_text(silence_)
                                              : "Start is pressed in the console, or Touchline is restarted"),
                print);
        return std::nullopt;
      }
      take_other(sender, content, print);
      return present();
    case Relation::kNext:
      break;
  }
  if (followed_) {
    release_hold(content);
  } else {
    begin_session(sender, content, print);
  }
  followed_->state = content.state;
  followed_->state.received = now;
  followed_->order = content.order.value_or(RefereeOrder{});
  newest_stamp_ = std::max(newest_stamp_, followed_->order.stamp_us);
  return present();
}

RefereeFollower::Relation RefereeFollower::relation(const Sender& sender, const RefereeMessage& content) const {
  const bool is_same = sender == followed_->sender;
  if (!content.order) return is_same ? Relation::kNext : Relation::kOther;
  const std::int32_t commands = steps(followed_->order.counter, content.order->counter);
  const bool is_older = content.order->stamp_us < followed_->order.stamp_us;
  if (is_same && commands >= 0 && !is_older) return Relation::kNext;
  // A controller that sends through several networks has several addresses and one source.
  const bool is_same_source = is_same || (sender.source != 0 && sender.source == followed_->sender.source);
  const bool is_copy = commands == 0 && content.order->stamp_us == followed_->order.stamp_us;
  return is_same_source && ((commands <= 0 && is_older) || is_copy) ? Relation::kSuperseded : Relation::kOther;
}

void RefereeFollower::begin_session(const Sender& sender, const RefereeMessage& content, const Print& print) {
  if (last_ != sender)
    print("network: " + name_ + ": following the referee at " + sender_text(sender.address, sender.port));
  last_ = sender;
  followed_ = Session{sender, {}, {}};
  if (!content.order) {
    // The sender has spoken after the stop, and a person has released the former sender.
    if (may_play_in(content.state.phase)) hold_.reset();
    return;
  }
  const std::uint32_t counter = content.order->counter;
  if (hold_) {
    hold_->counter = hold_->by == sender ? hold_->counter_of_by : counter;
    release_hold(content);
  } else if (may_play_in(content.state.phase) && content.order->stamp_us < newest_stamp_) {
    // Either the message is from a recording of the former referee, or the clock of a new referee is behind.
    hold_ = Hold{GamePhase::kHalt, false, std::nullopt, 0, counter};
    explain(sender, "clock",
            "the time stamps of " + sender_text(sender.address, sender.port) +
                " are older than those of the referee before: robots stand until it gives a new command",
            print);
  }
}

void RefereeFollower::take_other(const Sender& sender, const RefereeMessage& content, const Print& print) {
  hold_ = Hold{content.state.phase, content.state.lines_up, sender, content.order ? content.order->counter : 0,
               followed_->order.counter};
  explain(sender, "stop",
          sender_text(sender.address, sender.port) + " has stopped the game: robots stand until " +
              sender_text(followed_->sender.address, followed_->sender.port) +
              ", which is followed, gives a new command",
          print);
}

void RefereeFollower::release_hold(const RefereeMessage& content) {
  if (!hold_ || !may_play_in(content.state.phase)) return;
  // A referee that sends only on changes never repeats an old command.
  if (!content.order || steps(hold_->counter, content.order->counter) > 0) hold_.reset();
}

void RefereeFollower::explain(const Sender& sender, const char* kind, const std::string& text, const Print& print) {
  if (explained_.add(sender.address, kind) != ExplainedKinds::Answer::kCount) print("network: " + name_ + ": " + text);
}

RefereeState RefereeFollower::present() const {
  RefereeState state = followed_->state;
  if (!hold_ || permission_in(state) <= permission_in(hold_->phase, hold_->lines_up)) return state;
  state.phase = hold_->phase;
  state.lines_up = hold_->lines_up;
  state.restart = Restart::kNone;
  state.restart_is_ours = false;
  return state;
}

void RefereeFollower::release() {
  if (followed_ && !followed_->state.repeats) followed_.reset();
}

}  // namespace touchline::network
