#include "core/radio/packet_parser.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "core/radio/field_type.h"
#include "core/radio/packet_encoder.h"

namespace touchline {
namespace {

constexpr std::uint8_t kMaxDigits = 20;
constexpr double kMaxRobotId = 127.0, kMaxLinkPercent = 100.0;

class PacketParser {
 public:
  PacketParser(const PacketLayout& layout, std::span<const std::byte> bytes, FieldReadings& readings)
      : layout_(layout), bytes_(bytes), readings_(readings) {}

  std::size_t parse() {
    readings_.clear();
    const auto& fields = layout_.fields;
    for (std::size_t i = 0; i < fields.size() && state_ == State::kFine;) {
      const std::size_t end = block_end(layout_, i);
      if (fields[i].block != 0 || !is_bits(fields[i].type)) align();
      for (std::size_t k = i; k < end; ++k) begin_[k] = at_ + (bit_ > 0 ? 1U : 0U);
      if (fields[i].block == 0) {
        read(i, 0);
      } else {
        read_block(i, end);
      }
      i = end;
    }
    align();
    begin_[fields.size()] = at_;
    if (state_ == State::kFine && !is_consistent()) state_ = State::kWrong;
    if (state_ != State::kFine) return state_ == State::kShort ? kMoreBytes : kNoPacket;
    return at_;
  }

 private:
  enum class State : std::uint8_t { kFine, kShort, kWrong };

  void read_block(std::size_t begin, std::size_t end) {
    bool counted = layout_.slots > 0 || layout_.one_each || count_.has_value();
    std::size_t count = layout_.one_each ? 1 : layout_.slots > 0 ? layout_.slots : count_.value_or(0);
    const auto* const fields = layout_.fields.begin();
    if (!counted &&
        std::none_of(fields + begin, fields + end, [](const PacketField& field) { return field.between; })) {
      counted = true;  // the packets list the whole team
      count = layout_.receivers.size();
    }
    for (std::size_t robot = 0; state_ == State::kFine && (!counted || robot < count); ++robot) {
      if (robot >= kMaxRobotsPerTeam) {
        state_ = State::kWrong;
        return;
      }
      for (std::size_t k = begin; k < end && state_ == State::kFine; ++k) {
        if (robot == 0) begin_[k] = at_ + (bit_ > 0 ? 1U : 0U);
        const bool separates = layout_.fields[k].between;
        if (separates && counted && robot + 1 == count) continue;
        if (separates && !counted && !continues(layout_.fields[k])) return;
        read(k, robot);
      }
    }
  }

  // Whether the bytes after a robot separate it from another one.
  bool continues(const PacketField& separator) {
    align();
    if (at_ >= bytes_.size()) {
      state_ = State::kShort;
      return false;
    }
    return bytes_[at_] == layout_.text[separator.text_at];
  }

  void read(std::size_t index, std::size_t robot) {
    const PacketField& field = layout_.fields[index];
    if (!is_bits(field.type)) align();
    const auto begin = static_cast<std::uint16_t>(at_);
    FieldReading reading{static_cast<std::uint16_t>(index), static_cast<std::uint16_t>(robot), begin, begin, 0.0, 0};
    if (field.type == FieldType::kBytes) {
      read_text(field);
    } else if (field.type == FieldType::kDigits) {
      reading.number = read_digits(field);
    } else if (is_bits(field.type)) {
      reading.number = extended(reading.address = read_bits(field), field);
    } else {
      reading.address = read_bytes(field);
      reading.number = number_of(reading.address, field);
    }
    if (state_ != State::kFine) return;
    reading.end = static_cast<std::uint16_t>(is_bits(field.type) && bit_ > 0 ? at_ + 1 : at_);
    if (field.value == FieldValue::kConstant && field.type != FieldType::kBytes &&
        reading.number != sent_number(field, field.offset)) {
      state_ = State::kWrong;
    }
    if (field.value == FieldValue::kTeam && reading.number == field.offset && layout_.team != kNoTeamNumber) {
      state_ = State::kWrong;  // 0 is not a team's number
    }
    // A packet for the robots of the other color.
    if (field.value == FieldValue::kColor && reading.number != field.codes[layout_.is_yellow ? 1 : 0]) {
      state_ = State::kWrong;
    }
    if (field.value == FieldValue::kCount) {
      const double count = (reading.number - field.offset) / field.scale;
      if (!(count >= 0.0 && count <= static_cast<double>(kMaxRobotsPerTeam))) {
        state_ = State::kWrong;
        return;
      }
      count_ = static_cast<std::size_t>(count);
    }
    if (!readings_.push_back(reading)) state_ = State::kWrong;
  }

