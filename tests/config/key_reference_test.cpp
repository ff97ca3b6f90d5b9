// docs/files.md must list the keys as they are declared.
#include "firmware/config/key_reference.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "firmware/config/board_file.h"
#include "firmware/config/key_list.h"
#include "firmware/config/standard_layouts.h"
#include "firmware/config/team_file.h"
#include "firmware/config/venue_file.h"

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

// A default of a key that must be present would never be used.
template <class File>
void expect_no_default_of_required_keys(const std::string& text) {
  std::size_t required = 0;
  for (const KeyInfo& key : KeyLister::keys_of_file<File>()) {
    if (!key.is_required) continue;
    ++required;
    const std::size_t line = text.find("\n  " + key.path + ": ");
    ASSERT_NE(line, std::string::npos) << key.path;
    const std::string facts = text.substr(line + 1, text.find('\n', line + 1) - line - 1);
    EXPECT_NE(facts.find(", required"), std::string::npos) << facts;
    EXPECT_EQ(facts.find("default"), std::string::npos) << facts;
  }
  EXPECT_EQ(required, File::kRequired.size() + 1) << "version, and those that the reader asks for";
}

TEST(KeyReference, RequiredKeysHaveNoDefault) {
  const std::string text = key_reference_text({}).value();
  expect_no_default_of_required_keys<BoardFile>(text.substr(0, text.find("\nvenue.toml\n")));
  expect_no_default_of_required_keys<VenueFile>(text.substr(text.find("\nvenue.toml\n")));
  expect_no_default_of_required_keys<TeamFile>(text.substr(text.find("\nteam.toml\n")));
  const std::string page = key_reference_markdown();
  EXPECT_NE(page.find("| `width_px` | integer | required | "), std::string::npos);
  EXPECT_NE(page.find("| `low` | list of 3 integers | required | 0 to 255"), std::string::npos);
  EXPECT_NE(page.find("#### [camera]\n\nThe camera. Required.\n"), std::string::npos);
}

TEST(KeyReference, TextForTheTerminalHasTheSameFacts) {
  EXPECT_NE(key_reference_text({}).value().find(
                "  radio.delay_s: number, 0 to 1 s, default 0.02, reload: loop\n      Delay from"),
            std::string::npos);
}

TEST(KeyReference, WordsSelectKeysByFileSectionNameAndMeaning) {
  const auto keys_with = [](const std::vector<std::string>& words) {
    const Result<std::string> text = key_reference_text(words);
    EXPECT_TRUE(text.ok()) << text.text();
    return text.ok() ? text.value() : std::string();
  };
  const std::string exposure = keys_with({"Exposure_US"});
  EXPECT_TRUE(exposure.starts_with("board.toml\n  camera.exposure_us: integer")) << exposure;
  EXPECT_EQ(exposure.find("radio."), std::string::npos) << exposure;
  EXPECT_EQ(exposure.find("venue.toml"), std::string::npos) << "a file without a key is not named";

  const std::string section = keys_with({"radio", "board.toml"});
  EXPECT_NE(section.find("\n  radio: section"), std::string::npos) << section;
  EXPECT_NE(section.find("\n  radio.baud: "), std::string::npos) << section;
  EXPECT_EQ(section.find("\n  camera.exposure_us: "), std::string::npos) << section;

  EXPECT_NE(keys_with({"below", "battery"}).find("  radio.low_battery_v: "), std::string::npos) << "in its meaning";
  const std::string file = keys_with({"team.toml"});
  EXPECT_TRUE(file.starts_with("team.toml\n  version: ")) << file;
  EXPECT_EQ(file.find("venue.toml\n"), std::string::npos) << file;
  EXPECT_TRUE(keys_with({"ssl-butterfly"})
                  .ends_with("standard layouts\n  ssl-butterfly: " +
                             std::string(find_standard_layout("ssl-butterfly")->help) + "\n"));
}

TEST(KeyReference, AWordOfNoKeyIsNamed) {
  const auto error_of = [](const std::vector<std::string>& words) {
    const Result<std::string> text = key_reference_text(words);
    EXPECT_EQ(text.code(), ErrorCode::kNotFound);
    return text.ok() ? std::string() : std::string(text.text());
  };
  EXPECT_EQ(error_of({"camera", "exposre"}),
            "no key has \"exposre\" in its file, section, name or meaning; did you mean \"exposure\"?");
  EXPECT_EQ(error_of({"xyzzy"}), "no key has \"xyzzy\" in its file, section, name or meaning");
  EXPECT_EQ(error_of({"baud", "exposure_us"}), "no key has all of these words: baud exposure_us");
}

}  // namespace
}  // namespace touchline::config
