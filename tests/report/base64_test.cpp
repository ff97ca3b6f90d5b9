#include "firmware/report/base64.h"

#include <gtest/gtest.h>

namespace touchline::report {
namespace {

// The vectors of RFC 4648, section 10, and bytes whose digits are + and /.
TEST(Base64, EncodesAndDecodesTheVectorsOfTheRfc) {
  const std::pair<std::string_view, std::string_view> vectors[] = {{"", ""},
                                                                   {"f", "Zg=="},
                                                                   {"fo", "Zm8="},
                                                                   {"foo", "Zm9v"},
                                                                   {"foob", "Zm9vYg=="},
                                                                   {"fooba", "Zm9vYmE="},
                                                                   {"foobar", "Zm9vYmFy"},
                                                                   {"\xff\xfe\xfd", "//79"},
                                                                   {"\xfb\xe0", "++A="}};
  for (const auto& [bytes, text] : vectors) {
    EXPECT_EQ(base64_of(std::as_bytes(std::span(bytes))), text);
    EXPECT_EQ(bytes_of_base64(text), bytes);
  }
}

TEST(Base64, EveryByteComesBack) {
  std::string bytes;
  for (int value = 0; value < 256; ++value) bytes += static_cast<char>(value);
  for (std::size_t first = 0; first < 3; ++first) {
    const std::string part = bytes.substr(first);
    EXPECT_EQ(bytes_of_base64(base64_of(std::as_bytes(std::span(part)))), part);
  }
}

TEST(Base64, DamagedTextIsRefused) {
  for (const std::string_view text :
       {"Z", "Zg=", "Zg", "Z===", "====", "Zg==Zg==", "Zg=x", "Zm9v\n", "Zm9 ", "Zm9-", "Zm9_"}) {
    EXPECT_FALSE(bytes_of_base64(text).has_value()) << text;
  }
}

}  // namespace
}  // namespace touchline::report