  void read_text(const PacketField& field) {
    for (std::size_t i = 0; i < field.text_size; ++i, ++at_) {
      if (at_ >= bytes_.size()) {
        state_ = State::kShort;
        return;
      }
      if (bytes_[at_] != layout_.text[field.text_at + i]) {
        state_ = State::kWrong;
        return;
      }
    }
  }

  double read_digits(const PacketField& field) {
    const std::size_t begin = at_;
    bool negative = false, point = false, digit = false;
    double number = 0.0, unit = 1.0;
    for (;; ++at_) {
      if (field.width > 0 && at_ - begin == field.width) break;
      if (at_ >= bytes_.size()) {
        state_ = State::kShort;
        return 0.0;
      }
      const char c = std::to_integer<char>(bytes_[at_]);
      if (c == '-' && at_ == begin) {
        negative = true;
      } else if (c == '.' && !point) {
        point = true;
      } else if (c >= '0' && c <= '9') {
        digit = true;
        number = number * 10.0 + (c - '0');
        if (point) unit *= 10.0;
      } else {
        break;
      }
      if (at_ - begin >= kMaxDigits) {
        state_ = State::kWrong;
        return 0.0;
      }
    }
    if (!digit) state_ = State::kWrong;
    return (negative ? -number : number) / unit;
  }

  std::uint32_t read_bits(const PacketField& field) {
    std::uint32_t number = 0;
    for (unsigned i = 0; i < field.bits; ++i) {
      if (at_ >= bytes_.size()) {
        state_ = State::kShort;
        return 0;
      }
      number |= ((std::to_integer<std::uint32_t>(bytes_[at_]) >> bit_) & 1u) << i;
      if (++bit_ == 8) align();
    }
    return number;
  }

  std::uint64_t read_bytes(const PacketField& field) {
    const std::size_t count = byte_count(field.type);
    if (bytes_.size() - at_ < count) {
      state_ = State::kShort;
      return 0;
    }
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t place = field.big_endian ? count - 1 - i : i;
      number |= std::to_integer<std::uint64_t>(bytes_[at_ + i]) << (8 * place);
    }
    at_ += count;
    return number;
  }

  static double number_of(std::uint64_t bytes, const PacketField& field) {
    if (field.type == FieldType::kF64) return std::bit_cast<double>(bytes);
    if (field.type != FieldType::kF32) return extended(bytes, field);
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bytes)));
  }

  // With the sign of signed types.
  static double extended(std::uint64_t number, const PacketField& field) {
    if (integer_range(field).low == 0) return static_cast<double>(number);
    const unsigned bits = is_bits(field.type) ? field.bits : static_cast<unsigned>(8 * byte_count(field.type));
    const std::int64_t sign = std::int64_t{1} << (bits - 1u);
    return static_cast<double>((static_cast<std::int64_t>(number) ^ sign) - sign);
  }

  void align() {
    if (bit_ > 0) ++at_;
    bit_ = 0;
  }

  // Whether lengths and checks are right.
  [[nodiscard]] bool is_consistent() const {
    for (const FieldReading& reading : readings_) {
      const PacketField& field = layout_.fields[reading.field];
      if (field.value != FieldValue::kLength && field.value != FieldValue::kCheck) continue;
      const std::size_t begin = begin_[field.first], end = begin_[field.end];
      if (end < begin) return false;
      const std::span<const std::byte> covered = bytes_.subspan(begin, end - begin);
      const double expected = field.value == FieldValue::kLength
                                  ? sent_number(field, static_cast<double>(covered.size()) + field.offset)
                                  : static_cast<double>(checksum(field.check, covered));
      if (reading.number != expected) return false;
    }
    return true;
  }

  const PacketLayout& layout_;
  std::span<const std::byte> bytes_;
  FieldReadings& readings_;
  State state_ = State::kFine;
  std::size_t at_ = 0;
  unsigned bit_ = 0;
  std::optional<std::size_t> count_;
  std::array<std::size_t, kMaxPacketFields + 1> begin_{};  // of each field's first repetition, and of the list's end
};

