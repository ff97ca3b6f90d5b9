#include "core/color/run_extraction.h"

#include <bit>

#include "core/color/load_word.h"

namespace touchline {

static_assert(std::endian::native == std::endian::little, "the lowest byte of a word is the leftmost pixel");

std::size_t extract_runs(const ColorId* colors, std::uint16_t begin, std::uint16_t end, std::uint16_t row, Run* out) {
  std::size_t count = 0;
  std::uint32_t u = begin;
  while (u < end) {
    const std::uint64_t word = load_word(colors + u);
    if (word == 0) {
      u += 8;
      continue;
    }
    u += static_cast<std::uint32_t>(std::countr_zero(word)) / 8;
    const std::uint32_t first = u;
    const ColorId color = colors[first];
    do {
      ++u;
    } while (colors[u] == color);
    Run& run = out[count++];
    run.row = row;
    run.begin = static_cast<std::uint16_t>(first);
    run.end = static_cast<std::uint16_t>(u);
    run.color = color;
  }
  return count;
}

std::size_t count_runs(const ColorId* colors, std::uint16_t begin, std::uint16_t end) {
  std::size_t count = 0;
  ColorId left = kBackground;
  for (std::uint32_t u = begin; u < end; ++u) {
    count += colors[u] != kBackground && colors[u] != left ? 1u : 0u;
    left = colors[u];
  }
  return count;
}

}  // namespace touchline
