#include "core/region/row_masks.h"

#include <bit>

#include "core/color/load_word.h"

#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace touchline {
namespace {

// differ(a, b) sets bit i if a[i] != b[i], for 64 bytes.

struct Portable {
  static std::uint64_t differ(const std::uint8_t* a, const std::uint8_t* b) {
    constexpr std::uint64_t kLowBits = 0x7f7f7f7f7f7f7f7fu;
    std::uint64_t mask = 0;
    for (std::size_t i = 0; i < kPixelsOfWord; i += 8) {
      const std::uint64_t difference = load_word(a + i) ^ load_word(b + i);
      const std::uint64_t high_bits = (((difference & kLowBits) + kLowBits) | difference) & ~kLowBits;
      // Moves the bit of byte k to bit 56 + k. No two partial products share a bit.
      mask |= ((high_bits >> 7) * 0x0102040810204080u >> 56) << i;
    }
    return mask;
  }
};

void clear(OccupiedWords words, RowMasks& masks) {
  for (; words != 0; words &= words - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(words));
    masks.first[i] = masks.last[i] = masks.like_above[i] = 0;
  }
}

template <class Bytes>
void fill_masks(const ColorRow& row, const ColorRow& above, OccupiedWords occupied, RowMasks& masks) {
  static constexpr std::array<std::uint8_t, kPixelsOfWord> kNone{};
  clear(masks.occupied & ~occupied, masks);
  masks.occupied = occupied;
  masks.is_cut = false;
  for (OccupiedWords words = occupied; words != 0; words &= words - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(words));
    const std::uint8_t* colors = row.pixels() + i * kPixelsOfWord;
    const std::uint64_t colored = Bytes::differ(colors, kNone.data());
    masks.first[i] = colored & Bytes::differ(colors, colors - 1);
    masks.last[i] = colored & Bytes::differ(colors, colors + 1);
    masks.like_above[i] = colored & ~Bytes::differ(colors, above.pixels() + i * kPixelsOfWord);
  }
}

constexpr RowMaskKernel portable_row_mask_kernel = fill_masks<Portable>;

#if defined(__x86_64__)

TOUCHLINE_AVX2_INLINE __m256i load(const ColorId* colors) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(colors));
}
// Sets bit i if a[i] == b[i], for 64 bytes in two registers.
TOUCHLINE_AVX2_INLINE std::uint64_t equal(__m256i a_low, __m256i a_high, __m256i b_low, __m256i b_high) {
  const auto low = static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(a_low, b_low)));
  const auto high = static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(a_high, b_high)));
  return low | std::uint64_t{high} << 32;
}

TOUCHLINE_AVX2 void avx2_row_mask_kernel(const ColorRow& row, const ColorRow& above, OccupiedWords occupied,
                                         RowMasks& masks) {
  const __m256i zero = _mm256_setzero_si256();
  clear(masks.occupied & ~occupied, masks);
  masks.occupied = occupied;
  masks.is_cut = false;
  for (OccupiedWords words = occupied; words != 0; words &= words - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(words));
    const ColorId* colors = row.pixels() + i * kPixelsOfWord;
    const ColorId* upper = above.pixels() + i * kPixelsOfWord;
    const __m256i low = load(colors), high = load(colors + 32);
    const std::uint64_t background = equal(low, high, zero, zero);
    masks.first[i] = ~(background | equal(low, high, load(colors - 1), load(colors + 31)));
    masks.last[i] = ~(background | equal(low, high, load(colors + 1), load(colors + 33)));
    masks.like_above[i] = equal(low, high, load(upper), load(upper + 32)) & ~background;
  }
}

#elif defined(__aarch64__)

struct Neon {
  static std::uint64_t differ(const std::uint8_t* a, const std::uint8_t* b) {
    constexpr std::array<std::uint8_t, 16> kBits = {1, 2, 4, 8, 16, 32, 64, 128, 1, 2, 4, 8, 16, 32, 64, 128};
    const uint8x16_t bits = vld1q_u8(kBits.data());
    uint8x16_t part[4];
    for (std::size_t k = 0; k < 4; ++k) {
      part[k] = vbicq_u8(bits, vceqq_u8(vld1q_u8(a + 16 * k), vld1q_u8(b + 16 * k)));
    }
    // Three pairwise additions combine eight bits to a byte.
    const uint8x16_t bytes = vpaddq_u8(vpaddq_u8(part[0], part[1]), vpaddq_u8(part[2], part[3]));
    return vgetq_lane_u64(vreinterpretq_u64_u8(vpaddq_u8(bytes, bytes)), 0);
  }
};
constexpr RowMaskKernel neon_row_mask_kernel = fill_masks<Neon>;

#endif

}  // namespace

RowMaskKernel row_mask_kernel(KernelChoice kernel) {
  switch (kernel) {
#define TOUCHLINE_SET(family, set, word, features, span_kernel, row_masks, ...) \
  TOUCHLINE_ON_##family(case KernelChoice::set : return row_masks;)
    TOUCHLINE_KERNEL_SETS(TOUCHLINE_SET)
#undef TOUCHLINE_SET
    default:
      return portable_row_mask_kernel;
  }
}

}  // namespace touchline