/// What the fields of one robot say.
struct RobotReading {
  bool known = true;  // it is one of the receivers
  RobotId id = kUnknownId;
  double left = 0.0, right = 0.0, forward = 0.0, turn = 0.0;
  bool has_left = false, has_right = false, has_twist = false, left_backward = false, right_backward = false,
       backward = false, to_the_right = false;
};

// Index of the code; 4: none.
std::size_t code_of(const PacketField& field, double number, std::size_t codes) {
  for (std::size_t i = 0; i < codes; ++i) {
    if (field.codes[i] == number) return i;
  }
  return 4;
}

class PacketDecoder {
 public:
  PacketDecoder(const PacketLayout& layout, RobotId receiver) : layout_(layout), receiver_(receiver) {}

  Status decode(const FieldReadings& readings, ParsedPacket& out) {
    for (const FieldReading& reading : readings) {
      if (!take(reading)) return ErrorCode::kCorruptFrame;
    }
    packet_.commands.stop = packet_.stop;
    if (!robots_.empty() && (robots_[0].has_twist || (robots_[0].has_left && robots_[0].has_right))) {
      packet_.telemetry.wheels = command_of(robots_[0]).wheels;
    }
    const bool has_places = layout_.slots > 0 || layout_.one_each;
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      RobotReading& robot = robots_[i];
      if (robot.id == kUnknownId && has_places) {
        robot.id = layout_.one_each ? receiver_ : static_cast<RobotId>(layout_.first_id + static_cast<int>(i));
      }
      if (!robot.known || robot.id == kUnknownId) continue;
      for (const RobotCommand& other : packet_.commands.robots) {
        if (other.id == robot.id) return ErrorCode::kCorruptFrame;
      }
      packet_.commands.robots.push_back(command_of(robot));
    }
    out = packet_;
    return {};
  }

 private:
  // False: the packet means nothing.
  bool take(const FieldReading& reading) {
    const PacketField& field = layout_.fields[reading.field];
    const double value = value_of(layout_, reading);
    switch (field.value) {
      case FieldValue::kId:
        if (!(value >= 0.0 && value <= kMaxRobotId)) return false;
        robot(reading).id = static_cast<RobotId>(std::lround(value));
        packet_.telemetry.id = robot(reading).id;
        return true;
      case FieldValue::kAddress:
        return take_address(robot(reading), field, reading.address);
      case FieldValue::kLeft:
        robot(reading).left = value;
        robot(reading).has_left = true;
        return is_number(value);
      case FieldValue::kRight:
        robot(reading).right = value;
        robot(reading).has_right = true;
        return is_number(value);
      case FieldValue::kForward:
        robot(reading).forward = value;
        robot(reading).has_twist = true;
        return is_number(value);
      case FieldValue::kTurn:
        robot(reading).turn = value;
        robot(reading).has_twist = true;
        return is_number(value);
      case FieldValue::kDirections: {
        const std::size_t code = code_of(field, reading.number, 4);
        robot(reading).left_backward = (code & 1u) != 0u;
        robot(reading).right_backward = (code & 2u) != 0u;
        return code < 4;
      }
      case FieldValue::kLeftDirection:
        return take_direction(field, reading.number, robot(reading).left_backward);
      case FieldValue::kRightDirection:
        return take_direction(field, reading.number, robot(reading).right_backward);
      case FieldValue::kForwardDirection:
        return take_direction(field, reading.number, robot(reading).backward);
      case FieldValue::kTurnDirection:
        return take_direction(field, reading.number, robot(reading).to_the_right);
      case FieldValue::kStop: {
        const std::size_t code = code_of(field, reading.number, 2);
        packet_.stop = code == 1;
        return code < 2;
      }
      case FieldValue::kSequence:
        packet_.has_sequence = true;
        take_sequence(field, value);
        return std::isfinite(value);
      case FieldValue::kTeam:
        packet_.team = static_cast<TeamNumber>(std::lround(value));
        return true;
      case FieldValue::kBattery:
        packet_.telemetry.battery_v = static_cast<float>(value);
        return is_number(value);
      case FieldValue::kLink:
        if (reading.number == kUnknownLink) return true;
        packet_.telemetry.link_percent = static_cast<std::int8_t>(std::lround(std::clamp(value, 0.0, kMaxLinkPercent)));
        return value >= 0.0 && value <= kMaxLinkPercent;
      default:
        return true;
    }
  }

  // Whether it is finite as a float, too, and so is a sum of two. Comparisons with NaN are false.
  static bool is_number(double value) { return std::abs(value) <= 1e30; }

  static bool take_direction(const PacketField& field, double number, bool& backward) {
    const std::size_t code = code_of(field, number, 2);
    backward = code == 1;
    return code < 2;
  }

  void take_sequence(const PacketField& field, double value) {
    packet_.telemetry.sequence = static_cast<std::uint8_t>(std::llround(value) & 0xFF);
    const bool is_short = is_bits(field.type) && field.bits < 8;
    const unsigned shift = is_short ? 8U - field.bits : 0U;
    packet_.sequence = static_cast<std::uint8_t>(packet_.telemetry.sequence << shift);
  }

  // The field may carry the lowest bits only, such as the last bytes of a MAC address.
  bool take_address(RobotReading& robot, const PacketField& field, std::uint64_t address) {
    robot.known = false;
    for (const Receiver& receiver : layout_.receivers) {
      if ((receiver.address & address_bits(field)) != address) continue;
      packet_.telemetry.id = robot.id = receiver.id;
      robot.known = true;
    }
    return true;
  }

  RobotReading& robot(const FieldReading& reading) {
    while (robots_.size() <= reading.robot) robots_.push_back({});
    return robots_[reading.robot];
  }

  [[nodiscard]] RobotCommand command_of(const RobotReading& robot) const {
    RobotCommand command;
    command.id = robot.id;
    WheelSpeeds wheels{static_cast<float>(robot.left_backward ? -robot.left : robot.left),
                       static_cast<float>(robot.right_backward ? -robot.right : robot.right)};
    if (robot.has_twist) {
      const double forward = robot.backward ? -robot.forward : robot.forward;
      const double half = (robot.to_the_right ? -robot.turn : robot.turn) * layout_.wheel_base_m / 2;
      wheels = {static_cast<float>(forward - half), static_cast<float>(forward + half)};
    }
    if (!packet_.stop) command.wheels = wheels;
    return command;
  }

  const PacketLayout& layout_;
  RobotId receiver_;
  ParsedPacket packet_;
  FixedVector<RobotReading, kMaxRobotsPerTeam> robots_;
};

}  // namespace

std::size_t parse_packet(const PacketLayout& layout, std::span<const std::byte> bytes, FieldReadings& readings) {
  return PacketParser(layout, bytes, readings).parse();
}

double value_of(const PacketLayout& layout, const FieldReading& reading) {
  const PacketField& field = layout.fields[reading.field];
  const double value = (reading.number - field.offset) / field.scale;
  const bool is_share = field.value == FieldValue::kLeft || field.value == FieldValue::kRight;
  return is_share ? speed_of_share(layout, value) : value;
}

Status decode_packet(const PacketLayout& layout, std::span<const std::byte> bytes, RobotId receiver,
                     ParsedPacket& out) {
  FieldReadings readings;
  if (layout.fields.empty() || parse_packet(layout, bytes, readings) != bytes.size()) return ErrorCode::kCorruptFrame;
  return decode_packet(layout, readings, receiver, out);
}

Status decode_packet(const PacketLayout& layout, const FieldReadings& readings, RobotId receiver, ParsedPacket& out) {
  return PacketDecoder(layout, receiver).decode(readings, out);
}

}  // namespace touchline
