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

constexpr double kStepsPerMps = 1000.0, kStepsPerVolt = 1000.0;

}  // namespace

bool PacketLayout::has(FieldValue value) const {
  return std::any_of(fields.begin(), fields.end(), [&](const PacketField& field) { return field.value == value; });
}

std::uint64_t PacketLayout::address_of(RobotId id) const {
  for (const Receiver& receiver : receivers) {
    if (receiver.id == id) return receiver.address;
  }
  return 0;
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
  std::size_t bits = 0;
  for (const PacketField& field : layout.fields) {
    std::size_t of_field = 8 * byte_count(field.type);
    if (is_bits(field.type)) of_field = field.bits;
    if (field.type == FieldType::kBytes) of_field = 8U * field.text_size;
    if (field.type == FieldType::kDigits) {
      const double largest = std::max(std::abs(field.low), std::abs(field.high));
      if (field.width == 0 && !(largest < 1e9)) return 0;
      const auto digits = static_cast<std::size_t>(std::max(0.0, std::floor(std::log10(std::max(largest, 1.0))))) + 1;
      const std::size_t point = field.decimals > 0 ? field.decimals + 1U : 0U;
      of_field = 8 * std::max<std::size_t>(field.width, digits + point + (field.low < 0.0 ? 1 : 0));
    }
    bits += of_field * (field.block == 0 ? 1 : repeats);
  }
  const std::size_t bytes = (bits + 7) / 8;
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
