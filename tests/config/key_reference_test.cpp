// docs/files.md must list the keys as they are declared.
#include "firmware/config/key_reference.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace touchline::config {
namespace {

TEST(KeyReference, DocsFilesIsUpToDate) {
  std::ostringstream read;
  read << std::ifstream(TOUCHLINE_SOURCE_DIR "/docs/files.md").rdbuf();
  std::string page = read.str();
  ASSERT_TRUE(update_key_reference(page).ok()) << "the lines around the reference are missing";
  EXPECT_TRUE(page == read.str()) << "a declaration has changed: run `touchline keys --update docs/files.md`";
}

TEST(KeyReference, ReplacesThePartBetweenItsLines) {
  std::string page = std::string("above\n") + kReferenceBegin + "old\n" + kReferenceEnd + "below\n";
  ASSERT_TRUE(update_key_reference(page).ok());
  EXPECT_EQ(page,
            std::string("above\n") + kReferenceBegin + key_reference_markdown() + "\n" + kReferenceEnd + "below\n");
  std::string without = "above\n";
  EXPECT_EQ(update_key_reference(without).code(), ErrorCode::kNotFound);
}

TEST(KeyReference, HasARowForEachKeyInTheTableOfItsSection) {
  const std::string text = key_reference_markdown();
  const std::size_t radio = text.find("#### [radio]\n");
  ASSERT_NE(radio, std::string::npos);
  const std::string row = "| `delay_s` | number | `0.02` | 0 to 1 s | loop | ";
  const std::size_t found = text.find(row, radio);
  ASSERT_NE(found, std::string::npos);
  EXPECT_LT(found, text.find("####", radio + 4));
  EXPECT_NE(text.find("#### [[color.box]]\n"), std::string::npos);
}

TEST(KeyReference, TextForTheTerminalHasTheSameFacts) {
  EXPECT_NE(
      key_reference_text().find("  radio.delay_s: number, 0 to 1 s, default 0.02, reload: loop\n      Delay from"),
      std::string::npos);
}

}  // namespace
}  // namespace touchline::config
