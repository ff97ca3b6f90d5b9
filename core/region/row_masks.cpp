#include "core/region/row_masks.h"

#include <bit>

namespace touchline {
namespace {

// Sixteen colors in a vector, which every 64-bit processor supports.
using Bytes [[gnu::vector_size(16)]] = std::uint8_t;
constexpr std::size_t kBytes = sizeof(Bytes);

// Returns the sums of neighboring bytes: first of `a`, then of `b`.
Bytes add_neighbors(Bytes a, Bytes b) {
  return __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30) +
         __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
}

// Sets bit i if a[i] != b[i], for the pixels of a word.
[[gnu::always_inline]] inline std::uint64_t differ(const ColorId* a, const ColorId* b) {
  constexpr Bytes kBits = {1, 2, 4, 8, 16, 32, 64, 128, 1, 2, 4, 8, 16, 32, 64, 128};
  const auto part = [&](std::size_t k) {
    Bytes of_a, of_b;
    std::memcpy(&of_a, a + k * kBytes, kBytes);
    std::memcpy(&of_b, b + k * kBytes, kBytes);
    return reinterpret_cast<Bytes>(of_a != of_b) & kBits;
  };
  // Three rounds of adding neighbors combine eight bits to a byte.
  static_assert(kPixelsOfWord == 4 * kBytes);
  const Bytes bytes = add_neighbors(add_neighbors(part(0), part(1)), add_neighbors(part(2), part(3)));
  return reinterpret_cast<WordPair>(add_neighbors(bytes, bytes))[0];
}

void clear(OccupiedWords words, RowMasks& masks) {
  for (; words != 0; words &= words - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(words));
    masks.first[i] = masks.last[i] = masks.like_above[i] = 0;
  }
}

}  // namespace

void fill_masks(const ColorRow& row, const ColorRow& above, OccupiedWords occupied, RowMasks& masks) {
  static constexpr std::array<ColorId, kPixelsOfWord> kNone{};
  clear(masks.occupied & ~occupied, masks);
  masks.occupied = occupied;
  masks.is_cut = false;
  for (OccupiedWords words = occupied; words != 0; words &= words - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(words));
    const ColorId* colors = row.pixels() + i * kPixelsOfWord;
    const std::uint64_t colored = differ(colors, kNone.data());
    masks.first[i] = colored & differ(colors, colors - 1);
    masks.last[i] = colored & differ(colors, colors + 1);
    masks.like_above[i] = colored & ~differ(colors, above.pixels() + i * kPixelsOfWord);
  }
}

}  // namespace touchline
