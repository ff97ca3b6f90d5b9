// A short version of the fuzz targets with fixed random numbers: truncated, random and mutated inputs.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/fuzz/decoder_checks.h"

namespace touchline::fuzz {
namespace {

class DamagedInput : public ::testing::TestWithParam<DecoderCheck> {
 protected:
  static void check(const std::string& text) {
    // Inputs are on the heap without free bytes after them, so that the address sanitizer finds reads beyond the end.
    const std::vector<char> copy(text.begin(), text.end());
    GetParam().check(std::as_bytes(std::span<const char>(copy)));
  }
  std::size_t pick(std::size_t n) { return static_cast<std::size_t>(random_() % n); }
  char any_byte() { return static_cast<char>(random_() % 256); }

  std::mt19937 random_{1};
};

TEST_P(DamagedInput, TruncatedAtEveryLength) {
  for (const std::string& seed : GetParam().seeds()) {
    for (std::size_t size = 0; size <= seed.size(); ++size) check(seed.substr(0, size));
  }
}

TEST_P(DamagedInput, RandomBytes) {
  for (int i = 0; i < GetParam().inputs; ++i) {
    std::string text(pick(300), '\0');
    for (char& c : text) c = any_byte();
    check(text);
  }
}

TEST_P(DamagedInput, Mutated) {
  const std::vector<std::string> seeds = GetParam().seeds();
  for (int i = 0; i < GetParam().inputs; ++i) {
    std::string text = seeds[pick(seeds.size())];
    for (std::size_t edits = 1 + pick(4); edits > 0 && !text.empty(); --edits) {
      const std::size_t at = pick(text.size());
      switch (pick(5)) {
        case 0:
          text[at] = any_byte();
          break;
        case 1:
          text[at] = static_cast<char>(text[at] ^ (1 << pick(8)));
          break;
        case 2:
          text.erase(at, 1 + pick(8));
          break;
        case 3:
          text.insert(at, text.substr(pick(text.size()), pick(40)));
          break;
        default:
          text.insert(at, 1, any_byte());
          break;
      }
    }
    check(text);
  }
}

TEST_P(DamagedInput, TheLargestDatagrams) {
  for (const char fill : {'\0', '\n', '[', '{', ' ', '\x7f', '\xff'}) check(std::string(65507, fill));
  for (const std::string& seed : GetParam().seeds()) {
    std::string text;
    while (text.size() + seed.size() <= 65507) text += seed;
    check(text);
  }
}

INSTANTIATE_TEST_SUITE_P(Decoders, DamagedInput, ::testing::ValuesIn(decoder_checks().begin(), decoder_checks().end()),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace touchline::fuzz
