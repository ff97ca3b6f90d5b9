#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

// Bit masks of the samples around a point: disks, rings, and counts of samples in them.
namespace touchline {

/// Half the size of the square of samples.
constexpr int kSampleReach = 16;
constexpr std::size_t kSampleSide = 2 * kSampleReach + 1;

/// Converts a row or column relative to the middle to an array index.
constexpr std::size_t sample_index(int i) {
  const int from_first = i + kSampleReach;
  return static_cast<std::size_t>(from_first);
}
constexpr std::uint64_t sample_bit(int column) { return std::uint64_t{1} << sample_index(column); }
/// Sets the bits of the columns from -last to last; none if `last` is negative.
constexpr std::uint64_t middle_sample_bits(int last) { return last < 0 ? 0 : 2 * sample_bit(last) - sample_bit(-last); }

/// Counts the bits that are set. (On processors that may lack the instruction, std::popcount would call a function.)
constexpr int count_sample_bits(std::uint64_t bits) {
  bits -= bits >> 1u & 0x5555555555555555u;
  bits = (bits & 0x3333333333333333u) + (bits >> 2u & 0x3333333333333333u);
  return static_cast<int>(((bits + (bits >> 4u)) & 0x0f0f0f0f0f0f0f0fu) * 0x0101010101010101u >> 56u);
}

/// Samples whose distance from a point is in the interval [inner, outer).
class SampleRing {
 public:
  SampleRing(float inner, float outer) : reach(std::min(kSampleReach, static_cast<int>(std::ceil(outer)) - 1)) {
    // Compare squares, because squared distances are integers.
    const int outer2 = static_cast<int>(std::ceil(outer * outer)), inner2 = static_cast<int>(std::ceil(inner * inner));
    int out = reach, in = std::min(reach, static_cast<int>(std::ceil(inner)));
    for (int dv = 0; dv <= reach; ++dv) {
      while (out >= 0 && out * out + dv * dv >= outer2) --out;
      while (in >= 0 && in * in + dv * dv >= inner2) --in;
      const auto row = static_cast<std::size_t>(dv);
      last[row] = out;
      hole[row] = in;
      rows_[row] = middle_sample_bits(out) & ~middle_sample_bits(in);
      count += (dv == 0 ? 1 : 2) * count_sample_bits(rows_[row]);
    }
  }
  /// Returns the ring's columns in row `dv`, relative to a point in `column`.
  [[nodiscard]] std::uint64_t at(int dv, int column) const {
    const std::uint64_t mask = rows_[static_cast<std::size_t>(std::abs(dv))];
    return column >= 0 ? mask << static_cast<unsigned>(column) : mask >> static_cast<unsigned>(-column);
  }

  int reach = 0, count = 0;
  // For each distance of a row from the point, the last column of the ring and the last column of its hole; -1: none.
  std::array<int, kSampleReach + 1> last{}, hole{};

 private:
  std::array<std::uint64_t, kSampleReach + 1> rows_{};
};

/// One bit per sample of the square.
class Samples {
 public:
  [[nodiscard]] std::uint64_t& row(int number) { return rows_[sample_index(number)]; }
  [[nodiscard]] std::uint64_t row(int number) const { return rows_[sample_index(number)]; }

  /// Returns the number of samples in a ring around (column, row).
  [[nodiscard]] int count(const SampleRing& ring, int column, int row) const {
    int sum = 0;
    const int first = std::max(-kSampleReach, row - ring.reach), last = std::min(kSampleReach, row + ring.reach);
    for (int r = first; r <= last; ++r) sum += count_sample_bits(rows_[sample_index(r)] & ring.at(r - row, column));
    return sum;
  }

  /// Returns the samples in a disk around (column, row), and fills holes: samples of the disk that lie between others
  /// both in their row and in their column.
  [[nodiscard]] Samples without_holes(const SampleRing& disk, int column, int row) const {
    Samples out;
    std::array<std::uint64_t, kSampleSide> below{};  // samples below each row or in it
    const int first = std::max(-kSampleReach, row - disk.reach), last = std::min(kSampleReach, row + disk.reach);
    std::uint64_t seen = 0;
    for (int r = last; r >= first; --r) {
      below[sample_index(r)] = seen |= rows_[sample_index(r)] & disk.at(r - row, column);
    }
    seen = 0;
    for (int r = first; r <= last; ++r) {
      const std::uint64_t bits = rows_[sample_index(r)] & disk.at(r - row, column);
      seen |= bits;
      const std::uint64_t within = bits == 0 ? 0 : (std::bit_floor(bits) << 1u) - (bits & (~bits + 1));
      out.row(r) = bits | (within & seen & below[sample_index(r)] & disk.at(r - row, column));
    }
    return out;
  }

 private:
  std::array<std::uint64_t, kSampleSide> rows_{};
};

/// Counts samples around many positions at once.
class SampleSums {
 public:
  /// Counts around 16 neighboring columns, modulo 256.
  using Counts [[gnu::vector_size(16)]] = std::uint8_t;

  /// Prepares the counts of samples that are at most `reach` rows and columns from the middle.
  SampleSums(const Samples& samples, int reach) {
    for (int row = -reach; row <= reach; ++row) {
      std::uint8_t* const sums = &sums_[sample_index(row) * kWidth];
      std::uint64_t bits = samples.row(row);
      std::uint64_t sum = 0;  // running sum, repeated in each byte
      for (std::size_t byte = 0; byte < kWidth; byte += 8, bits >>= 8u) {
        // Spread one bit to each byte, then add up: each byte counts the bits up to its column. The lowest byte is the
        // first column.
        static_assert(std::endian::native == std::endian::little);
        const std::uint64_t spread = ((bits & 0xffu) * kOnes) & 0x8040201008040201u;
        const std::uint64_t ones = (spread + 0x7f7f7f7f7f7f7f7fu) >> 7u & kOnes;
        const std::uint64_t up_to = ones * kOnes + sum;
        std::memcpy(sums + byte, &up_to, sizeof up_to);
        sum = (up_to >> 56u) * kOnes;
      }
    }
  }
  /// Returns the number of samples in a ring around (column + i, row) for i = 0 to 15. The ring must not extend beyond
  /// the reach; otherwise the count is undefined.
  [[nodiscard]] Counts count(const SampleRing& ring, int column, int row) const {
    Counts counts{};
    for (int dv = -ring.reach; dv <= ring.reach; ++dv) {
      const auto distance = static_cast<std::size_t>(std::abs(dv));
      counts += up_to(column + ring.last[distance], row + dv) - up_to(column - ring.last[distance] - 1, row + dv);
      const int hole = ring.hole[distance];
      if (hole >= 0) counts -= up_to(column + hole, row + dv) - up_to(column - hole - 1, row + dv);
    }
    return counts;
  }

 private:
  static constexpr std::uint64_t kOnes = 0x0101010101010101u;
  static constexpr std::size_t kWidth = 40;
  [[nodiscard]] Counts up_to(int column, int row) const {
    Counts counts;
    std::memcpy(&counts, &sums_[sample_index(row) * kWidth + sample_index(column)], sizeof counts);
    return counts;
  }

  // For each row and column, the number of samples up to it in the row. 16 columns are read at a time.
  std::array<std::uint8_t, kSampleSide * kWidth + sizeof(Counts)> sums_{};
};

}  // namespace touchline
