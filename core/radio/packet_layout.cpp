#include "core/radio/packet_layout.h"

#include <algorithm>
#include <cmath>

#include "core/radio/field_type.h"

namespace touchline {
namespace {

// Adds fields to a layout. Numbers of two bytes are little endian.
class LayoutBuilder {
 public:
  explicit LayoutBuilder(PacketLayout& layout) : layout_(layout) {}

  void text(std::span<const unsigned char> bytes) {
    PacketField field;
    field.value = FieldValue::kConstant;
    field.type = FieldType::kBytes;
    field.text_at = static_cast<std::uint16_t>(layout_.text.size());
    field.text_size = static_cast<std::uint8_t>(bytes.size());
    for (const unsigned char byte : bytes) layout_.text.push_back(static_cast<std::byte>(byte));
    layout_.fields.push_back(field);
  }

  PacketField& field(FieldValue value, FieldType type, double scale = 1.0) {
    PacketField field;
    field.value = value;
    field.type = type;
    field.scale = scale;
    layout_.fields.push_back(field);
    return layout_.fields.back();
  }

  void crc16() {
    PacketField& check = field(FieldValue::kCheck, FieldType::kU16);
    check.check = CheckKind::kCrc16Ccitt;
    check.end = static_cast<std::uint8_t>(layout_.fields.size() - 1);
  }

 private:
  PacketLayout& layout_;
};

// Characters of digits without a width.
std::size_t characters(const PacketField& field, double number) {
  std::int64_t units = units_of(field, number);
  const std::size_t count = (units < 0 ? 1U : 0U) + (field.decimals > 0 ? 1U : 0U);
  std::size_t digits = 0;
  for (; units != 0; units /= 10) ++digits;
  return count + std::max<std::size_t>(digits, field.decimals + 1U);
}

bool has_limit(const PacketField& field) {
  constexpr double kNoLimit = 1e9;
  return field.type != FieldType::kDigits || field.width > 0 ||
         (std::abs(field.low) < kNoLimit && std::abs(field.high) < kNoLimit);
}

// Bytes of a field that is not of bits.
std::size_t largest_field(const PacketField& field) {
  if (field.type == FieldType::kBytes) return field.text_size;
  if (field.type != FieldType::kDigits) return byte_count(field.type);
  return field.width > 0 ? field.width : std::max(characters(field, field.low), characters(field, field.high));
}

constexpr double kStepsPerMps = 1000.0, kStepsPerVolt = 1000.0;

}  // namespace

void PacketLayout::set_drive(double base_m, double max_wheel_speed_mps) {
  wheel_base_m = base_m;
  if (!pwm_is_assumed) return;
  pwm.clear();
  pwm.push_back({0.0f, 0.0f});
  pwm.push_back({static_cast<float>(max_wheel_speed_mps), 1.0f});
}

bool PacketLayout::has(FieldValue value) const {
  return std::any_of(fields.begin(), fields.end(), [&](const PacketField& field) { return field.value == value; });
}

Receiver PacketLayout::receiver_of(RobotId id) const {
  for (const Receiver& receiver : receivers) {
    if (receiver.id == id) return receiver;
  }
  return {id};
}

PacketLayout touchline_layout(TeamNumber team) {
  PacketLayout layout;
  layout.commanded_only = true;
  layout.team = team;
  LayoutBuilder builder(layout);
  builder.text(std::array<unsigned char, 3>{'T', 'L', static_cast<unsigned char>(team == kNoTeamNumber ? 1 : 2)});
  builder.field(FieldValue::kStop, FieldType::kBits).bits = 1;
  builder.field(FieldValue::kUnused, FieldType::kBits).bits = 7;
  builder.field(FieldValue::kSequence, FieldType::kU8);
  if (team != kNoTeamNumber) builder.field(FieldValue::kTeam, FieldType::kU8);
  builder.field(FieldValue::kCount, FieldType::kU8);
  builder.field(FieldValue::kId, FieldType::kU8).block = 1;
  builder.field(FieldValue::kLeft, FieldType::kI16, kStepsPerMps).block = 1;
  builder.field(FieldValue::kRight, FieldType::kI16, kStepsPerMps).block = 1;
  builder.crc16();
  return layout;
}

PacketLayout touchline_telemetry_layout() {
  PacketLayout layout;
  LayoutBuilder builder(layout);
  builder.text(std::array<unsigned char, 3>{'T', 'R', 1});
  builder.field(FieldValue::kId, FieldType::kU8);
  builder.field(FieldValue::kSequence, FieldType::kU8);
  builder.field(FieldValue::kBattery, FieldType::kU16, kStepsPerVolt);
  builder.field(FieldValue::kLink, FieldType::kU8);
  builder.crc16();
  return layout;
}

std::size_t largest_packet(const PacketLayout& layout, std::size_t robots) {
  const std::size_t repeats = layout.one_each ? 1 : std::max<std::size_t>(robots, layout.slots);
  std::size_t bytes = 0;
  unsigned bit = 0;  // next one of the last byte
  for (std::size_t i = 0; i < layout.fields.size();) {
    const std::size_t end = block_end(layout, i);
    const bool in_block = layout.fields[i].block != 0;
    if (in_block) bit = 0;
    for (std::size_t robot = 0; robot < (in_block ? repeats : 1); ++robot) {
      for (std::size_t k = i; k < end; ++k) {
        const PacketField& field = layout.fields[k];
        if (!has_limit(field)) return 0;
        if (field.between && robot + 1 == repeats) continue;
        if (!is_bits(field.type)) {
          bit = 0;
          bytes += largest_field(field);
          continue;
        }
        const unsigned bits = bit + field.bits;
        bytes += (bits + 7) / 8 - (bit > 0 ? 1U : 0U);
        bit = bits % 8;
      }
    }
    i = end;
  }
  switch (layout.framing) {
    case Framing::kNone:
      return bytes;
    case Framing::kCobs:
      return bytes + bytes / 254 + 2;
    case Framing::kSlip:
      return 2 * bytes + 2;
    case Framing::kXbee:
      return 2 * bytes;
  }
  return bytes;
}

}  // namespace touchline
