#include "hal/linux/v4l2/huffman_scan.h"

#include <algorithm>

namespace touchline::hal {

bool HuffmanCode::set(Kind kind, std::span<const std::uint8_t, 17> counts, std::span<const std::uint8_t, 256> symbols) {
  if (kind == kind_ && std::equal(counts.begin() + 1, counts.end(), counts_.begin() + 1) &&
      std::equal(symbols.begin(), symbols.end(), symbols_.begin())) {
    return is_valid_;
  }
  kind_ = kind;
  std::copy(counts.begin(), counts.end(), counts_.begin());
  std::copy(symbols.begin(), symbols.end(), symbols_.begin());
  is_valid_ = false;
  std::uint32_t code = 0;
  std::int32_t number = 0;
  for (unsigned bits = 1; bits <= kMostCodeBits; ++bits) {
    offset_[bits] = number - static_cast<std::int32_t>(code);
    code += counts_[bits];
    number += counts_[bits];
    limit_[bits] = code << (kMostCodeBits - bits);
    if (code > 1u << bits || number > 256) return false;
    code <<= 1;
  }
  constexpr unsigned kMostValueBits = 15;
  const bool has_only_sizes = std::all_of(symbols_.begin(), symbols_.begin() + number,
                                          [](unsigned symbol) { return symbol <= kMostValueBits; });
  if (kind_ == Kind::kFirst && !has_only_sizes) return false;
  fill_table();
  return is_valid_ = true;
}

void HuffmanCode::fill_table() {
  for (std::size_t index = 0; index < table_.size(); ++index) {
    const std::uint64_t bits = std::uint64_t{index} << (64 - kShortBits);
    const unsigned length = length_at(bits, 1);
    if (length > kShortBits) {
      table_[index] = {};
      continue;
    }
    const Coefficient found = decoded(symbol_at(bits, length), length, bits << length);
    table_[index] = found;
    if (found.bits > kShortBits) table_[index] = {symbol_at(bits, length), 0, static_cast<std::uint8_t>(length)};
  }
}

unsigned HuffmanCode::length_at(std::uint64_t bits, unsigned least) const {
  const auto first = static_cast<std::uint32_t>(bits >> 48);
  unsigned length = least;
  while (length <= kMostCodeBits && first >= limit_[length]) ++length;
  return length;
}

std::uint8_t HuffmanCode::symbol_at(std::uint64_t bits, unsigned length) const {
  return symbols_[static_cast<std::uint8_t>(offset_[length] + static_cast<std::int32_t>(bits >> (64 - length)))];
}

HuffmanCode::Coefficient HuffmanCode::find_long(std::uint64_t bits) const {
  // Mostly, the code is short and only its value is long.
  const Coefficient known = find_short(bits);
  if (known.advance > 0) return decoded(static_cast<std::uint8_t>(known.value), known.advance, bits << known.advance);
  const unsigned length = length_at(bits, kShortBits + 1);
  if (length > kMostCodeBits) return {};
  return decoded(symbol_at(bits, length), length, bits << length);
}

HuffmanCode::Coefficient HuffmanCode::decoded(std::uint8_t symbol, unsigned code_bits, std::uint64_t after) const {
  const unsigned size = symbol & 15u, skipped = symbol >> 4;
  Coefficient found;
  found.bits = static_cast<std::uint8_t>(code_bits + size);
  if (size > 0) {
    const auto bits = static_cast<std::int32_t>(after >> (64 - size));
    found.value = static_cast<std::int16_t>(bits < 1 << (size - 1) ? bits - (1 << size) + 1 : bits);
  }
  const bool is_end = size == 0 && skipped != 15 && kind_ == Kind::kOthers;
  found.advance = static_cast<std::uint8_t>(is_end ? kEndOfBlock : skipped + 1);
  return found;
}

void HuffmanScan::open(std::size_t most_bytes) { bytes_.resize(most_bytes + kPadding); }

bool HuffmanScan::begin(std::span<const std::uint8_t> data) {
  rest_ = data;
  restarts_ = 0;
  return read_segment();
}

bool HuffmanScan::restart() {
  if (!is_segment_complete() || marker_ != kFirstRestart + restarts_) return false;
  restarts_ = static_cast<std::uint8_t>((restarts_ + 1) % kRestarts);
  return read_segment();
}

bool HuffmanScan::read_segment() {
  const std::size_t room = bytes_.size() - kPadding;
  std::size_t number = 0;
  const std::uint8_t* from = rest_.data();
  const std::uint8_t* const end = from + rest_.size();
  marker_ = 0;
  while (marker_ == 0) {
    const auto left = static_cast<std::size_t>(end - from);
    const auto* const found = left > 0 ? static_cast<const std::uint8_t*>(std::memchr(from, 0xff, left)) : nullptr;
    if (found == nullptr || found + 1 == end) return false;
    const auto plain = static_cast<std::size_t>(found - from);
    if (plain + 1 > room - number) return false;
    std::memcpy(bytes_.data() + number, from, plain);
    number += plain;
    // Any number of 0xff may precede a marker.
    from = found[1] == 0xff ? found + 1 : found + 2;
    if (found[1] == 0) {
      bytes_[number++] = 0xff;
    } else if (found[1] != 0xff) {
      marker_ = found[1];
    }
  }
  rest_ = {from, end};
  std::memset(bytes_.data() + number, 0, kPadding);
  bits_ = {.at = bytes_.data()};
  limit_ = bits_.at + number + 8;
  return true;
}

}  // namespace touchline::hal
