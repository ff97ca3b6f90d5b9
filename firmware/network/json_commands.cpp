#include "firmware/network/json_commands.h"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <exception>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "core/geometry/angle.h"

namespace touchline::network {
namespace {

using Kind = ExternalCommand::Kind;

// Bytes of a sender's text that a message shows; the rest is cut off.
constexpr std::size_t kShownBytes = 40;
// Id of nlohmann's json.exception.out_of_range.406.
constexpr int kNumberOutOfRange = 406;

enum Key : std::uint8_t { kId, kV, kW, kLeft, kRight, kX, kY, kTheta, kReleaseKey, kKeys };

struct KeyRule {
  std::string_view name;
  double low, high;
};
constexpr std::array<KeyRule, kKeys> kRules{{{"id", 0.0, std::numeric_limits<RobotId>::max()},
                                             {"v", -kMaxJsonSpeed_mps, kMaxJsonSpeed_mps},
                                             {"w", -kMaxJsonTurn_radps, kMaxJsonTurn_radps},
                                             {"left", -kMaxJsonSpeed_mps, kMaxJsonSpeed_mps},
                                             {"right", -kMaxJsonSpeed_mps, kMaxJsonSpeed_mps},
                                             {"x", -kMaxJsonPosition_m, kMaxJsonPosition_m},
                                             {"y", -kMaxJsonPosition_m, kMaxJsonPosition_m},
                                             // A heading may have made some turns.
                                             {"theta", -1000.0, 1000.0},
                                             {"release", 0.0, 1.0}}};

struct KindRule {
  Kind kind;
  std::uint32_t required, optional;  // bits of Key
};
constexpr std::uint32_t bit(Key key) { return 1u << key; }
constexpr std::array<KindRule, 4> kKinds{{{Kind::kTwist, bit(kV) | bit(kW), 0},
                                          {Kind::kWheels, bit(kLeft) | bit(kRight), 0},
                                          {Kind::kPose, bit(kX) | bit(kY), bit(kTheta)},
                                          {Kind::kRelease, bit(kReleaseKey), 0}}};

/// Receives the parser's events. After the first error, every event returns false, which ends the parser.
class Reader : public nlohmann::json_sax<nlohmann::json> {
 public:
  Result<CommandBatch> result() && {
    if (error_) return *std::move(error_);
    return batch_;
  }

  bool null() override { return wrong_type("null"); }
  bool boolean(bool value) override {
    if (level_ != Level::kCommand || key_ != kReleaseKey) return wrong_type("true or false");
    if (!value) return fail(ErrorCode::kOutOfRange, "%s must be true", place().c_str());
    return set(1.0);
  }
  bool number_integer(number_integer_t value) override { return number(static_cast<double>(value)); }
  bool number_unsigned(number_unsigned_t value) override { return number(static_cast<double>(value)); }
  bool number_float(number_float_t value, const string_t& /*text*/) override {
    if (level_ == Level::kCommand && key_ == kId) {
      return fail(ErrorCode::kOutOfRange, "%s must be a whole number", place().c_str());
    }
    return number(value);
  }
  bool string(string_t& /*value*/) override { return wrong_type("a text"); }
  bool binary(binary_t& /*value*/) override { return wrong_type("binary data"); }

  bool start_object(std::size_t /*size*/) override {
    switch (level_) {
      case Level::kStart:
        level_ = Level::kTop;
        return true;
      case Level::kList:
        level_ = Level::kCommand;
        seen_ = 0;
        return true;
      default:
        return wrong_type("an object");
    }
  }
  bool key(string_t& name) override {
    if (level_ == Level::kTop) {
      if (name != "commands") {
        return fail(ErrorCode::kInconsistent, "unknown key \"%s\"; expected \"commands\"", shown(name).c_str());
      }
      if (has_list_) return fail(ErrorCode::kInconsistent, "\"commands\" is repeated");
      has_list_ = true;
      return true;
    }
    const auto rule = std::find_if(kRules.begin(), kRules.end(), [&](const KeyRule& r) { return r.name == name; });
    if (rule == kRules.end()) {
      return fail(ErrorCode::kInconsistent,
                  "commands[%zu]: unknown key \"%s\"; known are id, v, w, left, right, x, y, theta, release", index_,
                  shown(name).c_str());
    }
    key_ = static_cast<Key>(rule - kRules.begin());
    if ((seen_ & bit(key_)) != 0) return fail(ErrorCode::kInconsistent, "%s is repeated", place().c_str());
    return true;
  }
  bool end_object() override {
    if (level_ == Level::kCommand) {
      level_ = Level::kList;
      return end_command();
    }
    if (!has_list_) return fail(ErrorCode::kInconsistent, "\"commands\" is missing");
    level_ = Level::kEnd;
    return true;
  }
  bool start_array(std::size_t /*size*/) override {
    if (level_ != Level::kTop) return wrong_type("a list");
    level_ = Level::kList;
    return true;
  }
  bool end_array() override {
    level_ = Level::kTop;
    return true;
  }
  bool parse_error(std::size_t position, const std::string& /*token*/,
                   const nlohmann::detail::exception& error) override {
    if (error.id == kNumberOutOfRange) {
      return fail(ErrorCode::kOutOfRange, "the number at byte %zu is too large", position);
    }
    return fail(ErrorCode::kCorruptFrame, "not valid JSON at byte %zu", position);
  }

