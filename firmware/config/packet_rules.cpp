#include "firmware/config/packet_rules.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "core/radio/field_type.h"
#include "firmware/config/wording.h"

namespace touchline::config {
namespace {

bool is_speed(FieldValue value) {
  return value == FieldValue::kLeft || value == FieldValue::kRight || value == FieldValue::kForward ||
         value == FieldValue::kTurn;
}

std::string word(FieldValue value) { return "\"" + std::string(config::word_of(value, kFieldValues)) + "\""; }

std::string plain_number(double number) {
  const bool is_whole = std::abs(number) < 1e15 && number == std::round(number);
  return is_whole ? number_text(std::llround(number)) : number_text(number);
}

/// Number of codes of a field; 0: it has none.
std::size_t code_count(FieldValue value) {
  switch (value) {
    case FieldValue::kDirections:
      return 4;
    case FieldValue::kLeftDirection:
    case FieldValue::kRightDirection:
    case FieldValue::kForwardDirection:
    case FieldValue::kTurnDirection:
    case FieldValue::kStop:
    case FieldValue::kColor:
      return 2;
    default:
      return 0;
  }
}

/// Rounding error of numbers that are sent.
double half_step(const PacketField& field) {
  if (is_float(field.type)) return 0.0;
  return 0.5 / (field.type == FieldType::kDigits ? static_cast<double>(power_of_ten(field.decimals)) : 1.0);
}

class PacketRules {
 public:
  PacketRules(const PacketLayout& layout, std::string list, const Locations& where, ErrorList& errors)
      : layout_(layout), list_(std::move(list)), where_(where), errors_(errors) {}

  void check_field(std::size_t index) {
    const PacketField& field = layout_.fields[index];
    const std::string key = element(list_, index);
    if (field.type == FieldType::kDigits && field.width > 0 && field.width < needed_width(field)) {
      return add(key + ".width",
                 "has no room for a digit, the point and " + std::to_string(field.decimals) + " decimals");
    }
    if (field.low > field.high) return add(key + ".low", "is larger than high");
    if (field.value == FieldValue::kConstant && field.type != FieldType::kBytes && !is_float(field.type)) {
      need_exact(field, key + ".offset", field.offset, "the constant " + plain_number(field.offset));
    }
    check_codes(field, key);
    if (field.value == FieldValue::kTeam && layout_.team != kNoTeamNumber) {
      need_exact(field, key, layout_.team * field.scale + field.offset,
                 "team_number = " + std::to_string(static_cast<int>(layout_.team)));
    }
    if (field.value == FieldValue::kCheck || field.value == FieldValue::kLength) check_covered(index, key);
  }

  void check_speed(std::size_t index) {
    const PacketField& field = layout_.fields[index];
    const std::string key = element(list_, index);
    const double zero = sent_number(field, field.offset), low = lowest(field), high = highest(field);
    if (!(std::abs(zero - field.offset) <= half_step(field) + 1e-6 * std::abs(field.offset))) {
      return add(key, "cannot be sent as speed 0, which is the number " + plain_number(field.offset) +
                          ", so nothing stops the robots: the type and limits leave " + sendable(field));
    }
    const bool rises = field.scale > 0.0;
    if (!(rises ? zero < high : low < zero)) return add(key, "leaves no number for " + word(field.value) + " above 0");
    if (!field.magnitude && !(rises ? low < zero : zero < high)) {
      return add(key, "leaves no number for " + word(field.value) +
                          " below 0: choose a signed type, or magnitude = true with a field for its direction");
    }
    if (field.magnitude && !has_direction(field.value)) {
      add(key + ".magnitude", "needs a field for the direction of " + word(field.value) +
                                  ": without it, the robots would always drive forward");
    }
  }

  void check_direction(std::size_t index) {
    for (const FieldValue speed : {FieldValue::kLeft, FieldValue::kRight, FieldValue::kForward, FieldValue::kTurn}) {
      if (!carries_direction(layout_.fields[index].value, speed)) continue;
      if (!layout_.has(speed))
        add(element(list_, index), "is the direction of " + word(speed) + ", which no field carries");
      for (std::size_t i = 0; i < layout_.fields.size(); ++i) {
        if (layout_.fields[i].value != speed || layout_.fields[i].magnitude) continue;
        add(element(list_, i), "has a sign and a direction in " + element(list_, index) + ": add magnitude = true");
      }
    }
  }

  void check_id(std::size_t index) {
    const PacketField& field = layout_.fields[index];
    for (std::size_t i = 0; i < layout_.receivers.size(); ++i) {
      const auto id = static_cast<int>(static_cast<std::uint8_t>(layout_.receivers[i].id));  // 0 to 127
      need_exact(field, element("own.robot", i) + ".id", id * field.scale + field.offset,
                 "robot " + std::to_string(id) + " in " + element(list_, index));
    }
  }

  void check_address(std::size_t index, bool has_own_receiver) {
    const PacketField& field = layout_.fields[index];
    if (is_float(field.type) || field.type == FieldType::kDigits || integer_range(field).low < 0) {
      return add(element(list_, index) + ".type", "an address is a number of u8, u16, u32, u48, u64 or bits");
    }
    std::set<std::uint64_t> known;
    for (std::size_t i = 0; i < layout_.receivers.size(); ++i) {
      if (has_own_receiver || known.insert(layout_.receivers[i].address & address_bits(field)).second) continue;
      add(element("own.robot", i) + ".address",
          "ends as that of another robot: " + element(list_, index) + " carries the last bits only");
    }
  }

