#include "firmware/config/resolve_radio.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/radio/field_type.h"
#include "firmware/config/error_list.h"
#include "firmware/config/packet_rules.h"
#include "firmware/config/radio_presets.h"
#include "firmware/config/wording.h"

namespace touchline::config {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi, kDegreesPerRadian = 180.0 / std::numbers::pi;
// Limits of digits that have none: no robot of a league is faster.
constexpr double kFastest_mps = 10.0, kFastest_radps = 100.0;
constexpr double kLargestDigits = 999999999.0;  // below the number that means no limit

enum class Quantity : std::uint8_t { kOther, kWheel, kForward, kTurnRate, kBattery, kLink };

Quantity quantity_of(FieldValue value) {
  switch (value) {
    case FieldValue::kLeft:
    case FieldValue::kRight:
      return Quantity::kWheel;
    case FieldValue::kForward:
      return Quantity::kForward;
    case FieldValue::kTurn:
      return Quantity::kTurnRate;
    case FieldValue::kBattery:
      return Quantity::kBattery;
    case FieldValue::kLink:
      return Quantity::kLink;
    default:
      return Quantity::kOther;
  }
}

bool is_direction(FieldValue value) {
  return value == FieldValue::kLeftDirection || value == FieldValue::kRightDirection ||
         value == FieldValue::kForwardDirection || value == FieldValue::kTurnDirection;
}

std::optional<unsigned> hex_digit(char c) {
  if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0');
  if (c >= 'a' && c <= 'f') return static_cast<unsigned>(c - 'a' + 10);
  if (c >= 'A' && c <= 'F') return static_cast<unsigned>(c - 'A' + 10);
  return std::nullopt;
}

// Bytes of "7E 00" or "7E00".
std::optional<std::vector<std::byte>> bytes_of_hex(std::string_view text) {
  std::vector<std::byte> out;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == ' ') {
      ++i;
      continue;
    }
    const std::optional<unsigned> high = hex_digit(text[i]);
    const std::optional<unsigned> low = i + 1 < text.size() ? hex_digit(text[i + 1]) : std::nullopt;
    if (!high || !low) return std::nullopt;
    out.push_back(static_cast<std::byte>(*high * 16 + *low));
    i += 2;
  }
  return out;
}

class LayoutResolver {
 public:
  LayoutResolver(const TeamFile& team, const Locations& where, ErrorList& errors)
      : team_(team), radio_(team.radio), where_(where), errors_(errors) {}

  PacketLayout commands() {
    PacketLayout layout = common(radio_.field, "radio.field");
    layout.one_each = radio_.packet_for == PacketFor::kEach;
    layout.slots = static_cast<std::uint8_t>(layout.one_each ? 0 : radio_.places);
    layout.first_id = static_cast<RobotId>(radio_.first_id);
    const std::string start = "radio." + std::string(radio_.start_hex.empty() ? "start_text" : "start_hex");
    layout.start_at = static_cast<std::uint16_t>(layout.text.size());
    layout.start_size = add_text(layout, start, radio_.start_text, radio_.start_hex);
    layout.start_period_s = radio_.start_period_s;
    add_curve(layout);
    add_receivers(layout);
    if (layout.has(FieldValue::kColor) && !own_is_yellow(team_)) {
      add("own.color", "is \"" + team_.own.color + "\", but the packets of \"" + radio_.format +
                           "\" tell whether we are \"blue\" or \"yellow\"; neither own.color nor opponent.color "
                           "does");
    }
    if (errors_.empty()) check_fields(layout, "radio.field", where_, errors_);
    if (errors_.empty()) check_commands(layout);
    if (errors_.empty()) check_robots(layout, "radio.field", where_, errors_);
    return layout;
  }

  PacketLayout telemetry() {
    PacketLayout layout = common(radio_.telemetry, "radio.telemetry");
    layout.one_each = true;
    for (std::size_t i = 0; i < radio_.telemetry.size(); ++i) {
      if (radio_.telemetry[i].unit != WireUnit::kShare) continue;
      add(element("radio.telemetry", i) + ".unit", "a share of full power is no measured speed");
    }
    add_receivers(layout);
    if (errors_.empty()) check_fields(layout, "radio.telemetry", where_, errors_);
    if (errors_.empty()) check_telemetry(layout, "radio.telemetry", where_, errors_);
    return layout;
  }

