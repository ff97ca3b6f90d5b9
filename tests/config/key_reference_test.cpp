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
  const Result<std::string> page = updated_key_reference(read.str());
  ASSERT_TRUE(page.ok()) << page.text();
  EXPECT_TRUE(page.value() == read.str()) << "a declaration has changed: run `touchline keys --update docs/files.md`";
}

TEST(KeyReference, ReplacesThePartBetweenItsLines) {
  const std::string old = std::string("above\n") + kReferenceBegin + "old\n" + kReferenceEnd + "below\n";
  const Result<std::string> page = updated_key_reference(old);
  ASSERT_TRUE(page.ok()) << page.text();
  EXPECT_EQ(page.value(),
            std::string("above\n") + kReferenceBegin + key_reference_markdown() + "\n" + kReferenceEnd + "below\n");
  EXPECT_EQ(updated_key_reference("above\n").code(), ErrorCode::kNotFound);
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
