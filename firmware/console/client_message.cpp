#include "firmware/console/client_message.h"

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>

#include "firmware/network/arena_message.h"

namespace touchline::console {
namespace {

using Json = nlohmann::json;
using MessageKind = ClientMessage::Kind;

struct MessageWord {
  std::string_view word;
  MessageKind kind;
};
constexpr std::array<MessageWord, 16> kMessageWords{{{"watch", MessageKind::kWatch},
                                                     {"seen", MessageKind::kSeen},
                                                     {"stop", MessageKind::kStop},
                                                     {"start", MessageKind::kStart},
                                                     {"take", MessageKind::kTake},
                                                     {"release", MessageKind::kRelease},
                                                     {"drive", MessageKind::kDrive},
                                                     {"ping", MessageKind::kPing},
                                                     {"adaptation", MessageKind::kAdaptation},
                                                     {"setup", MessageKind::kSetup},
                                                     {"use_saved", MessageKind::kUseSaved},
                                                     {"probe", MessageKind::kProbe},
                                                     {"score", MessageKind::kScore},
                                                     {"move", MessageKind::kMove},
                                                     {"arena", MessageKind::kArena},
                                                     {"recording", MessageKind::kRecording}}};
// Largest number of goals of a team in a game.
constexpr std::int64_t kMaxGoals = 999;

// Reads members of an object and keeps the first error. Unknown members are ignored, because a newer page may send
// more.
class MemberReader {
 public:
  explicit MemberReader(const Json& object) : object_(object) {}

  double number(const char* name, double low, double high) {
    const Json* const value = find(name);
    if (value == nullptr) return low;
    if (!value->is_number()) return fail(failure(ErrorCode::kInconsistent, "\"%s\" must be a number", name)), low;
    const double number = value->get<double>();
    if (!(number >= low && number <= high)) {
      return fail(failure(ErrorCode::kOutOfRange, "\"%s\" is not within %g to %g", name, low, high)), low;
    }
    return number;
  }
  std::int64_t integer(const char* name, std::int64_t low, std::int64_t high) {
    const Json* const value = find(name);
    if (value == nullptr) return low;
    if (!value->is_number_integer())
      return fail(failure(ErrorCode::kInconsistent, "\"%s\" must be an integer", name)), low;
    const bool too_large = value->is_number_unsigned() &&
                           value->get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int64_t>::max()};
    if (too_large || value->get<std::int64_t>() < low || value->get<std::int64_t>() > high) {
      return fail(failure(ErrorCode::kOutOfRange, "\"%s\" is out of range", name)), low;
    }
    return value->get<std::int64_t>();
  }
  std::string text(const char* name) {
    const Json* const value = find(name);
    if (value == nullptr) return {};
    if (!value->is_string())
      return fail(failure(ErrorCode::kInconsistent, "\"%s\" must be a text", name)), std::string();
    return value->get<std::string>();
  }
  bool flag(const char* name) {
    const Json* const value = find(name);
    if (value == nullptr) return false;
    if (!value->is_boolean()) fail(failure(ErrorCode::kInconsistent, "\"%s\" must be true or false", name));
    return value->is_boolean() && value->get<bool>();
  }
  [[nodiscard]] bool has(const char* name) const { return object_.contains(name) && !object_.at(name).is_null(); }

  void fail(Error error) {
    if (!error_) error_ = std::move(error);
  }
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

 private:
  const Json* find(const char* name) {
    const auto found = object_.find(name);
    if (found != object_.end()) return &*found;
    fail(failure(ErrorCode::kInconsistent, "\"%s\" is missing", name));
    return nullptr;
  }

