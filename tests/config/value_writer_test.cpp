// Replacing one value keeps the user's comments.
#include "firmware/config/value_writer.h"

#include <gtest/gtest.h>

#include "tests/results.h"

namespace touchline::config {
namespace {

std::string replaced(const std::string& text, const std::string& table, const std::string& key,
                     const std::string& value) {
  const Result<std::string> out = replace_value(text, table, key, value);
  EXPECT_TRUE(out.ok()) << out.text();
  return out.ok() ? out.value() : std::string();
}

constexpr const char* kCommentedBoard =
    "# hall A\nversion = 1\n\n# the camera\n[camera]  # left one\nexposure_us = 5000   # bright lamps\n# why not 0?\n"
    "gain = 3\n\n# radio\n[radio]\ndevice = \"/dev/\xC3\xA4\" # \xC3\xA4\nbaud = 9600\n";

TEST(ValueWriter, ReplacesAValueAndNothingElse) {
  const std::string text = kCommentedBoard;
  std::string expected = text;
  expected.replace(expected.find("5000   #"), 8, "250    #");
  EXPECT_EQ(replaced(text, "camera", "exposure_us", "250"), expected) << "the comment keeps its column";
  expected.replace(expected.find("250    #"), 8, "1000000 #");
  EXPECT_EQ(replaced(text, "camera", "exposure_us", "1000000"), expected);
  EXPECT_NE(replaced(text, "radio", "device", "\"x\"").find("device = \"x\"       # \xC3\xA4\nbaud"),
            std::string::npos);
  EXPECT_NE(replaced(text, "", "version", "2").find("# hall A\nversion = 2\n\n# the camera"), std::string::npos);
}

TEST(ValueWriter, AddsAndRemovesAKey) {
  const std::string text = kCommentedBoard;
  EXPECT_NE(replaced(text, "camera", "rate_hz", "60").find("gain = 3\nrate_hz = 60\n\n# radio\n"), std::string::npos);
  EXPECT_NE(replaced(text, "", "name", "\"x\"").find("version = 1\nname = \"x\"\n\n# the camera"), std::string::npos);
  EXPECT_NE(replaced(text, "faults", "stop_after_s", "0.3").find("baud = 9600\n\n[faults]\nstop_after_s = 0.3\n"),
            std::string::npos);
  EXPECT_NE(replaced(text, "camera", "gain", "").find("# why not 0?\n\n# radio\n"), std::string::npos);
  EXPECT_EQ(replaced(text, "camera", "rate_hz", ""), text);
  EXPECT_EQ(replaced("[a]\nx = 1", "a", "y", "2"), "[a]\nx = 1\ny = 2\n");
  EXPECT_EQ(replaced("[a]\r\nx = 1\r\n", "a", "y", "2"), "[a]\r\nx = 1\r\ny = 2\r\n");
}

TEST(ValueWriter, ValuesOfSeveralLinesAndInnerTables) {
  EXPECT_EQ(replaced("[a]\nx = [1, # one\n  2]\n[a.b]\ny = 1\n[[a.c]]\nz = 1\n", "a", "x", "[3]"),
            "[a]\nx = [3]\n[a.b]\ny = 1\n[[a.c]]\nz = 1\n");
  EXPECT_EQ(replaced("[a]\nx = 1\n[a.b]\ny = 1\n[[a.c]]\nz = 1\n", "a.b", "y", "7"),
            "[a]\nx = 1\n[a.b]\ny = 7\n[[a.c]]\nz = 1\n");
  EXPECT_EQ(replaced("[[a]]\nz = 1\n[[a]]\nz = 2\n", "a[1]", "z", "5"), "[[a]]\nz = 1\n[[a]]\nz = 5\n");
  EXPECT_EQ(replaced("a = { x = 1, y = 2 }\n", "a", "x", "4"), "a = { x = 4, y = 2 }\n");
}

TEST(ValueWriter, RefusesWhatItCannotEdit) {
  for (const auto& [text, value] : {std::pair("a = { x = 1 }\n", ""),
                                    {"a = {}\n", "2"},
                                    {"a =\n", "2"},
                                    {"[a]\nx = 1\n", "2\nq = 3"},
                                    {"[a]\nx = 1\n", "\""}}) {
    EXPECT_FALSE(replace_value(text, "a", "x", value).ok()) << text << value;
  }
}

}  // namespace
}  // namespace touchline::config
