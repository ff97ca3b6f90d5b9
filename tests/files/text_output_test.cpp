#include "hal/files/text_output.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <string>

namespace touchline::hal {
namespace {

using namespace std::chrono_literals;

class TextOutputToAPipe : public ::testing::Test {
 protected:
  TextOutputToAPipe() { EXPECT_EQ(::pipe2(ends_.data(), O_CLOEXEC), 0); }
  ~TextOutputToAPipe() override {
    for (const int end : ends_) ::close(end);
  }
  // Reads at least `bytes`.
  [[nodiscard]] std::string read_at_least(std::size_t bytes) const {
    std::string text;
    std::array<char, 4096> block{};
    while (text.size() < bytes) {
      const ssize_t count = ::read(ends_[0], block.data(), block.size());
      if (count <= 0) break;
      text.append(block.data(), static_cast<std::size_t>(count));
    }
    return text;
  }
  std::array<int, 2> ends_{-1, -1};
};

TEST_F(TextOutputToAPipe, KeepsTheOrderOfBothStreams) {
  TextOutput output(ends_[1], ends_[1]);
  output.print("a\n");
  output.print_error("b\n");
  output.print("c\n");
  EXPECT_TRUE(output.finish(60s));
  EXPECT_EQ(read_at_least(6), "a\nb\nc\n");
}

TEST_F(TextOutputToAPipe, WaitsForNoReader) {
  const std::string line(1000, 'x');
  const auto lines = 3 * TextOutput::kMaxWaitingBytes / line.size();
  TextOutput output(ends_[1], ends_[1]);
  for (std::size_t i = 0; i < lines; ++i) output.print(line);
  EXPECT_FALSE(output.finish(1ms));
  // The reader is back: what waits is written, and what was dropped is counted.
  output.print("last\n");
  std::string text;
  while (!text.ends_with("last\n")) text += read_at_least(1);
  EXPECT_LT(text.size(), TextOutput::kMaxWaitingBytes + (std::size_t{80} << 10)) << "a pipe takes 64 KiB by itself";
  EXPECT_NE(text.find(" messages were dropped because nobody read them\n"), std::string::npos);
  EXPECT_TRUE(output.finish(60s));
}

TEST_F(TextOutputToAPipe, MayEndWhileNobodyReads) {
  {
    TextOutput output(ends_[1], ends_[1]);
    output.print(std::string(TextOutput::kMaxWaitingBytes / 2, 'x'));
    output.print("y");
    EXPECT_FALSE(output.finish(1ms));
  }
  // The thread goes on when the reader is back.
  EXPECT_EQ(read_at_least(TextOutput::kMaxWaitingBytes / 2 + 1).back(), 'y');
}

}  // namespace
}  // namespace touchline::hal