  void add_receivers(PacketLayout& layout) {
    for (std::size_t i = 0; i < std::min(team_.own.robot.size(), kMaxRobotsPerTeam); ++i) {
      const RobotEntry& robot = team_.own.robot[i];
      const std::string key = element("own.robot", i) + ".address";
      const std::optional<std::uint64_t> address = radio_address(robot.address);
      if (layout.has(FieldValue::kAddress) && robot.address.empty()) {
        add(element("own.robot", i), "has no address, which the packets of \"" + radio_.format + "\" contain");
      } else if (layout.has(FieldValue::kAddress) && !address) {
        add(key, "\"" + robot.address +
                     "\" is no address: 81, 0x35D0, 24:6F:28:AA:0B:01, 00:13:A2:00:40:0A:01:27 or 192.168.1.11");
      }
      layout.receivers.push_back({static_cast<RobotId>(robot.id), address.value_or(0), robot.wheel_gain});
    }
  }

  // Touchline's own packet is fixed.
  void refuse_keys_of_fields() {
    const auto refuse = [&](bool is_set, const char* key) {
      if (is_set) add(key, "has no effect on Touchline's own packet; a preset or format = \"own\" can have it");
    };
    refuse(radio_.framing != Framing::kNone, "radio.framing");
    refuse(radio_.packet_for != PacketFor::kAll, "radio.packet_for");
    refuse(radio_.byte_order != ByteOrder::kLittle, "radio.byte_order");
    refuse(radio_.places != 0, "radio.places");
    refuse(!radio_.start_text.empty(), "radio.start_text");
    refuse(!radio_.start_hex.empty(), "radio.start_hex");
    refuse(!radio_.telemetry.empty(), "radio.telemetry");
  }

  void add(const std::string& key, const std::string& message) { errors_.add(where_.of(key), key, message); }

 private:
  PacketLayout common(const std::vector<FieldEntry>& entries, const std::string& list) {
    PacketLayout layout;
    layout.team = static_cast<TeamNumber>(team_.team_number);
    layout.is_yellow = own_is_yellow(team_).value_or(false);
    layout.framing = radio_.framing;
    layout.set_drive(team_.control.drive.wheel_base_m, team_.control.drive.max_wheel_speed_mps);
    if (entries.size() > kMaxPacketFields) {
      add(list, std::to_string(entries.size()) + " fields; a packet has at most " + std::to_string(kMaxPacketFields));
      return layout;
    }
    for (std::size_t i = 0; i < entries.size(); ++i) add_field(entries, i, element(list, i), layout);
    return layout;
  }

  void add_field(const std::vector<FieldEntry>& entries, std::size_t index, const std::string& key,
                 PacketLayout& layout) {
    const FieldEntry& entry = entries[index];
    PacketField field;
    field.value = entry.value;
    field.type = entry.type;
    field.bits = static_cast<std::uint8_t>(entry.bits);
    field.decimals = static_cast<std::uint8_t>(entry.decimals);
    field.width = static_cast<std::uint8_t>(entry.width);
    field.big_endian = radio_.byte_order == ByteOrder::kBig;
    field.magnitude = entry.magnitude;
    field.between = entry.between;
    field.block = static_cast<std::uint8_t>(entry.block);
    field.check = entry.check;
    field.offset = entry.offset;
    check_type(entry, key);
    field.text_at = static_cast<std::uint16_t>(layout.text.size());
    field.text_size = add_text(layout, key, entry.text, entry.hex);
    field.scale = entry.scale * factor(entry, key);
    if (field.scale == 0.0) add(key + ".scale", "must not be 0");
    if (!std::isfinite(field.scale)) add(key + ".scale", "is too large in this unit");
    add_limits(entry, field);
    add_codes(entry, key, field);
    add_covered(entries, index, key, field);
    layout.fields.push_back(field);
  }

