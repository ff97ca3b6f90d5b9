#include "firmware/network/arena_message.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "core/geometry/angle.h"
#include "core/types.h"
#include "firmware/network/json_commands.h"

namespace touchline::network {
namespace {

using hal::mock::ArenaFault;
using hal::mock::Placement;

// As for commands: a heading may have made some turns.
constexpr double kMaxHeading_rad = 1000.0;
// A minute at 60 frames per second.
constexpr std::int64_t kMaxRequestFrames = 3600;
// Slower, a person would wait for the next picture; no machine is faster.
constexpr double kMinSpeed = 0.01, kMaxSpeed = 100.0;
// The longest game.
constexpr double kMaxFault_s = 36000.0;

Placement read_position(JsonMembers& members) {
  return {members.number("x", -kMaxJsonPosition_m, kMaxJsonPosition_m),
          members.number("y", -kMaxJsonPosition_m, kMaxJsonPosition_m), 0.0};
}

Vector2 read_velocity(JsonMembers& members) {
  return {members.number_or("vx", -kMaxJsonSpeed_mps, kMaxJsonSpeed_mps, 0.0),
          members.number_or("vy", -kMaxJsonSpeed_mps, kMaxJsonSpeed_mps, 0.0)};
}

std::optional<int> read_id(const std::string& text) {
  int id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  const bool is_id =
      error == std::errc() && end == text.data() + text.size() && id >= 0 && id <= std::numeric_limits<RobotId>::max();
  return is_id ? std::optional(id) : std::nullopt;
}

void read_robots(JsonMembers& teams, ArenaPlaces& out) {
  for (const auto& team : teams.object().items()) {
    // So that messages can name it.
    if (team.key() != shown_name(team.key())) {
      return teams.fail(failure(ErrorCode::kOutOfRange, "%s is not a team", teams.place_of(team.key()).c_str()));
    }
    JsonMembers robots = teams.child(team.key().c_str());
    for (const auto& robot : robots.object().items()) {
      const std::optional<int> id = read_id(robot.key());
      if (!id) {
        return robots.fail(failure(ErrorCode::kOutOfRange, "%s is not the id of a robot",
                                   robots.place_of(shown_json(robot.key())).c_str()));
      }
      JsonMembers members = robots.child(robot.key().c_str());
      members.allow({"x", "y", "theta", "v", "w", "confidence", "seen"});
      PlacedRobot placed{team.key(), *id, read_position(members)};
      placed.at.theta_rad = wrap_angle(members.number_or("theta", -kMaxHeading_rad, kMaxHeading_rad, 0.0));
      out.robots.push_back(std::move(placed));
      // More robots cannot exist, so the rest of the message is not read.
      if (out.robots.size() > kMaxRobots) {
        return robots.fail(failure(ErrorCode::kOutOfRange, "%s: there are more than %zu robots",
                                   teams.place_of(team.key()).c_str(), kMaxRobots));
      }
    }
  }
}

// Reads one of the words of a configuration key.
template <class Enum, std::size_t kCount>
void read_choice(JsonMembers& members, const char* name, const std::array<Choice<Enum>, kCount>& choices, Enum& value) {
  const std::string word = members.text(name);
  const auto found =
      std::find_if(choices.begin(), choices.end(), [&](const Choice<Enum>& choice) { return choice.word == word; });
  if (found != choices.end()) {
    value = found->value;
    return;
  }
  std::string known;
  for (const Choice<Enum>& choice : choices) known += (known.empty() ? "" : ", ") + std::string(choice.word);
  members.fail(failure(ErrorCode::kOutOfRange, "%s = %s is not one of %s", members.place_of(name).c_str(),
                       shown_json(word).c_str(), known.c_str()));
}

}  // namespace

std::uint64_t read_seed(JsonMembers& members) {
  // Seeds that a double holds exactly, because some languages have no other numbers.
  constexpr std::int64_t kMaxSeed = std::int64_t{1} << 53;
  return static_cast<std::uint64_t>(members.integer("seed", 0, kMaxSeed));
}

ArenaPlaces read_places(JsonMembers& places) {
  ArenaPlaces out;
  places.allow({"ball", "robots"});
  if (places.has("ball")) {
    JsonMembers ball = places.child("ball");
    ball.allow({"x", "y", "vx", "vy", "confidence"});
    out.ball = PlacedBall{read_position(ball), read_velocity(ball)};
  }
  if (places.has("robots")) {
    JsonMembers robots = places.child("robots");
    read_robots(robots, out);
  }
  return out;
}

PlacedBall read_throw(JsonMembers& members) {
  members.allow({"x", "y", "vx", "vy"});
  PlacedBall ball;
  if (members.has("x") || members.has("y")) ball.at = read_position(members);
  ball.velocity_mps = read_velocity(members);
  return ball;
}

ArenaFault read_fault(JsonMembers& members) {
  members.allow({"kind", "at_s", "for_s", "team", "id"});
  ArenaFault fault;
  read_choice(members, "kind", hal::mock::kFaultKinds, fault.kind);
  if (members.has("team")) read_choice(members, "team", hal::mock::kSides, fault.team);
  if (members.has("id")) fault.id = static_cast<int>(members.integer("id", 0, std::numeric_limits<RobotId>::max()));
  fault.at_s = members.number_or("at_s", 0.0, kMaxFault_s, 0.0);
  fault.for_s = members.number_or("for_s", 0.0, kMaxFault_s, 1.0);
  return fault;
}

ArenaRequest read_arena_request(JsonMembers& members) {
  using Kind = ArenaRequest::Kind;
  members.allow({"reset", "place", "throw", "move", "pause", "resume", "step", "speed", "fault"});
  ArenaRequest out;
  if (members.object().size() != 1) {
    members.fail(
        failure(ErrorCode::kInconsistent, "a request to the arena has one member, not %zu", members.object().size()));
    return out;
  }
  out.text = members.object().dump();
  const std::string word = members.object().begin().key();
  JsonMembers request = members.child(word.c_str());
  if (word == "reset") {
    out.kind = Kind::kReset;
    request.allow({"seed"});
    if (request.has("seed")) out.seed = read_seed(request);
  } else if (word == "place") {
    out.kind = Kind::kPlace;
    out.places = read_places(request);
  } else if (word == "throw") {
    out.kind = Kind::kPlace;
    out.places.ball = read_throw(request);
  } else if (word == "move") {
    out.kind = Kind::kMove;
    request.allow({"u_px", "v_px", "to_u_px", "to_v_px"});
    const auto pixel = [&request](const char* u, const char* v) -> PixelPoint {
      return {static_cast<float>(request.number(u, 0.0, double{kMaxFrameWidth})),
              static_cast<float>(request.number(v, 0.0, double{kMaxFrameHeight}))};
    };
    out.from = pixel("u_px", "v_px");
    out.to = pixel("to_u_px", "to_v_px");
  } else if (word == "step") {
    out.kind = Kind::kStep;
    request.allow({"frames"});
    if (request.has("frames")) out.frames = static_cast<int>(request.integer("frames", 1, kMaxRequestFrames));
  } else if (word == "speed") {
    out.kind = Kind::kSpeed;
    request.allow({"factor"});
    out.speed = request.number("factor", kMinSpeed, kMaxSpeed);
  } else if (word == "fault") {
    out.kind = Kind::kFault;
    out.fault = read_fault(request);
  } else {
    out.kind = word == "pause" ? Kind::kPause : Kind::kResume;
    request.allow({});
  }
  return out;
}

ArenaRequest move_request(PixelPoint from, PixelPoint to) {
  ArenaRequest out;
  out.kind = ArenaRequest::Kind::kMove;
  out.from = from;
  out.to = to;
  const nlohmann::json where{{"u_px", from.u_px}, {"v_px", from.v_px}, {"to_u_px", to.u_px}, {"to_v_px", to.v_px}};
  out.text = nlohmann::json{{"move", where}}.dump();
  return out;
}

Result<ArenaRequest> decode_arena_request(std::string_view text) {
  TOUCHLINE_TRY_ASSIGN(const nlohmann::json object, parse_json_object(text));
  std::optional<Error> error;
  JsonMembers whole(object, "", error);
  ArenaRequest request = read_arena_request(whole);
  if (error) return *std::move(error);
  return request;
}

bool is_arena_request(std::string_view text) {
  const std::size_t begin = text.find('"');
  if (begin == std::string_view::npos) return false;
  const std::string_view name = text.substr(begin + 1, text.find('"', begin + 1) - begin - 1);
  constexpr std::array<std::string_view, 9> kWords{"reset",  "place", "throw", "move", "pause",
                                                   "resume", "step",  "speed", "fault"};
  return std::find(kWords.begin(), kWords.end(), name) != kWords.end();
}

}  // namespace touchline::network
