#include "tools/programs/simulate/lockstep_message.h"

#include <optional>
#include <utility>

#include "firmware/network/arena_message.h"
#include "firmware/network/json_commands.h"

namespace touchline::simulate {
namespace {

using network::JsonMembers;

std::string value_of_setting(const nlohmann::json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

ResetMessage read_reset(JsonMembers& members) {
  members.allow({"seed", "own", "opponent", "robots", "robots_return", "settings", "place", "faults"});
  ResetMessage out;
  if (members.has("seed")) out.seed = network::read_seed(members);
  out.own = members.text_or("own", out.own);
  out.opponent = members.text_or("opponent", out.opponent);
  if (members.has("robots")) {
    out.robots = static_cast<int>(members.integer("robots", 1, std::int64_t{kMaxRobotsPerTeam}));
  }
  out.robots_return = members.flag_or("robots_return", out.robots_return);
  if (members.has("settings")) {
    for (const auto& setting : members.child("settings").object().items()) {
      if (setting.value().is_structured() || setting.value().is_null()) {
        members.fail(failure(ErrorCode::kInconsistent, "settings.%s = %s is not a number, a text, true or false",
                             network::shown_name(setting.key()).c_str(), network::shown_json(setting.value()).c_str()));
      }
      out.settings.push_back(setting.key() + "=" + value_of_setting(setting.value()));
    }
  }
  if (members.has("place")) {
    JsonMembers places = members.child("place");
    out.places = network::read_places(places);
  }
  if (members.has("faults")) {
    for (JsonMembers& fault : members.children("faults")) out.faults.push_back(network::read_fault(fault));
  }
  return out;
}

// The list is decoded as that of the network's commands, so that both have the same members, limits and errors.
ExternalCommands read_commands(JsonMembers& members, const char* name) {
  if (!members.has(name)) return {};
  const std::string list =
      "{\"commands\":" + members.object().at(name).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + "}";
  const Result<network::CommandBatch> batch = network::decode_json_commands(std::as_bytes(std::span(list)));
  if (batch.ok()) return batch.value().commands;
  members.fail(prefixed(members.place_of(name), batch.error()));
  return {};
}

StepMessage read_step(JsonMembers& members) {
  members.allow({"frames", "commands", "opponent_commands", "only_last", "truth", "sightings"});
  StepMessage out;
  if (members.has("frames")) out.frames = static_cast<int>(members.integer("frames", 1, kMaxStepFrames));
  out.commands = read_commands(members, "commands");
  out.opponent_commands = read_commands(members, "opponent_commands");
  out.only_last = members.flag_or("only_last", false);
  out.truth = members.flag_or("truth", false);
  out.sightings = members.flag_or("sightings", false);
  return out;
}

LockstepMessage read_message(JsonMembers& whole) {
  whole.allow({"reset", "step", "place", "throw", "fault", "hash"});
  if (whole.object().size() != 1) {
    whole.fail(failure(ErrorCode::kInconsistent, "a message has one member, not %zu", whole.object().size()));
    return HashMessage{};
  }
  const std::string word = whole.object().begin().key();
  JsonMembers members = whole.child(word.c_str());
  if (word == "reset") return read_reset(members);
  if (word == "step") return read_step(members);
  if (word == "place") return PlaceMessage{network::read_places(members)};
  if (word == "throw") return PlaceMessage{{{}, network::read_throw(members)}};
  if (word == "fault") return FaultMessage{network::read_fault(members)};
  members.allow({});
  return HashMessage{};
}

}  // namespace

Result<LockstepMessage> parse_lockstep_message(std::string_view text) {
  TOUCHLINE_TRY_ASSIGN(const nlohmann::json object, network::parse_json_object(text));
  std::optional<Error> error;
  JsonMembers whole(object, "", error);
  LockstepMessage message = read_message(whole);
  if (error) return *std::move(error);
  return message;
}

}  // namespace touchline::simulate