  void check_type(const FieldEntry& entry, const std::string& key) {
    const bool has_bytes = !entry.text.empty() || !entry.hex.empty();
    if (has_bytes && (entry.value != FieldValue::kConstant || entry.type != FieldType::kBytes)) {
      add(key, "text and hex are bytes of a constant: leave out value and type");
    }
    if (!has_bytes && entry.type == FieldType::kBytes) {
      add(key, "is missing its type, or the text or hex of a constant");
    }
    const bool covers = entry.value == FieldValue::kLength || entry.value == FieldValue::kCheck;
    if (covers && byte_count(entry.type) == 0) add(key + ".type", "a length or check is a number of whole bytes");
    if (entry.value == FieldValue::kCheck && byte_count(entry.type) != check_bytes(entry.check)) {
      add(key + ".type", "this check has " + std::to_string(check_bytes(entry.check)) + " bytes");
    }
    const bool is_long = entry.type == FieldType::kU48 || entry.type == FieldType::kU64;
    if (is_long && entry.value != FieldValue::kAddress) add(key + ".type", "only an address has this type");
    if (entry.between && entry.block == 0) add(key + ".between", "only a field of a block lies between robots");
    if (entry.between && entry.type != FieldType::kBytes) add(key + ".between", "only constant bytes separate robots");
  }

  // Number of bytes that were added.
  std::uint8_t add_text(PacketLayout& layout, const std::string& key, const std::string& text, const std::string& hex) {
    std::vector<std::byte> bytes;
    for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
    if (const auto more = bytes_of_hex(hex)) {
      bytes.insert(bytes.end(), more->begin(), more->end());
    } else {
      add(key, "\"" + hex + "\" are no bytes in hexadecimal, such as \"7E 00 0C\"");
    }
    if (bytes.empty() && !hex.empty()) add(key, "has no bytes");
    if (layout.text.size() + bytes.size() > kMaxPacketTextBytes) {
      add(key, "the constants of a packet have more than " + std::to_string(kMaxPacketTextBytes) + " bytes");
      return 0;
    }
    for (const std::byte byte : bytes) layout.text.push_back(byte);
    return static_cast<std::uint8_t>(bytes.size());
  }

  // Wire units per SI unit.
  double factor(const FieldEntry& entry, const std::string& key) {
    const Quantity quantity = quantity_of(entry.value);
    const bool is_speed = quantity == Quantity::kWheel || quantity == Quantity::kForward;
    const bool is_wheel = quantity == Quantity::kWheel;
    switch (entry.unit) {
      case WireUnit::kMps:
        if (is_speed) return 1.0;
        break;
      case WireUnit::kCmps:
        if (is_speed) return 100.0;
        break;
      case WireUnit::kMmps:
        if (is_speed) return 1000.0;
        break;
      case WireUnit::kRadps:
        if (quantity == Quantity::kTurnRate) return 1.0;
        if (is_wheel) return 1.0 / radius(key);
        break;
      case WireUnit::kDegps:
        if (quantity == Quantity::kTurnRate) return kDegreesPerRadian;
        if (is_wheel) return kDegreesPerRadian / radius(key);
        break;
      case WireUnit::kRpm:
        if (is_wheel) return 60.0 / (kTurn_rad * radius(key));
        break;
      case WireUnit::kTurnsps:
        if (is_wheel) return 1.0 / (kTurn_rad * radius(key));
        break;
      case WireUnit::kStepsps:
        if (is_wheel) return steps(key) / (kTurn_rad * radius(key));
        break;
      case WireUnit::kShare:
        if (is_wheel) return 1.0;
        break;
      case WireUnit::kVolt:
        if (quantity == Quantity::kBattery) return 1.0;
        break;
      case WireUnit::kMillivolt:
        if (quantity == Quantity::kBattery) return 1000.0;
        break;
      case WireUnit::kPercent:
        if (quantity == Quantity::kLink) return 1.0;
        break;
      case WireUnit::kNone:
        if (quantity == Quantity::kOther || quantity == Quantity::kLink) return 1.0;
        add(key, "has no unit: \"" + std::string(config::word_of(entry.value, kFieldValues)) + "\" needs one");
        return 1.0;
    }
    add(key + ".unit", "\"" + std::string(config::word_of(entry.unit, kWireUnits)) + "\" is no unit of \"" +
                           std::string(config::word_of(entry.value, kFieldValues)) + "\"");
    return 1.0;
  }

  double radius(const std::string& key) {
    if (radio_.wheel_radius_m > 0.0) return radio_.wheel_radius_m;
    add(key + ".unit", "needs radio.wheel_radius_m");
    return 1.0;
  }

  double steps(const std::string& key) {
    if (radio_.steps_per_turn > 0.0) return radio_.steps_per_turn;
    add(key + ".unit", "needs radio.steps_per_turn");
    return 1.0;
  }

