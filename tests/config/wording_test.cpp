#include "firmware/config/wording.h"

#include <array>

#include <gtest/gtest.h>

namespace touchline::config {
namespace {

TEST(Wording, NumbersHaveTheFewestDigitsThatReadBack) {
  EXPECT_EQ(value_text(0.02135f), "0.02135");
  EXPECT_EQ(value_text(0.1), "0.1");
  EXPECT_EQ(value_text(5.0), "5.0");
  EXPECT_EQ(value_text(1e-7), "1e-07");
  EXPECT_EQ(value_text(std::uint8_t{200}), "200");
  EXPECT_EQ(value_text(-3), "-3");
}

TEST(Wording, Ranges) {
  EXPECT_EQ(range_text({0.0, 0.5}, "m"), "0 to 0.5 m");
  EXPECT_EQ(range_text({.low = 1.0}, "px"), "at least 1 px");
  EXPECT_EQ(range_text({.high = 1.0}, ""), "at most 1");
  EXPECT_EQ(range_text({}, "m"), "");
}

TEST(Wording, NearestWord) {
  constexpr std::array<std::string_view, 3> kWords{"exposure_us", "gain", "width_px"};
  EXPECT_EQ(nearest_word("exposre_us", kWords), "exposure_us");
  EXPECT_EQ(nearest_word("gian", kWords), "gain");
  EXPECT_EQ(nearest_word("gai", kWords), "gain");
  EXPECT_EQ(nearest_word("grin", kWords), "gain");
  EXPECT_EQ(nearest_word("grit", kWords), "");  // two changes in four letters: a different word
  EXPECT_EQ(nearest_word("zoom", kWords), "");
}

TEST(Wording, TomlStringsEscape) { EXPECT_EQ(toml_string("a\"b\\c\n"), "\"a\\\"b\\\\c\\u000A\""); }

}  // namespace
}  // namespace touchline::config
