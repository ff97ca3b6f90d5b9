// The fixed-memory writer gives the bytes of nlohmann's library, which replay files were written with before.
#include "firmware/report/json_writer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

namespace touchline::report {
namespace {

using nlohmann::json;

template <class Write>
std::string written(Write write) {
  std::string text(4096, '\0');
  JsonWriter writer(text);
  write(writer);
  EXPECT_TRUE(writer.fits());
  text.resize(writer.size());
  return text;
}

std::string written_number(double value) {
  return written([&](JsonWriter& writer) { writer.number(value); });
}
std::string written_string(std::string_view value) {
  return written([&](JsonWriter& writer) { writer.string(value); });
}
std::string expected_string(std::string_view value) {
  return json(value).dump(-1, ' ', false, json::error_handler_t::replace);
}

TEST(JsonWriter, WritesNumbersLikeNlohmann) {
  for (const double value : {0.0,
                             -0.0,
                             1.0,
                             -1.0,
                             0.1,
                             1e-4,
                             1e-5,
                             9.9999e-5,
                             123456.0,
                             1e14,
                             1e15,
                             1e16,
                             123456789012345.6,
                             1.5e300,
                             -2.5e-300,
                             1.7e9 + 0.123456,
                             std::numeric_limits<double>::max(),
                             std::numeric_limits<double>::denorm_min(),
                             std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(written_number(value), json(value).dump()) << value;
  }
}

TEST(JsonWriter, WritesRoundedPositionsLikeNlohmann) {
  // Multiples of 0.01 mm up to 5 m.
  for (int i = -500000; i <= 500000; i += 7) {
    const double value = rounded(i * 1e-5, 1e-5);
    ASSERT_EQ(written_number(value), json(value).dump()) << i;
  }
}

TEST(JsonWriter, WritesRoundedPixelsAndTimesLikeNlohmann) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> pixel(-10.0, 3000.0), time(0.0, 2e9);
  for (int i = 0; i < 20000; ++i) {
    const double u = rounded(pixel(random), 1e-3), t = rounded(time(random), 1e-6);
    ASSERT_EQ(written_number(u), json(u).dump());
    ASSERT_EQ(written_number(t), json(t).dump());
  }
}

TEST(JsonWriter, NumbersReadBackAsTheSameDouble) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 100000; ++i) {
    const std::uint64_t bits = random();
    double value = 0.0;
    static_assert(sizeof value == sizeof bits);
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    ASSERT_EQ(json::parse(written_number(value)).get<double>(), value);
  }
}

TEST(JsonWriter, EscapesStringsLikeNlohmann) {
  for (int c = 0; c < 256; ++c) {
    const std::string text = std::string("a") + static_cast<char>(c) + "b";
    EXPECT_EQ(written_string(text), expected_string(text)) << c;
  }
  std::mt19937 random(3);
  // Bytes at the limits of UTF-8's ranges are frequent.
  constexpr std::string_view kBytes =
      "a\x7f\x80\x8f\x90\x9f\xa0\xbf\xc0\xc1\xc2\xdf\xe0\xe1\xed\xee\xef\xf0\xf1\xf4\xf5\xff";
  for (int i = 0; i < 100000; ++i) {
    std::string text;
    for (std::size_t k = random() % 8; k > 0; --k) text += kBytes[random() % kBytes.size()];
    ASSERT_EQ(written_string(text), expected_string(text)) << ::testing::PrintToString(text);
  }
}

TEST(JsonWriter, NestsObjectsAndArrays) {
  EXPECT_EQ(written([](JsonWriter& writer) {
              writer.begin_object();
              writer.key("a");
              writer.begin_array();
              writer.integer(-3);
              writer.begin_object();
              writer.end_object();
              writer.boolean(true);
              writer.end_array();
              writer.key("b\"");
              writer.null();
              writer.end_object();
              writer.line_end();
            }),
            "{\"a\":[-3,{},true],\"b\\\"\":null}\n");
}

TEST(JsonWriter, ReportsWhatDoesNotFit) {
  std::string text(5, '\0');
  JsonWriter exact(text);
  exact.string("abc");
  EXPECT_TRUE(exact.fits());
  EXPECT_EQ(exact.size(), 5u);
  JsonWriter small(std::span<char>(text.data(), 4));
  small.string("abc");
  EXPECT_FALSE(small.fits());
  EXPECT_LE(small.size(), 4u);
}

}  // namespace
}  // namespace touchline::report
