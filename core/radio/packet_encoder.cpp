#include "core/radio/packet_encoder.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/radio/field_type.h"
#include "core/radio/framing.h"

namespace touchline {
namespace {

constexpr double kLargestCounter = 999999999.0;  // of digits
// A PWM curve begins where wheels start to turn. Touchline's own packet sends 0 below half a step of 1 mm/s.
constexpr double kStandstill_mps = 0.0005;

bool is_code(FieldValue value) {
  return value == FieldValue::kDirections || value == FieldValue::kLeftDirection ||
         value == FieldValue::kRightDirection || value == FieldValue::kForwardDirection ||
         value == FieldValue::kTurnDirection || value == FieldValue::kStop || value == FieldValue::kColor;
}

class PacketEncoder {
 public:
  PacketEncoder(const PacketLayout& layout, std::span<const RobotValues> robots, const PacketValues& values)
      : layout_(layout), robots_(robots), values_(values) {}

  Status encode(Packet& out) {
    const auto& fields = layout_.fields;
    for (std::size_t i = 0; i < fields.size();) {
      const std::size_t end = block_end(layout_, i);
      if (fields[i].block == 0) {
        if (!is_bits(fields[i].type)) align();
        begin_[i] = packet_.size();
        write(i, robots_.empty() ? RobotValues{} : robots_[0]);
      } else {
        align();
        for (std::size_t k = i; k < end; ++k) begin_[k] = packet_.size();
        for (std::size_t robot = 0; robot < robots_.size(); ++robot) {
          for (std::size_t k = i; k < end; ++k) {
            if (robot == 0) begin_[k] = packet_.size();
            if (!fields[k].between || robot + 1 < robots_.size()) write(k, robots_[robot]);
          }
        }
      }
      i = end;
    }
    begin_[fields.size()] = packet_.size();
    // Lengths are covered by checks, so they come first.
    for (const FieldValue value : {FieldValue::kLength, FieldValue::kCheck}) {
      for (std::size_t i = 0; i < fields.size(); ++i) {
        if (fields[i].value == value) fill_in(i);
      }
    }
    if (packet_.overflow() > 0 || !add_framing(layout_.framing, packet_)) return fail(out);
    out.clear();
    for (std::size_t i = 0; values_.start && i < layout_.start_size; ++i) {
      out.push_back(layout_.text[layout_.start_at + i]);
    }
    for (const std::byte byte : packet_) out.push_back(byte);
    return out.overflow() > 0 ? fail(out) : Status{};
  }

 private:
  static Status fail(Packet& out) {
    out.clear();
    return ErrorCode::kFull;
  }

  void write(std::size_t index, const RobotValues& robot) {
    const PacketField& field = layout_.fields[index];
    if (!is_bits(field.type)) align();
    if (field.type == FieldType::kBytes) {
      for (std::size_t i = 0; i < field.text_size; ++i) packet_.push_back(layout_.text[field.text_at + i]);
    } else if (field.type == FieldType::kDigits) {
      write_digits(field, number_of(field, robot));
    } else if (field.type == FieldType::kF32) {
      write_bytes(std::bit_cast<std::uint32_t>(static_cast<float>(sent_number(field, number_of(field, robot)))), 4,
                  field.big_endian);
    } else if (field.type == FieldType::kF64) {
      write_bytes(std::bit_cast<std::uint64_t>(sent_number(field, number_of(field, robot))), 8, field.big_endian);
    } else {
      write_integer(field, integer_of(field, robot));
    }
  }

  // Before limits.
  [[nodiscard]] double number_of(const PacketField& field, const RobotValues& robot) const {
    const double value = value_of(field, robot);
    if (is_code(field.value)) return value;  // codes are numbers on the wire
    const double number = (field.magnitude ? std::abs(value) : value) * field.scale + field.offset;
    return std::isnan(number) ? field.offset : number;
  }

  [[nodiscard]] double value_of(const PacketField& field, const RobotValues& robot) const {
    const WheelSpeeds wheels = values_.stop ? WheelSpeeds{} : robot.wheels;
    const auto left = static_cast<double>(wheels.left_mps), right = static_cast<double>(wheels.right_mps);
    switch (field.value) {
      case FieldValue::kConstant:
      case FieldValue::kUnused:
      case FieldValue::kAddress:  // integer_of()
      case FieldValue::kLength:   // fill_in()
      case FieldValue::kCheck:
        return 0.0;
      case FieldValue::kId:
        return robot.id;
      case FieldValue::kLeft:
        return pwm_share(layout_, left);
      case FieldValue::kRight:
        return pwm_share(layout_, right);
      case FieldValue::kForward:
        return (left + right) / 2;
      case FieldValue::kTurn:
        return (right - left) / layout_.wheel_base_m;
      case FieldValue::kDirections:
        return field.codes[(left < 0.0 ? 1u : 0u) + (right < 0.0 ? 2u : 0u)];
      case FieldValue::kLeftDirection:
        return field.codes[left < 0.0 ? 1 : 0];
      case FieldValue::kRightDirection:
        return field.codes[right < 0.0 ? 1 : 0];
      case FieldValue::kForwardDirection:
        return field.codes[left + right < 0.0 ? 1 : 0];
      case FieldValue::kTurnDirection:
        return field.codes[right < left ? 1 : 0];
      case FieldValue::kStop:
        return field.codes[values_.stop ? 1 : 0];
      case FieldValue::kCount:
        return static_cast<double>(robots_.size());
      case FieldValue::kSequence:
        return values_.sequence;
      case FieldValue::kTeam:
        return layout_.team;
      case FieldValue::kColor:
        return field.codes[layout_.is_yellow ? 1 : 0];
      case FieldValue::kTime:
        return static_cast<double>(values_.time.time_since_epoch() / std::chrono::milliseconds(1));
      case FieldValue::kBattery:
        return static_cast<double>(robot.battery_v);
      case FieldValue::kLink:
        return robot.link_percent < 0 ? kUnknownLink : robot.link_percent;
    }
    return 0.0;
  }

