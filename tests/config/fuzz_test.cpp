// Randomly damaged files: each is accepted, or rejected with a message; none crashes the program.
#include <random>

#include "tests/config/config_files.h"

namespace touchline::config {
namespace {

std::string damaged(std::string text, std::mt19937& random) {
  static constexpr std::string_view kPieces[] = {"[",    "]", "\"", "=",  "\n", "-",  "1e999", "nan",
                                                 "[[",   "{", "0x", "''", ".",  "\0", "true",  "99999999999999999999",
                                                 "\xff", "#"};
  const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (std::size_t i = 0, edits = 1 + pick(2); i < edits && !text.empty(); ++i) {
    const std::size_t at = pick(text.size());
    switch (pick(5)) {
      case 0:
        text.erase(at, 1 + pick(20));
        break;
      case 1:
        text.insert(at, kPieces[pick(std::size(kPieces))]);
        break;
      case 2:
        text[at] = static_cast<char>(random());
        break;
      case 3:
        for (char& c : text) {
          if (c >= '0' && c <= '9' && pick(20) == 0) c = static_cast<char>('0' + pick(10));
        }
        break;
      default:
        text.insert(at, text.substr(pick(text.size()), pick(60)));
        break;
    }
  }
  return text;
}

TEST_F(ConfigFiles, DamagedFilesAreAcceptedOrRejectedWithAMessage) {
  std::mt19937 random(1);
  std::size_t refused = 0;
  constexpr int kFiles = 1000;
  for (int i = 0; i < kFiles; ++i) {
    const std::string name = i % 3 == 0 ? "board.toml" : i % 3 == 1 ? "venue.toml" : "team.toml";
    const std::string sound = read(path(name));
    write(name, damaged(sound, random));
    const bool ok = load().ok();
    EXPECT_EQ(ok, errors().empty()) << read(path(name));
    refused += ok ? 0 : 1;
    write(name, sound);
  }
  // Both must happen often; otherwise the damage is too small or too large.
  EXPECT_GT(refused, kFiles / 2U);
  EXPECT_LT(refused, kFiles - kFiles / 50U);
}

}  // namespace
}  // namespace touchline::config
