#include "firmware/console/login_link.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace touchline::console {
namespace {

TEST(LoginLink, ACodeIsDrawnInSquares) {
  // 21 modules of the smallest code and a quiet zone of two on each side, two rows in each line of text.
  const std::string code = qr_code("http://a");
  EXPECT_EQ(std::count(code.begin(), code.end(), '\n'), 13);
  EXPECT_TRUE(qr_code(std::string(5000, 'a')).empty());
  EXPECT_NE(login_text("192.0.2.7", 8642, "abc").find("  http://192.0.2.7:8642/login?token=abc\n"), std::string::npos);
}

}  // namespace
}  // namespace touchline::console
