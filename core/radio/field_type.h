#pragma once

#include <cstddef>
#include <cstdint>

#include "core/radio/packet_layout.h"

// What encoder and parser share.
namespace touchline {

/// Instead of a percentage of received packets: the robot does not measure it.
constexpr double kUnknownLink = 255.0;

constexpr bool is_bits(FieldType type) { return type == FieldType::kBits || type == FieldType::kSignedBits; }

/// Bytes of a number; 0: bits, digits and constant bytes.
constexpr std::size_t byte_count(FieldType type) {
  switch (type) {
    case FieldType::kU8:
    case FieldType::kI8:
      return 1;
    case FieldType::kU16:
    case FieldType::kI16:
      return 2;
    case FieldType::kU32:
    case FieldType::kI32:
    case FieldType::kF32:
      return 4;
    default:
      return 0;
  }
}

struct IntegerRange {
  std::int64_t low = 0, high = 0;
};

/// Range of an integer. Signed ones are symmetric, so that forward and backward saturate alike.
constexpr IntegerRange integer_range(const PacketField& field) {
  const unsigned bits = is_bits(field.type) ? field.bits : static_cast<unsigned>(8 * byte_count(field.type));
  const bool is_signed = field.type == FieldType::kI8 || field.type == FieldType::kI16 ||
                         field.type == FieldType::kI32 || field.type == FieldType::kSignedBits;
  const std::int64_t high = (std::int64_t{1} << (is_signed ? bits - 1u : bits)) - 1;
  return {is_signed ? -high : 0, high};
}

/// Index after the fields that are written together with field `begin`: itself, or its block.
inline std::size_t block_end(const PacketLayout& layout, std::size_t begin) {
  std::size_t end = begin + 1;
  if (layout.fields[begin].block == 0) return end;
  while (end < layout.fields.size() && layout.fields[end].block == layout.fields[begin].block) ++end;
  return end;
}

}  // namespace touchline