  // Digits without limits could fill any packet.
  static void add_limits(const FieldEntry& entry, PacketField& field) {
    const double fastest = entry.value == FieldValue::kTurn ? kFastest_radps : kFastest_mps;
    const bool is_counter = entry.value == FieldValue::kTime || entry.value == FieldValue::kSequence;
    const bool has_unit = quantity_of(entry.value) != Quantity::kOther;
    const double limit = is_counter ? kLargestDigits
                         : has_unit ? std::min(std::abs(fastest * field.scale) + std::abs(field.offset), kLargestDigits)
                                    : 1e5;
    const bool is_digits = field.type == FieldType::kDigits;
    field.low = entry.low > -FieldEntry::kUnlimited || !is_digits ? entry.low : entry.magnitude ? 0.0 : -limit;
    field.high = entry.high < FieldEntry::kUnlimited || !is_digits ? entry.high : limit;
    // Counters and addresses use all bits of their type.
    if (!is_digits && entry.low <= -FieldEntry::kUnlimited) field.low = PacketField{}.low;
    if (!is_digits && entry.high >= FieldEntry::kUnlimited) field.high = PacketField{}.high;
  }

  void add_codes(const FieldEntry& entry, const std::string& key, PacketField& field) {
    const bool has_two =
        entry.value == FieldValue::kStop || entry.value == FieldValue::kColor || is_direction(entry.value);
    const std::size_t count = has_two ? 2U : entry.value == FieldValue::kDirections ? 4U : 0U;
    if (!entry.codes.empty() && entry.codes.size() != count) {
      add(key + ".codes", std::to_string(entry.codes.size()) + " codes instead of " + std::to_string(count));
      return;
    }
    std::copy(entry.codes.begin(), entry.codes.end(), field.codes.begin());
  }

  void add_covered(const std::vector<FieldEntry>& entries, std::size_t index, const std::string& key,
                   PacketField& field) {
    const bool is_length = entries[index].value == FieldValue::kLength;
    std::size_t first = is_length ? index + 1 : 0, end = is_length ? entries.size() : index;
    for (std::size_t i = index + 1; is_length && i < end; ++i) {
      if (entries[i].value == FieldValue::kCheck) end = i;
    }
    if (const auto found = named(entries, entries[index].from, key + ".from")) first = *found;
    if (const auto found = named(entries, entries[index].to, key + ".to")) end = *found + 1;
    if (end < first) {
      add(key, entries[index].to.empty() ? "\"from\" lies after the last field that is covered: add \"to\""
                                         : "\"to\" lies before \"from\"");
    }
    field.first = static_cast<std::uint8_t>(first);
    field.end = static_cast<std::uint8_t>(end);
  }

