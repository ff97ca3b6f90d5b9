#pragma once

#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "hal/result.h"

// Checks of functions that return a Result.

#define EXPECT_OK(expression)                                      \
  do {                                                             \
    const auto touchline_result = (expression);                    \
    EXPECT_TRUE(touchline_result.ok()) << touchline_result.text(); \
  } while (false)

#define ASSERT_OK(expression)                                      \
  do {                                                             \
    const auto touchline_result = (expression);                    \
    ASSERT_TRUE(touchline_result.ok()) << touchline_result.text(); \
  } while (false)

/// Also assigns the value to `target`: ASSERT_OK_AND_ASSIGN(const hal::Picture picture, hal::read_picture(path));
#define ASSERT_OK_AND_ASSIGN(target, expression) \
  ASSERT_OK_AND_ASSIGN_AS(TOUCHLINE_JOINED(touchline_result_, __LINE__), target, expression)
// NOLINTBEGIN(bugprone-macro-parentheses): `result` and `target` are declared here.
#define ASSERT_OK_AND_ASSIGN_AS(result, target, expression) \
  auto result = (expression);                               \
  ASSERT_TRUE(result.ok()) << result.text();                \
  target = std::move(result).value()
// NOLINTEND(bugprone-macro-parentheses)

namespace touchline {

/// `result` must be an error with this code and this message.
template <class T>
void expect_error(const Result<T>& result, ErrorCode code, const std::string& text) {
  EXPECT_EQ(describe(result.code()), std::string(describe(code)));
  EXPECT_EQ(result.text(), text);
}

}  // namespace touchline
