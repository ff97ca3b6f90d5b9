// Names of constants use the field's words for limits: kMax and kMin, not kMost, kLeast or kFewest.
#include <gtest/gtest.h>

#include <regex>

#include "tests/checks/inclusion_rule.h"

namespace touchline::checks {
namespace {

// Returns the first name of a file that the rule forbids; empty: none.
std::string forbidden_name(const std::string& text) {
  static const std::regex forbidden(R"(\bk(Most|Least|Fewest)([A-Z_]\w*)?\b)");
  std::smatch found;
  return std::regex_search(text, found, forbidden) ? found.str() : "";
}

TEST(NameRule, LimitsAreCalledMaxAndMin) {
  for (const SourceFile& file : read_sources(TOUCHLINE_SOURCE_DIR)) {
    if (file.path.ends_with("name_rule_test.cpp")) continue;
    EXPECT_EQ(forbidden_name(file.text), "") << file.path << ": say kMax or kMin";
  }
}

TEST(NameRule, FindsPlantedNames) {
  EXPECT_EQ(forbidden_name("constexpr float kMostUnnamed = 0.99f;"), "kMostUnnamed");
  EXPECT_EQ(forbidden_name("x < kLeast"), "kLeast");
  EXPECT_EQ(forbidden_name("kFewestBytes"), "kFewestBytes");
  EXPECT_EQ(forbidden_name("-kMost_mps"), "kMost_mps");
  EXPECT_EQ(forbidden_name("kMostlyFlat, kMaxRows, at_least"), "");
}

}  // namespace
}  // namespace touchline::checks