  [[nodiscard]] std::uint64_t integer_of(const PacketField& field, const RobotValues& robot) const {
    if (field.value == FieldValue::kAddress) return robot.address;
    const double number = number_of(field, robot);
    // Counters wrap around instead of staying at their limit.
    if (field.value == FieldValue::kTime || field.value == FieldValue::kSequence) {
      return static_cast<std::uint32_t>(std::llround(number));
    }
    return static_cast<std::uint32_t>(std::llround(sent_number(field, number)));
  }

  void write_integer(const PacketField& field, std::uint64_t number) {
    if (is_bits(field.type)) {
      for (unsigned bit = 0; bit < field.bits; ++bit) push_bit(static_cast<unsigned>((number >> bit) & 1u));
    } else {
      write_bytes(number, byte_count(field.type), field.big_endian);
    }
  }

  void write_bytes(std::uint64_t number, std::size_t count, bool big_endian) {
    for (std::size_t i = 0; i < count; ++i) packet_.push_back(byte_of(number, big_endian ? count - 1 - i : i));
  }

  static std::byte byte_of(std::uint64_t number, std::size_t place) {
    return static_cast<std::byte>((number >> (8 * place)) & 0xFFu);
  }

  void write_digits(const PacketField& field, double number) {
    // Counters wrap around.
    if (field.value == FieldValue::kTime || field.value == FieldValue::kSequence) {
      number = std::fmod(number, std::floor(std::min(field.high, kLargestCounter)) + 1.0);
    }
    auto rest = units_of(field, number);
    const bool is_negative = rest < 0;
    if (is_negative) rest = -rest;
    // From the last digit to the first.
    std::array<char, 24> reversed{};
    std::size_t size = 0;
    std::size_t digits = 0;
    do {
      if (field.decimals > 0 && digits == field.decimals) reversed[size++] = '.';
      reversed[size++] = static_cast<char>('0' + rest % 10);
      rest /= 10;
      ++digits;
    } while (rest > 0 || digits <= field.decimals);
    const std::size_t sign = is_negative ? 1 : 0;
    while (size + sign < std::min<std::size_t>(field.width, 20)) reversed[size++] = '0';
    if (is_negative) reversed[size++] = '-';
    while (size > 0) packet_.push_back(static_cast<std::byte>(reversed[--size]));
  }

  void push_bit(unsigned bit) {
    if (bit_ == 0) packet_.push_back(std::byte{0});
    if (packet_.overflow() == 0) packet_.back() |= static_cast<std::byte>(bit << bit_);
    bit_ = (bit_ + 1) % 8;
  }
  void align() { bit_ = 0; }

  // Writes a length or check over its place.
  void fill_in(std::size_t index) {
    const PacketField& field = layout_.fields[index];
    const std::size_t begin = begin_[field.first], end = begin_[field.end];
    if (packet_.overflow() > 0 || end < begin) return;
    const std::span<const std::byte> covered{packet_.data() + begin, end - begin};
    const double length = sent_number(field, static_cast<double>(covered.size()) + field.offset);
    const auto number = field.value == FieldValue::kLength ? static_cast<std::uint32_t>(std::llround(length))
                                                           : std::uint32_t{checksum(field.check, covered)};
    const std::size_t count = byte_count(field.type);
    for (std::size_t i = 0; i < count; ++i) {
      packet_[begin_[index] + i] = byte_of(number, field.big_endian ? count - 1 - i : i);
    }
  }

  const PacketLayout& layout_;
  std::span<const RobotValues> robots_;
  const PacketValues& values_;
  Packet packet_;
  unsigned bit_ = 0;                                       // next one of the last byte
  std::array<std::size_t, kMaxPacketFields + 1> begin_{};  // of each field's first repetition, and of the list's end
};

}  // namespace

Status encode_packet(const PacketLayout& layout, std::span<const RobotValues> robots, const PacketValues& values,
                     Packet& out) {
  return PacketEncoder(layout, robots, values).encode(out);
}

double pwm_share(const PacketLayout& layout, double speed_mps) {
  const auto& curve = layout.pwm;
  if (curve.empty() || std::isnan(speed_mps)) return speed_mps;
  if (std::abs(speed_mps) < kStandstill_mps) return 0.0;
  const double speed = std::abs(speed_mps);
  double share = 0.0;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const auto x = static_cast<double>(curve[i].speed_mps), y = static_cast<double>(curve[i].share);
    if (speed >= x || i == 0) {
      share = y;
      continue;
    }
    const auto before_x = static_cast<double>(curve[i - 1].speed_mps);
    share += (y - share) * (speed - before_x) / (x - before_x);
    break;
  }
  return std::copysign(std::min(share, 1.0), speed_mps);
}

double speed_of_share(const PacketLayout& layout, double share) {
  const auto& curve = layout.pwm;
  if (curve.empty()) return share;
  const double amount = std::abs(share);
  double speed = 0.0;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const auto low = static_cast<double>(curve[i - 1].share), high = static_cast<double>(curve[i].share);
    if (amount <= low) break;
    const auto before = static_cast<double>(curve[i - 1].speed_mps), after = static_cast<double>(curve[i].speed_mps);
    speed = before + (after - before) * (std::min(amount, high) - low) / (high - low);
  }
  return std::copysign(speed, share);
}

}  // namespace touchline