 private:
  enum class Level : std::uint8_t { kStart, kTop, kList, kCommand, kEnd };

  // Records an error and returns false. The arguments after the code are as for printf.
  bool fail(ErrorCode code, const char* format, ...) __attribute__((format(printf, 3, 4))) {
    std::va_list arguments;
    va_start(arguments, format);
    error_ = Error{code, {}};
    error_->text.append_format_list(format, arguments);
    va_end(arguments);
    return false;
  }

  bool wrong_type(const char* found) {
    const char* expected = "";
    std::string where;
    switch (level_) {
      case Level::kStart:
      case Level::kEnd:
        return fail(ErrorCode::kInconsistent, "expected an object with \"commands\", found %s", found);
      case Level::kTop:
        where = "commands", expected = "a list";
        break;
      case Level::kList:
        where = "commands[" + std::to_string(index_) + "]", expected = "an object";
        break;
      case Level::kCommand:
        where = place(), expected = key_ == kReleaseKey ? "true" : "a number";
        break;
    }
    return fail(ErrorCode::kInconsistent, "%s must be %s, not %s", where.c_str(), expected, found);
  }

  bool number(double value) {
    if (level_ != Level::kCommand || key_ == kReleaseKey) return wrong_type("a number");
    const KeyRule& rule = kRules[key_];
    if (!(value >= rule.low && value <= rule.high)) {
      return fail(ErrorCode::kOutOfRange, "%s = %g is not within %g to %g", place().c_str(), value, rule.low,
                  rule.high);
    }
    return set(value);
  }

  bool set(double value) {
    seen_ |= bit(key_);
    values_[key_] = value;
    return true;
  }

  bool end_command() {
    if ((seen_ & bit(kId)) == 0) return fail(ErrorCode::kInconsistent, "commands[%zu]: \"id\" is missing", index_);
    const std::uint32_t given = seen_ & ~bit(kId);
    const auto rule = std::find_if(kKinds.begin(), kKinds.end(), [&](const KindRule& r) {
      return (given & r.required) == r.required && (given & ~(r.required | r.optional)) == 0;
    });
    if (rule == kKinds.end()) {
      return fail(ErrorCode::kInconsistent,
                  "commands[%zu]: needs either v and w, or left and right, or x and y (and theta), or release", index_);
    }
    const auto value = [&](Key key) { return static_cast<float>(values_[key]); };
    ExternalCommand command;
    command.id = static_cast<RobotId>(values_[kId]);
    command.kind = rule->kind;
    if (rule->kind == Kind::kTwist) command.twist = {value(kV), value(kW)};
    if (rule->kind == Kind::kWheels) command.wheels = {value(kLeft), value(kRight)};
    if (rule->kind == Kind::kPose) {
      command.has_heading = (given & bit(kTheta)) != 0;
      command.target = {{value(kX), value(kY)}, 0.0f};
      if (command.has_heading) command.target.theta_rad = wrap_to_float(values_[kTheta]);
    }
    for (const ExternalCommand& former : batch_.commands) {
      if (former.id == command.id) {
        return fail(ErrorCode::kInconsistent, "commands[%zu]: id %d is repeated", index_, int{command.id});
      }
    }
    if (!batch_.put(command)) {
      return fail(ErrorCode::kOutOfRange, "commands for more than %zu robots", kMaxRobotsPerTeam);
    }
    ++index_;
    return true;
  }

  [[nodiscard]] std::string place() const {
    return "commands[" + std::to_string(index_) + "]." + std::string(kRules[key_].name);
  }
  static std::string shown(const std::string& text) {
    std::string out = text.substr(0, kShownBytes);
    for (char& c : out) {
      if (c < ' ' || c > '~') c = '?';
    }
    return out;
  }

  Level level_ = Level::kStart;
  bool has_list_ = false;
  std::size_t index_ = 0;  // index of the command
  Key key_ = kId;
  std::uint32_t seen_ = 0;  // bits of Key
  std::array<double, kKeys> values_{};
  CommandBatch batch_;
  std::optional<Error> error_;
};

}  // namespace

Result<CommandBatch> decode_json_commands(std::span<const std::byte> bytes) {
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  Reader reader;
  try {
    nlohmann::json::sax_parse(text, text + bytes.size(), &reader);
  } catch (const std::exception& exception) {
    return failure(ErrorCode::kCorruptFrame, "it cannot be parsed: %s", exception.what());
  }
  return std::move(reader).result();
}

}  // namespace touchline::network
