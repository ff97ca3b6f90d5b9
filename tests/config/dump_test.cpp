// A dump reads back as the same values, and every key has a description.
#include "firmware/config/key_list.h"
#include "firmware/config/toml_writer.h"
#include "tests/config/config_files.h"

namespace touchline::config {
namespace {

TEST_F(ConfigFiles, DumpReadsBackAsTheSameFiles) {
  ASSERT_TRUE(load({"camera.device=a \"quoted\"\\ name", "field.margin_m=0.123", "radio.delay_s=1e-05"}).ok())
      << errors();
  const std::string board = TomlWriter::text_of(configuration_->board);
  const std::string venue = TomlWriter::text_of(configuration_->venue);
  const std::string team = TomlWriter::text_of(configuration_->team);
  write("board.toml", board);
  write("venue.toml", venue);
  write("team.toml", team);
  ASSERT_TRUE(load().ok()) << errors();
  EXPECT_EQ(configuration_->board.camera.device, "a \"quoted\"\\ name");
  EXPECT_EQ(TomlWriter::text_of(configuration_->board), board);
  EXPECT_EQ(TomlWriter::text_of(configuration_->venue), venue);
  EXPECT_EQ(TomlWriter::text_of(configuration_->team), team);
}

TEST_F(ConfigFiles, DumpContainsUnitRangeAndMeaning) {
  ASSERT_TRUE(load().ok()) << errors();
  const std::string text = dump(*configuration_);
  EXPECT_NE(text.find("\n[camera]\n"), std::string::npos);
  EXPECT_NE(text.find("exposure_us = 5000                  # Exposure time, at most the time of a picture; 0: not set, "
                      "else at least 10 (0 to 1000000 us)\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("\n[[own.robot]]\nid = 1"), std::string::npos) << text;
  EXPECT_NE(text.find("backend = \"none\""), std::string::npos);
}

TEST(KeyList, EveryKeyHasADescription) {
  std::size_t count = 0;
  for (const auto& keys :
       {KeyLister::keys_of<BoardFile>(), KeyLister::keys_of<VenueFile>(), KeyLister::keys_of<TeamFile>()}) {
    for (const KeyInfo& key : keys) {
      EXPECT_FALSE(key.help.empty()) << key.path;
      EXPECT_FALSE(key.type.empty()) << key.path;
      ++count;
    }
  }
  EXPECT_GT(count, 80U);
}

TEST(KeyList, ListsDefaultsRangesAndElements) {
  const auto find = [](const std::vector<KeyInfo>& keys, const std::string& path) {
    for (const KeyInfo& key : keys) {
      if (key.path == path) return key;
    }
    return KeyInfo{};
  };
  const KeyInfo baud = find(KeyLister::keys_of<BoardFile>(), "radio.baud");
  EXPECT_EQ(baud.type, "integer");
  EXPECT_EQ(baud.limits, "1200 to 4000000 Bd");
  EXPECT_EQ(baud.initial, "115200");
  const KeyInfo low = find(KeyLister::keys_of<VenueFile>(), "color[].box[].low");
  EXPECT_EQ(low.type, "list of 3 integers");
  EXPECT_EQ(low.limits, "0 to 255");
}

}  // namespace
}  // namespace touchline::config
