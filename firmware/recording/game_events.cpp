#include "firmware/recording/game_events.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "firmware/console/messages.h"

namespace touchline::recording {
namespace {

GameEvent event_of(GameEvent::Kind kind) {
  GameEvent event;
  event.kind = kind;
  return event;
}

std::string_view word_of(GameEvent::Kind kind) {
  constexpr std::array<std::string_view, 6> kWords{"score", "goal", "stop", "start", "robot_lost", "slowest"};
  return kWords[static_cast<std::size_t>(kind)];
}

}  // namespace

FrameEvents GameEvents::add(const Snapshot& snapshot) {
  FrameEvents events;
  add_score(snapshot, events);
  add_halt(snapshot.halt, events);
  add_lost(snapshot.tracks, events);
  // The first frame is slow for reasons of its own.
  const bool is_first = slowest_ == Duration::zero();
  if (snapshot.latency > slowest_ && !is_first) {
    GameEvent event = event_of(GameEvent::Kind::kSlowest);
    event.latency = snapshot.latency;
    events.push_back(event);
  }
  slowest_ = is_first ? Duration(1) : std::max(slowest_, snapshot.latency);
  return events;
}

FrameEvents GameEvents::add_stop(std::uint32_t halt) {
  FrameEvents events;
  add_halt(halt, events);
  return events;
}

void GameEvents::add_score(const Snapshot& snapshot, FrameEvents& out) {
  const bool by_referee = snapshot.referee.score.has_value();
  const std::optional<Team> scored =
      rule_.add(snapshot.tracks.ball, snapshot.referee.own_on_positive_half.value_or(false));
  if (scored && !by_referee) ++(*scored == Team::kOwn ? counted_.own : counted_.opponent);
  // Without a referee there is no score before the first goal.
  if (!by_referee && !scored) return;
  if (by_referee) counted_ = *snapshot.referee.score;
  const Score now = counted_;
  const std::optional<Score> before = std::exchange(score_, now);
  if (before == now) return;
  const Score from = before.value_or(by_referee ? now : Score{});
  const bool own = now.own == from.own + 1 && now.opponent == from.opponent;
  const bool opponent = now.opponent == from.opponent + 1 && now.own == from.own;
  GameEvent event = event_of(own || opponent ? GameEvent::Kind::kGoal : GameEvent::Kind::kScore);
  event.team = opponent ? Team::kOpponent : Team::kOwn;
  event.by_referee = by_referee;
  event.score = now;
  out.push_back(event);
}

void GameEvents::add_halt(std::uint32_t halt, FrameEvents& out) {
  const std::optional<std::uint32_t> before = std::exchange(halt_, halt);
  if (!before || (*before != 0) == (halt != 0)) return;
  GameEvent event = event_of(halt != 0 ? GameEvent::Kind::kStop : GameEvent::Kind::kStart);
  event.halt = halt;
  out.push_back(event);
}

void GameEvents::add_lost(const Tracks& tracks, FrameEvents& out) {
  auto before = std::exchange(tracked_, {});
  for (const RobotTrack& robot : tracks.robots) {
    if (robot.team != Team::kOwn || robot.id == kUnknownId) continue;
    tracked_.set(static_cast<std::size_t>(robot.id));
    before.reset(static_cast<std::size_t>(robot.id));
  }
  for (std::size_t id = 0; before.any() && !out.full(); ++id) {
    if (!before.test(id)) continue;
    before.reset(id);
    GameEvent event = event_of(GameEvent::Kind::kRobotLost);
    event.id = static_cast<RobotId>(id);
    out.push_back(event);
  }
}

void write_event(report::JsonWriter& json, const GameEvent& event) {
  using Kind = GameEvent::Kind;
  json.begin_object();
  json.key("kind");
  json.string(word_of(event.kind));
  if (event.kind == Kind::kGoal) {
    json.key("team");
    json.string(event.team == Team::kOwn ? "own" : "opponent");
  }
  if (event.kind == Kind::kGoal || event.kind == Kind::kScore) {
    json.key("by");
    json.string(event.by_referee ? "referee" : "rule");
    json.key("own");
    json.integer(event.score.own);
    json.key("opponent");
    json.integer(event.score.opponent);
  }
  if (event.kind == Kind::kStop) console::write_halt(json, event.halt);
  if (event.kind == Kind::kRobotLost) {
    json.key("id");
    json.integer(event.id);
  }
  if (event.kind == Kind::kSlowest) {
    json.key("latency_ms");
    json.number(report::rounded(seconds(event.latency) * 1e3, 1e-3));
  }
  json.end_object();
}

}  // namespace touchline::recording
