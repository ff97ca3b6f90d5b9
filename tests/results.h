#pragma once

#include <string>

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

namespace touchline {

/// `result` must be an error with this code and this message.
template <class T>
void expect_error(const Result<T>& result, ErrorCode code, const std::string& text) {
  EXPECT_EQ(describe(result.code()), std::string(describe(code)));
  EXPECT_EQ(result.text(), text);
}

}  // namespace touchline
