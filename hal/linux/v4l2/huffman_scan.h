#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace touchline::hal {

/// A Huffman code of a JPEG (ITU-T T.81, annexes C and F). A table gives a short code together with the bits of the
/// value that follow it.
class HuffmanCode {
 public:
  /// A coefficient of a block.
  struct Coefficient {
    std::int16_t value = 0;
    std::uint8_t bits = 0;     // of its code and value; 0: no such code
    std::uint8_t advance = 0;  // from the coefficient before; or kEndOfBlock: there are no others
  };
  enum class Kind { kFirst, kOthers };  // the differences of first coefficients (DC), or the other coefficients (AC)
  static constexpr unsigned kEndOfBlock = 128;
  static constexpr unsigned kMostBits = 31;  // of a coefficient
  // The four tables of a picture are to stay in the first-level cache.
  static constexpr unsigned kShortBits = 10;

  /// `counts[i]`: number of codes of i bits, up to 16; `symbols`: in the order of the codes. Returns whether the code
  /// is valid. Setting the same code again takes no time.
  bool set(Kind kind, std::span<const std::uint8_t, 17> counts, std::span<const std::uint8_t, 256> symbols);
  /// The coefficient at the beginning of 64 bits, if it has at most kShortBits.
  [[nodiscard]] Coefficient find_short(std::uint64_t bits) const { return table_[bits >> (64 - kShortBits)]; }
  /// One that find_short() did not find. kMostBits of the bits must be valid.
  [[nodiscard]] Coefficient find_long(std::uint64_t bits) const;

 private:
  static constexpr unsigned kMostCodeBits = 16;

  void fill_table();
  // The length of the code at the beginning of `bits`, at least `least`. Above kMostCodeBits: there is no such code.
  [[nodiscard]] unsigned length_at(std::uint64_t bits, unsigned least) const;
  [[nodiscard]] std::uint8_t symbol_at(std::uint64_t bits, unsigned length) const;
  [[nodiscard]] Coefficient decoded(std::uint8_t symbol, unsigned code_bits, std::uint64_t after) const;

  Kind kind_ = Kind::kFirst;
  bool is_valid_ = false;
  std::array<std::uint8_t, 17> counts_{};
  std::array<std::uint8_t, 256> symbols_{};
  // By length of a code: the first larger value of 16 bits, and the difference between symbol number and code.
  std::array<std::uint32_t, 17> limit_{};
  std::array<std::int32_t, 17> offset_{};
  // By the next bits: a coefficient; or with 0 bits, the symbol and the length of a code whose value is longer; or
  // zeros.
  std::array<Coefficient, 1u << kShortBits> table_{};
};

/// Reads the blocks of a JPEG's scan. It knows no error: what is unusual is refused, for another decoder to judge.
class HuffmanScan {
 public:
  using Block = std::array<std::int16_t, 64>;

  /// `most_bytes`: of the data between two restart markers. Allocates.
  void open(std::size_t most_bytes);
  /// Takes the data of a scan. They must end with a marker, and outlive the reading.
  [[nodiscard]] bool begin(std::span<const std::uint8_t> data);
  /// Goes to the data after the next restart marker.
  [[nodiscard]] bool restart();
  /// Whether all blocks were there. Other bytes may follow them, but then the end of the picture.
  [[nodiscard]] bool is_complete() const { return is_segment_complete() && marker_ == kEndOfImage; }

  /// Number of the last coefficient in zigzag order, or a negative number if the data are damaged. Writes the first
  /// coefficient and those that are not 0, in rows.
  int read_block(const HuffmanCode& first, const HuffmanCode& others, std::uint32_t& first_value, Block& block) {
    if (bits_.at > limit_) return -1;
    Bits bits = bits_;  // a local variable stays in registers
    const int last = read_block(first, others, first_value, block, bits);
    bits_ = bits;
    return last;
  }

 private:
  static constexpr std::uint8_t kEndOfImage = 0xd9, kFirstRestart = 0xd0, kRestarts = 8;
  // More than a block has, and eight bytes that are read in advance.
  static constexpr std::size_t kPadding = 64 * HuffmanCode::kMostBits / 8 + 24;
  static constexpr std::array<std::uint8_t, 64> kZigzag{0,  1,  8,  16, 9,  2,  3,  10, 17, 24, 32, 25, 18, 11, 4,  5,
                                                        12, 19, 26, 33, 40, 48, 41, 34, 27, 20, 13, 6,  7,  14, 21, 28,
                                                        35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23, 30, 37, 44, 51,
                                                        58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54, 47, 55, 62, 63};

  struct Bits {
    static constexpr unsigned kLeast = 56;

    const std::uint8_t* at = nullptr;
    std::uint64_t next = 0;  // from the highest bit
    unsigned count = 0;      // of valid bits

    // Fills `next` with at least kLeast bits, without a branch (Giesen, "Reading bits in far too many ways", part 2).
    void refill() {
      std::uint64_t word = 0;
      std::memcpy(&word, at, sizeof(word));
      if constexpr (std::endian::native == std::endian::little) word = __builtin_bswap64(word);
      next |= word >> count;
      at += (63 - count) >> 3;
      count |= kLeast;
    }
    void skip(unsigned bits) {
      next <<= bits;
      count -= bits;
    }
    // Needs kShortBits, and uses no more of them; or refills.
    HuffmanCode::Coefficient take(const HuffmanCode& code) {
      HuffmanCode::Coefficient found = code.find_short(next);
      if (found.bits != 0) {
        skip(found.bits);
        return found;
      }
      refill();
      found = code.find_long(next);
      skip(found.bits);
      refill();
      return found;
    }
  };

  [[gnu::always_inline]] static int read_block(const HuffmanCode& first, const HuffmanCode& others,
                                               std::uint32_t& first_value, Block& block, Bits& bits) {
    bits.refill();
    const HuffmanCode::Coefficient difference = bits.take(first);
    if (difference.bits == 0) return -1;
    first_value += static_cast<std::uint32_t>(difference.value);
    block[0] = static_cast<std::int16_t>(first_value);
    constexpr int kBetweenRefills = 4;
    static_assert((1 + kBetweenRefills) * HuffmanCode::kShortBits <= Bits::kLeast);
    for (unsigned last = 0;; bits.refill()) {
#pragma GCC unroll 4
      for (int i = 0; i < kBetweenRefills; ++i) {
        const HuffmanCode::Coefficient other = bits.take(others);
        if (other.bits == 0) return -1;
        if (other.advance == HuffmanCode::kEndOfBlock) return static_cast<int>(last);
        last += other.advance;
        if (last >= block.size()) return -1;
        block[kZigzag[last]] = other.value;
        if (last == block.size() - 1) return static_cast<int>(last);
      }
    }
  }
  [[nodiscard]] bool is_segment_complete() const {
    return 8 * (bits_.at - bytes_.data()) - static_cast<std::ptrdiff_t>(bits_.count) <=
           8 * (limit_ - 8 - bytes_.data());
  }
  [[nodiscard]] bool read_segment();

  std::span<const std::uint8_t> rest_;  // of the data
  std::vector<std::uint8_t> bytes_;     // of the segment, without the zeros after 0xff
  Bits bits_;
  const std::uint8_t* limit_ = nullptr;  // eight bytes beyond the segment
  std::uint8_t marker_ = 0;              // after the segment
  std::uint8_t restarts_ = 0;
};

}  // namespace touchline::hal