  std::optional<std::size_t> named(const std::vector<FieldEntry>& entries, const std::string& name,
                                   const std::string& key) {
    if (name.empty()) return std::nullopt;
    std::vector<std::string_view> names;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (entries[i].name == name) return i;
      if (!entries[i].name.empty()) names.push_back(entries[i].name);
    }
    add(key, "no field is named \"" + name + "\"" + suggestion(name, names, "names"));
    return std::nullopt;
  }

  void add_curve(PacketLayout& layout) {
    const auto& speeds = radio_.pwm_speed_mps;
    const auto& shares = radio_.pwm_share;
    if (speeds.size() != shares.size() || speeds.size() > kMaxPwmPoints || speeds.size() == 1) {
      add("radio.pwm_share",
          "pwm_speed_mps and pwm_share have the same number of values, 2 to " + std::to_string(kMaxPwmPoints));
      return;
    }
    const auto rises = [](const std::vector<double>& values) {
      const auto not_above = [](double a, double b) { return static_cast<float>(a) >= static_cast<float>(b); };
      return std::adjacent_find(values.begin(), values.end(), not_above) == values.end();
    };
    if (!rises(speeds) || !rises(shares) || (!speeds.empty() && speeds[0] != 0.0)) {
      add("radio.pwm_share", "speeds must rise from 0, and shares with them");
      return;
    }
    if (!uses_share()) return;
    for (std::size_t i = 0; i < radio_.field.size(); ++i) {
      if (quantity_of(radio_.field[i].value) != Quantity::kWheel || radio_.field[i].unit == WireUnit::kShare) continue;
      add(element("radio.field", i) + ".unit", "is not \"share\" as that of the other wheel speeds");
    }
    layout.pwm_is_assumed = speeds.empty();
    layout.set_drive(team_.control.drive.wheel_base_m, team_.control.drive.max_wheel_speed_mps);
    for (std::size_t i = 0; i < speeds.size(); ++i) {
      layout.pwm.push_back({static_cast<float>(speeds[i]), static_cast<float>(shares[i])});
    }
  }

  [[nodiscard]] bool uses_share() const {
    return std::any_of(radio_.field.begin(), radio_.field.end(),
                       [](const FieldEntry& field) { return field.unit == WireUnit::kShare; });
  }

  void check_commands(const PacketLayout& layout) {
    const bool has_wheels = layout.has(FieldValue::kLeft) && layout.has(FieldValue::kRight);
    const bool has_twist = layout.has(FieldValue::kForward) && layout.has(FieldValue::kTurn);
    if (!has_wheels && !has_twist) {
      add("radio.field", radio_.field.empty() ? "is missing: the packets of format \"own\" have no fields"
                                              : "no fields carry left and right, or forward and turn");
      return;
    }
    for (std::size_t i = 0; i < layout.fields.size(); ++i) {
      const PacketField& field = layout.fields[i];
      const bool of_robot = quantity_of(field.value) != Quantity::kOther || field.value == FieldValue::kId ||
                            field.value == FieldValue::kAddress || field.value == FieldValue::kDirections ||
                            is_direction(field.value);
      if (of_robot && field.block == 0 && !layout.one_each) {
        add(element("radio.field", i), "belongs to one robot of several: give it a block, or packet_for = \"each\"");
      }
      if (field.block > 0 && layout.one_each) {
        add(element("radio.field", i) + ".block", "a packet for each robot has no blocks");
      }
    }
    const bool names_robots = layout.has(FieldValue::kId) || layout.has(FieldValue::kAddress);
    if (!layout.one_each && !names_robots && layout.slots == 0) {
      add("radio.places", "is missing: without ids, each robot needs a place in the packet");
    }
    const std::size_t largest = largest_packet(layout, layout.receivers.size());
    if (largest == 0 || largest + layout.start_size > kMaxPacketBytes) {
      add("radio.field", "a packet of this team can have " + std::to_string(largest + layout.start_size) +
                             " bytes; at most " + std::to_string(kMaxPacketBytes) + " are sent");
    }
    for (std::size_t i = 0; layout.is_by_place() && i < layout.receivers.size(); ++i) {
      const int place = layout.receivers[i].id - layout.first_id;
      if (place < 0 || place >= layout.slots) {
        add(element("own.robot", i) + ".id", "has no place in the packets: places stand for the ids " +
                                                 std::to_string(layout.first_id) + " to " +
                                                 std::to_string(layout.first_id + layout.slots - 1));
      }
    }
  }

  const TeamFile& team_;
  const RadioEntry& radio_;
  const Locations& where_;
  ErrorList& errors_;
};

}  // namespace

Result<void> resolve_radio(const TeamFile& team, const Locations& where, PipelineParameters& out) {
  ErrorList errors;
  const std::string& format = team.radio.format;
  const Locations places = locations_with_preset(where, format);
  LayoutResolver resolver(team, places, errors);
  if (format == "touchline" && team.radio.field.empty()) {
    out.radio = touchline_layout(static_cast<TeamNumber>(team.team_number));
    resolver.add_receivers(out.radio);
    out.telemetry = touchline_telemetry_layout();
    resolver.refuse_keys_of_fields();
    return errors.result();
  }
  if (format == "touchline") {
    resolver.add("radio.format",
                 "[[radio.field]] replaces the fields of a preset or describes packets of your own: set "
                 "format = \"own\"");
    return errors.result();
  }
  RadioEntry preset;
  if (format != "own" && !read_radio_preset(format, preset)) {
    std::vector<std::string_view> names{"touchline", "own"};
    for (const RadioPreset& known : radio_presets()) names.push_back(known.name);
    resolver.add("radio.format", "no robots are known as \"" + format + "\"" + suggestion(format, names, "presets"));
    return errors.result();
  }
  out.radio = resolver.commands();
  out.telemetry = resolver.telemetry();
  return errors.result();
}

}  // namespace touchline::config
