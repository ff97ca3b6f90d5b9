#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/radio/packet_layout.h"

// What encoder and parser share.
namespace touchline {

/// Instead of a percentage of received packets: the robot does not measure it.
constexpr double kUnknownLink = 255.0;

constexpr bool is_float(FieldType type) { return type == FieldType::kF32 || type == FieldType::kF64; }
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
    case FieldType::kU48:
      return 6;
    case FieldType::kU64:
    case FieldType::kF64:
      return 8;
    default:
      return 0;
  }
}

struct IntegerRange {
  std::int64_t low = 0, high = 0;
};

/// Range of an integer of at most 32 bits. Signed ones are symmetric, so that forward and backward saturate alike.
constexpr IntegerRange integer_range(const PacketField& field) {
  if (field.type == FieldType::kU64) return {0, std::numeric_limits<std::int64_t>::max()};
  const unsigned bits = is_bits(field.type) ? field.bits : static_cast<unsigned>(8 * byte_count(field.type));
  const bool is_signed = field.type == FieldType::kI8 || field.type == FieldType::kI16 ||
                         field.type == FieldType::kI32 || field.type == FieldType::kSignedBits;
  const std::int64_t high = (std::int64_t{1} << (is_signed ? bits - 1u : bits)) - 1;
  return {is_signed ? -high : 0, high};
}

/// The bits of an address that the field carries: the lowest ones.
constexpr std::uint64_t address_bits(const PacketField& field) {
  if (field.type == FieldType::kU64) return std::numeric_limits<std::uint64_t>::max();
  return static_cast<std::uint64_t>(integer_range(field).high);
}

constexpr std::int64_t power_of_ten(unsigned exponent) {
  std::int64_t power = 1;
  for (; exponent > 0; --exponent) power *= 10;
  return power;
}

/// Range of kDigits in units of the last decimal. With a width, it is what fits into the characters.
constexpr IntegerRange digit_range(const PacketField& field) {
  constexpr unsigned kWholeDigits = 9, kMaxDigitsOfNumber = 15;
  if (field.width == 0) {
    const std::int64_t high = power_of_ten(kWholeDigits + field.decimals) - 1;
    return {-high, high};
  }
  const unsigned point = field.decimals > 0 ? 1u : 0u, room = field.width - std::min<unsigned>(field.width, point);
  const bool has_room_for_sign = room > field.decimals + 1u;
  return {has_room_for_sign ? 1 - power_of_ten(std::min(room - 1u, kMaxDigitsOfNumber)) : 0,
          power_of_ten(std::min(room, kMaxDigitsOfNumber)) - 1};
}

/// Digits in units of the last decimal.
inline std::int64_t units_of(const PacketField& field, double number) {
  const IntegerRange range = digit_range(field);
  const double units = std::clamp(number, field.low, std::max(field.low, field.high)) *
                       static_cast<double>(power_of_ten(field.decimals));
  return std::llround(std::clamp(units, static_cast<double>(range.low), static_cast<double>(range.high)));
}

/// The number that is sent for `number`: rounded and limited as PacketField says.
inline double sent_number(const PacketField& field, double number) {
  if (field.type == FieldType::kDigits) {
    return static_cast<double>(units_of(field, number)) / static_cast<double>(power_of_ten(field.decimals));
  }
  const double limited = std::clamp(number, field.low, std::max(field.low, field.high));
  if (field.type == FieldType::kF32) {
    constexpr auto kLargest = static_cast<double>(std::numeric_limits<float>::max());
    return static_cast<double>(static_cast<float>(std::clamp(limited, -kLargest, kLargest)));
  }
  if (field.type == FieldType::kF64) return limited;
  const IntegerRange range = integer_range(field);
  return std::round(std::clamp(limited, static_cast<double>(range.low), static_cast<double>(range.high)));
}

/// Index after the fields that are written together with field `begin`: itself, or its block.
inline std::size_t block_end(const PacketLayout& layout, std::size_t begin) {
  std::size_t end = begin + 1;
  if (layout.fields[begin].block == 0) return end;
  while (end < layout.fields.size() && layout.fields[end].block == layout.fields[begin].block) ++end;
  return end;
}

}  // namespace touchline
