#include "hal/result.h"

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "tools/programs/latency/allocation_counter.h"

namespace touchline {
namespace {

Result<int> positive(int value) {
  if (value > 0) return value;
  return failure(ErrorCode::kOutOfRange, "%d is not positive", value);
}

Result<void> check(int value) {
  TOUCHLINE_TRY(positive(value));
  return {};
}

Result<std::string> doubled(int value) {
  TOUCHLINE_TRY_ASSIGN(const int first, positive(value));
  TOUCHLINE_TRY_ASSIGN(const int second, positive(value));
  return std::to_string(first + second);
}

TEST(Result, HoldsAValueOrAnError) {
  const Result<int> good = positive(3);
  EXPECT_TRUE(good.ok());
  EXPECT_EQ(good.value(), 3);
  EXPECT_EQ(good.code(), ErrorCode::kOk);
  EXPECT_EQ(good.text(), "");

  const Result<int> bad = positive(-3);
  EXPECT_FALSE(bad.ok());
  EXPECT_EQ(bad.code(), ErrorCode::kOutOfRange);
  EXPECT_EQ(bad.text(), "-3 is not positive");
  EXPECT_EQ(bad.error().text, "-3 is not positive");
}

TEST(Result, PassesErrorsOnToOtherTypes) {
  EXPECT_TRUE(check(1).ok());
  EXPECT_EQ(check(0).text(), "0 is not positive");
  EXPECT_EQ(check(0).code(), ErrorCode::kOutOfRange);
  EXPECT_EQ(doubled(4).value(), "8");
  EXPECT_EQ(doubled(-4).text(), "-4 is not positive");
}

TEST(Result, HoldsTypesThatOnlyMoveAndHaveNoDefault) {
  struct OnlyMoves {
    explicit OnlyMoves(int value) : value_(std::make_unique<int>(value)) {}
    std::unique_ptr<int> value_;
  };
  Result<OnlyMoves> result = OnlyMoves(5);
  const OnlyMoves taken = std::move(result).value();
  EXPECT_EQ(*taken.value_, 5);
}

TEST(Result, ErrorsGetContext) {
  EXPECT_EQ(prefixed("venue.toml", failure(ErrorCode::kNotFound, "no such file")).text, "venue.toml: no such file");
}

TEST(ErrorText, StoresLongTextsCompletely) {
  ErrorText text;
  std::string expected;
  for (int i = 0; i < 500; ++i) {
    text.append_format("%s%d", text.separator(), i);
    expected += (i == 0 ? "" : "; ") + std::to_string(i);
  }
  EXPECT_EQ(text, expected);
  EXPECT_EQ(ErrorText(text), expected);

  ErrorText moved = std::move(text);
  EXPECT_EQ(moved, expected);
  EXPECT_TRUE(text.empty());  // NOLINT(bugprone-use-after-move): defined to be empty
  text = moved;
  moved.set("short");
  EXPECT_EQ(moved, "short");
  EXPECT_EQ(text, expected);
  text.truncate(3);
  text.prepend("<");
  EXPECT_EQ(text, "<0; ");
}

TEST(ErrorText, FormatsTextsOfEveryLengthAroundTheInlineCapacity) {
  for (std::size_t length = ErrorText::kInlineCapacity - 2; length < ErrorText::kInlineCapacity + 3; ++length) {
    const std::string expected(length, 'x');
    ErrorText text;
    text.set("%s", expected.c_str());
    EXPECT_EQ(text, expected);
    EXPECT_EQ(text.size(), length);
  }
}

TEST(ErrorText, AllocatesNothingForOneLine) {
  if (!latency::allocations_are_counted()) GTEST_SKIP();
  const std::string line(ErrorText::kInlineCapacity - 20, 'x');
  const auto begin = latency::allocations_of_this_thread();
  Result<void> result = prefixed("camera", failure(ErrorCode::kIo, "%s", line.c_str()));
  const Result<void> copy = result;
  const Result<void> moved = std::move(result);
  EXPECT_EQ(latency::allocations_of_this_thread(), begin);
  EXPECT_EQ(copy.error().text.size(), moved.error().text.size());
  ErrorText longer = copy.error().text;
  longer.append(line);
  EXPECT_GT(latency::allocations_of_this_thread(), begin) << "this test would not notice an allocation";
}

}  // namespace
}  // namespace touchline