  void check_counts() {
    const std::size_t robots = layout_.receivers.size();
    const bool has_names = layout_.has(FieldValue::kId) || layout_.has(FieldValue::kAddress);
    if (has_names && layout_.slots > 0 && robots > layout_.slots) {
      add("radio.places", "a packet has " + std::to_string(static_cast<int>(layout_.slots)) +
                              " places, but the team has " + std::to_string(robots) + " robots");
    }
    for (std::size_t i = 0; i < layout_.fields.size(); ++i) {
      const PacketField& field = layout_.fields[i];
      const auto count = static_cast<double>(layout_.one_each ? 1 : std::max<std::size_t>(robots, layout_.slots));
      if (field.value != FieldValue::kCount) continue;
      need_exact(field, element(list_, i), count * field.scale + field.offset, plain_number(count) + " robots");
    }
  }

 private:
  void add(const std::string& key, const std::string& message) { errors_.add(where_.of(key), key, message); }

  static double lowest(const PacketField& field) { return sent_number(field, -1e300); }
  static double highest(const PacketField& field) { return sent_number(field, 1e300); }
  static std::string sendable(const PacketField& field) {
    return plain_number(lowest(field)) + " to " + plain_number(highest(field));
  }

  static unsigned needed_width(const PacketField& field) { return field.decimals > 0 ? field.decimals + 2U : 1U; }

  void need_exact(const PacketField& field, const std::string& key, double number, const std::string& what) {
    if (std::abs(sent_number(field, number) - number) <= 1e-6 * std::abs(number)) return;
    add(key, what + " cannot be sent: the type and limits leave whole numbers from " + sendable(field));
  }

  void check_codes(const PacketField& field, const std::string& key) {
    const std::size_t count = code_count(field.value);
    for (std::size_t i = 0; i < count; ++i) {
      need_exact(field, key + ".codes", field.codes[i], "the code " + std::to_string(field.codes[i]));
      if (std::find(field.codes.begin(), field.codes.begin() + i, field.codes[i]) != field.codes.begin() + i) {
        add(key + ".codes", "the code " + std::to_string(field.codes[i]) + " has two meanings");
      }
    }
  }

  // Whether a length or check can begin or end before this field.
  [[nodiscard]] bool is_boundary(std::size_t index) const {
    const auto& fields = layout_.fields;
    if (index == 0 || index == fields.size()) return true;
    if (fields[index].block != 0 && fields[index].block == fields[index - 1].block) return false;
    if (fields[index].block != 0 || !is_bits(fields[index].type)) return true;
    unsigned bits = 0;
    while (index > 0 && is_bits(fields[index - 1].type) && fields[index - 1].block == 0) bits += fields[--index].bits;
    return bits % 8 == 0 && (index == 0 || !is_bits(fields[index - 1].type));
  }

  void check_covered(std::size_t index, const std::string& key) {
    const PacketField& field = layout_.fields[index];
    if (field.block != 0) {
      return add(key + ".block",
                 "a length or check stands once in a packet; packet_for = \"each\" gives each robot its own");
    }
    if (!is_boundary(field.first) || !is_boundary(field.end)) {
      return add(key, "begins or ends within a block or a byte: a length or check covers whole ones");
    }
    if (field.value != FieldValue::kCheck) return;
    if (field.first >= field.end) {
      return add(key, "covers no field: \"from\" and \"to\" say which ones, without them those before the check");
    }
    for (std::size_t i = std::max<std::size_t>(field.first, index); i < field.end; ++i) {
      if (layout_.fields[i].value != FieldValue::kCheck) continue;
      return add(key,
                 "covers " + (i == index ? std::string("itself") : element(list_, i) + ", which is computed after it"));
    }
  }

  static bool carries_direction(FieldValue direction, FieldValue speed) {
    switch (direction) {
      case FieldValue::kDirections:
        return speed == FieldValue::kLeft || speed == FieldValue::kRight;
      case FieldValue::kLeftDirection:
        return speed == FieldValue::kLeft;
      case FieldValue::kRightDirection:
        return speed == FieldValue::kRight;
      case FieldValue::kForwardDirection:
        return speed == FieldValue::kForward;
      case FieldValue::kTurnDirection:
        return speed == FieldValue::kTurn;
      default:
        return false;
    }
  }

  [[nodiscard]] bool has_direction(FieldValue speed) const {
    return std::any_of(layout_.fields.begin(), layout_.fields.end(),
                       [&](const PacketField& field) { return carries_direction(field.value, speed); });
  }

  const PacketLayout& layout_;
  const std::string list_;
  const Locations& where_;
  ErrorList& errors_;
};

}  // namespace

void check_fields(const PacketLayout& layout, const std::string& list, const Locations& where, ErrorList& errors) {
  PacketRules rules(layout, list, where, errors);
  for (std::size_t i = 0; i < layout.fields.size(); ++i) rules.check_field(i);
}

void check_robots(const PacketLayout& layout, const std::string& list, const Locations& where, ErrorList& errors) {
  PacketRules rules(layout, list, where, errors);
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    const FieldValue value = layout.fields[i].value;
    if (is_speed(value)) rules.check_speed(i);
    if (value == FieldValue::kId) rules.check_id(i);
    if (value == FieldValue::kAddress) rules.check_address(i, layout.one_each);
    rules.check_direction(i);
  }
  rules.check_counts();
}

void check_telemetry(const PacketLayout& layout, const std::string& list, const Locations& where, ErrorList& errors) {
  PacketRules rules(layout, list, where, errors);
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    if (layout.fields[i].value == FieldValue::kId) rules.check_id(i);
    if (layout.fields[i].value == FieldValue::kAddress) rules.check_address(i, false);
  }
}

}  // namespace touchline::config