  const Json& object_;
  std::optional<Error> error_;
};

void read_findings(MemberReader& reader, const Json& names, WatchedFindings& out) {
  if (!names.is_array()) return reader.fail(failure(ErrorCode::kInconsistent, "\"findings\" must be a list"));
  for (const Json& name : names) {
    if (name == "classes") {
      out.classes = true;
    } else if (name == "regions") {
      out.regions = true;
    } else if (name == "light") {
      out.light = true;
    } else {
      reader.fail(failure(ErrorCode::kOutOfRange, "\"findings\" are \"classes\", \"regions\" and \"light\""));
    }
  }
}

void read_watch(MemberReader& reader, const Json& object, ClientMessage& out) {
  out.state_hz = reader.number("state_hz", 0.0, kMaxStateRateHz);
  if (reader.has("findings")) read_findings(reader, object.at("findings"), out.findings);
  out.watches_setup = reader.has("setup") && reader.flag("setup");
  if (!reader.has("picture")) return;
  const Json& picture = object.at("picture");
  if (!picture.is_object())
    return reader.fail(failure(ErrorCode::kInconsistent, "\"picture\" must be an object or null"));
  MemberReader inner(picture);
  out.picture_hz = inner.number("rate_hz", 0.0, kMaxPictureRateHz);
  if (inner.has("max_width_px")) {
    out.picture_width_px = static_cast<std::uint16_t>(inner.integer("max_width_px", 16, kMaxFrameWidth));
  }
  if (inner.error()) reader.fail(prefixed("picture", *inner.error()));
}

void read_drive(MemberReader& reader, ClientMessage& out) {
  if (reader.has("team") && reader.text("team") != "own") {
    reader.fail(failure(ErrorCode::kOutOfRange, "only robots of the own team can be driven"));
  }
  out.id = static_cast<RobotId>(reader.integer("id", 0, std::numeric_limits<RobotId>::max()));
  out.gives_back = reader.has("give_back") && reader.flag("give_back");
  if (out.gives_back) return;
  out.twist.v_mps = static_cast<float>(reader.number("speed_mps", -kMaxDriveSpeed_mps, kMaxDriveSpeed_mps));
  out.twist.w_radps = static_cast<float>(reader.number("turn_radps", -kMaxDriveTurn_radps, kMaxDriveTurn_radps));
}

void read_adaptation(MemberReader& reader, ClientMessage& out) {
  const std::string action = reader.text("action");
  if (action == "freeze") {
    out.adaptation = AdaptationMode::kFrozen;
  } else if (action == "reset") {
    out.adaptation = AdaptationMode::kOff;
  } else if (action != "follow") {
    reader.fail(failure(ErrorCode::kOutOfRange, "\"action\" must be \"freeze\", \"follow\" or \"reset\""));
  }
}

void read_start(MemberReader& reader, ClientMessage& out) {
  // Without it, the hub rejects the start; its answer has the request's number, which older pages need to show it.
  if (!reader.has("stop_number")) return;
  constexpr std::int64_t kLargest = std::numeric_limits<std::uint32_t>::max();
  out.stop_number = static_cast<std::uint32_t>(reader.integer("stop_number", 0, kLargest));
}

void read_probe(MemberReader& reader, ClientMessage& out) {
  if (!out.request) reader.fail(failure(ErrorCode::kInconsistent, "\"request\" is missing"));
  out.pixel.u_px = static_cast<float>(reader.number("u_px", 0.0, double{kMaxFrameWidth}));
  out.pixel.v_px = static_cast<float>(reader.number("v_px", 0.0, double{kMaxFrameHeight}));
}

void read_move(MemberReader& reader, ClientMessage& out) {
  const auto pixel = [&reader](const char* u, const char* v) -> PixelPoint {
    return {static_cast<float>(reader.number(u, 0.0, double{kMaxFrameWidth})),
            static_cast<float>(reader.number(v, 0.0, double{kMaxFrameHeight}))};
  };
  const PixelPoint from = pixel("u_px", "v_px");
  out.arena = network::move_request(from, pixel("to_u_px", "to_v_px"));
}

void read_arena(MemberReader& reader, const Json& object, ClientMessage& out) {
  if (!reader.has("do")) return reader.fail(failure(ErrorCode::kInconsistent, "\"do\" is missing"));
  std::optional<Error> error;
  network::JsonMembers request(object.at("do"), "do", error);
  out.arena = network::read_arena_request(request);
  if (error) reader.fail(*std::move(error));
}

void read_recording(MemberReader& reader, ClientMessage& out) {
  using Wish = ClientMessage::RecordingWish;
  const std::string action = reader.text("action");
  if (action == "stop") {
    out.recording = Wish::kStop;
  } else if (action == "delete") {
    out.recording = Wish::kDelete;
    out.name = reader.text("name");
    if (!out.request) reader.fail(failure(ErrorCode::kInconsistent, "\"request\" is missing"));
  } else if (action != "start") {
    reader.fail(failure(ErrorCode::kOutOfRange, "\"action\" must be \"start\", \"stop\" or \"delete\""));
  }
}

void read_score(MemberReader& reader, ClientMessage& out) {
  if (!reader.has("own") && !reader.has("opponent")) return;
  out.score = Score{static_cast<std::uint32_t>(reader.integer("own", 0, kMaxGoals)),
                    static_cast<std::uint32_t>(reader.integer("opponent", 0, kMaxGoals))};
}

}  // namespace

Result<ClientMessage> parse_client_message(std::string_view text) {
  bool is_too_deep = false;
  const auto check_depth = [&](int depth, Json::parse_event_t /*event*/, const Json& /*value*/) {
    is_too_deep = is_too_deep || depth > kMaxMessageDepth;
    return !is_too_deep;
  };
  const Json object = Json::parse(text.begin(), text.end(), check_depth, false);
  if (is_too_deep) return failure(ErrorCode::kOutOfRange, "the message is nested too deeply");
  if (!object.is_object()) return failure(ErrorCode::kCorruptFrame, "the message is not a JSON object");
  MemberReader reader(object);
  ClientMessage out;
  if (reader.has("request")) out.request = reader.integer("request", 0, std::int64_t{1} << 53);
  const std::string word = reader.text("type");
  const auto* const found = std::find_if(kMessageWords.begin(), kMessageWords.end(),
                                         [&](const MessageWord& known) { return known.word == word; });
  if (found == kMessageWords.end()) reader.fail(failure(ErrorCode::kInconsistent, "\"type\" is unknown"));
  if (reader.error()) return *reader.error();
  out.kind = found->kind;
  if (out.kind == MessageKind::kWatch) read_watch(reader, object, out);
  if (out.kind == MessageKind::kSeen) {
    out.number = static_cast<std::uint64_t>(reader.integer("number", 0, std::int64_t{1} << 53));
  }
  if (out.kind == MessageKind::kStart) read_start(reader, out);
  if (out.kind == MessageKind::kDrive) read_drive(reader, out);
  if (out.kind == MessageKind::kAdaptation) read_adaptation(reader, out);
  if (out.kind == MessageKind::kProbe) read_probe(reader, out);
  if (out.kind == MessageKind::kScore) read_score(reader, out);
  if (out.kind == MessageKind::kMove) read_move(reader, out);
  if (out.kind == MessageKind::kArena) read_arena(reader, object, out);
  if (out.kind == MessageKind::kRecording) read_recording(reader, out);
  if (reader.error()) return *reader.error();
  return out;
}

}  // namespace touchline::console
