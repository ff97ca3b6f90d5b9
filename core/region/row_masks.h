#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/color/row_classifier.h"
#include "core/types.h"

namespace touchline {

// A pixel's bit: bit u % 64 of word u / 64.
constexpr std::size_t kPixelsOfWord = kOccupiedWordPixels;
constexpr std::size_t kMaxRowWords = (kMaxFrameWidth + kPixelsOfWord - 1) / kPixelsOfWord;

// Two words at once, as every 64-bit processor with vectors can take them.
using WordPair [[gnu::vector_size(16)]] = std::uint64_t;
constexpr std::size_t kWordsOfPair = 2;

// What a row's words are rounded up to, at the most, where several are taken at once.
constexpr std::size_t kMaxWordsAtOnce = 8;

/// A bit a pixel, and zeros after the last so that groups of up to kMaxWordsAtOnce words can be read.
class PixelBits {
 public:
  std::uint64_t& operator[](std::size_t i) { return words_[i]; }
  const std::uint64_t& operator[](std::size_t i) const { return words_[i]; }
  /// Words i and i + 1.
  [[nodiscard]] WordPair pair(std::size_t i) const {
    WordPair words;
    std::memcpy(&words, words_.data() + i, sizeof words);
    return words;
  }
  void set_pair(std::size_t i, WordPair words) { std::memcpy(words_.data() + i, &words, sizeof words); }

 private:
  std::array<std::uint64_t, (kMaxRowWords + kMaxWordsAtOnce - 1) / kMaxWordsAtOnce * kMaxWordsAtOnce> words_{};
};

/// Where a row's runs begin and end. Both have the same number of bits, and the n-th of each belongs to the n-th run.
struct RowMasks {
  PixelBits first, last;       // pixels that are the first, or last, of a run
  PixelBits like_above;        // pixels of a run whose upper neighbor has their color
  OccupiedWords occupied = 0;  // all other words are zero
  bool is_cut = false;         // runs were taken out; `inside` are the pixels of those that are left
  PixelBits inside;
};

/// A row of colors with background around it, so that whole words and the neighbors of all pixels can be read.
class ColorRow {
 public:
  void clear() { colors_.fill(kBackground); }
  /// The row's first pixel.
  ColorId* pixels() { return colors_.data() + kPixelsOfWord; }
  [[nodiscard]] const ColorId* pixels() const { return colors_.data() + kPixelsOfWord; }

 private:
  std::array<ColorId, (kMaxRowWords + 2) * kPixelsOfWord> colors_{};
};

/// Fills the masks. Words that are not in `occupied` have no color.
using RowMasker = void (*)(const ColorRow& row, const ColorRow& above, OccupiedWords occupied, RowMasks& masks);

/// The one that goes with the color kernel, which this processor has. All give the same masks.
RowMasker row_masker(KernelChoice kernel);

}  // namespace touchline
