#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/color/row_classifier.h"
#include "core/types.h"

namespace touchline {

// Pixel u has bit u % 64 of word u / 64.
constexpr std::size_t kPixelsOfWord = kOccupiedWordPixels;
constexpr std::size_t kMaxRowWords = (kMaxFrameWidth + kPixelsOfWord - 1) / kPixelsOfWord;

// Two words in a vector, which every 64-bit processor with vectors supports.
using WordPair [[gnu::vector_size(16)]] = std::uint64_t;
constexpr std::size_t kWordsOfPair = 2;

/// One bit per pixel, followed by zeros, so that pairs of words can be read.
class PixelBits {
 public:
  std::uint64_t& operator[](std::size_t i) { return words_[i]; }
  const std::uint64_t& operator[](std::size_t i) const { return words_[i]; }
  /// Returns words i and i + 1.
  [[nodiscard]] WordPair pair(std::size_t i) const {
    WordPair words;
    std::memcpy(&words, words_.data() + i, sizeof words);
    return words;
  }
  void set_pair(std::size_t i, WordPair words) { std::memcpy(words_.data() + i, &words, sizeof words); }

 private:
  std::array<std::uint64_t, (kMaxRowWords + kWordsOfPair - 1) / kWordsOfPair * kWordsOfPair> words_{};
};

/// First and last pixels of the runs of a row. Both masks have the same number of bits; the n-th bits belong to run n.
struct RowMasks {
  PixelBits first, last;       // pixels that are the first, or last, of a run
  PixelBits like_above;        // pixels of a run whose upper neighbor has their color
  OccupiedWords occupied = 0;  // words with runs; all others are zero
  bool is_cut = false;         // runs were removed, and `inside` has the pixels of the remaining runs
  PixelBits inside;
  PixelBits removed_like_above;  // removed pixels whose upper neighbor has their color, if the row is cut
};

/// A row of colors with background on both sides, so that whole words and the neighbors of all pixels can be read.
class ColorRow {
 public:
  /// Returns the row's first pixel.
  ColorId* pixels() { return colors_.data() + kPixelsOfWord; }
  [[nodiscard]] const ColorId* pixels() const { return colors_.data() + kPixelsOfWord; }

 private:
  std::array<ColorId, (kMaxRowWords + 2) * kPixelsOfWord> colors_{};
};

/// Fills the masks. Words that are not in `occupied` contain no color.
void fill_masks(const ColorRow& row, const ColorRow& above, OccupiedWords occupied, RowMasks& masks);

}  // namespace touchline
