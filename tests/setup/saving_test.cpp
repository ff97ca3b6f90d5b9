#include <gtest/gtest.h>

#include <filesystem>
#include <memory>

#include "tests/results.h"
#include "tests/tools/program_folder.h"
#include "tools/programs/setup/saving.h"
#include "tools/programs/setup/setup_archive.h"
#include "tools/programs/setup/unified_difference.h"

namespace touchline::setup {
namespace {

class Saving : public touchline::testing::ProgramFolder {
 protected:
  static SetupFiles files(const std::string& name) {
    SetupFiles out{"board.toml", "venue.toml", "team.toml", {}};
    const auto add = [&](const char* file, const std::string& text) {
      out.content[file] = std::make_shared<const std::string>(text);
    };
    add("board.toml", "name = \"" + name + "\"\nvenue = \"venue.toml\"\nteam = \"team.toml\"\n");
    add("venue.toml", "[light]\nmap = \"venue-light.png\"\n");
    add("venue-light.png", std::string("\x89PNG\0\xff\x00\x01", 8) + name);
    return out;
  }
};

TEST_F(Saving, FinishesAnInterruptedSave) {
  const SetupFiles before = files("before"), after = files("after");
  ASSERT_OK(write_folder(before, path("etc")));
  write("saving.json", archive_of(after));
  ASSERT_OK(finish_saving(path("etc"), path("saving.json")));
  ASSERT_OK_AND_ASSIGN(const SetupFiles now, read_setup(path("etc/board.toml")));
  EXPECT_TRUE(changed_files(now, after).empty());
  EXPECT_FALSE(std::filesystem::exists(path("saving.json")));
  ASSERT_OK(finish_saving(path("etc"), path("saving.json")));  // nothing to do
  write("saving.json", "{\"half\": ");
  EXPECT_FALSE(finish_saving(path("etc"), path("saving.json")).ok());
  EXPECT_FALSE(std::filesystem::exists(path("saving.json")));
}

TEST_F(Saving, ANewPictureGetsAnotherNameThanTheSavedOne) {
  const SetupFiles saved = files("saved");
  SetupFiles draft = files("draft");
  ASSERT_OK(keep_saved_pictures(saved, draft));
  EXPECT_EQ(draft.text("venue-light-2.png"), files("draft").text("venue-light.png"));
  EXPECT_EQ(draft.content.count("venue-light.png"), 0u);
  EXPECT_NE(draft.text("venue.toml").find("venue-light-2.png"), std::string::npos);
  SetupFiles same = files("saved");
  ASSERT_OK(keep_saved_pictures(saved, same));
  EXPECT_EQ(same.content.count("venue-light.png"), 1u);
}

TEST_F(Saving, AnArchiveKeepsEveryByte) {
  const SetupFiles original = files("x");
  ASSERT_OK_AND_ASSIGN(const SetupFiles read, read_archive(archive_of(original)));
  EXPECT_TRUE(changed_files(original, read).empty());
  EXPECT_EQ(read.venue, "venue.toml");
}

// As `diff -u` prints it.
TEST(UnifiedDifference, HasThreeLinesOfContext) {
  EXPECT_EQ(unified_difference("a", "1\n2\n", "1\n2\n"), "");
  EXPECT_EQ(unified_difference("a", "", "1\n"), "--- a\n+++ a\n@@ -0,0 +1,1 @@\n+1\n");
  EXPECT_EQ(unified_difference("a", "1\n2\n3\n4\n5\n6\n7\n8\n9\n", "1\n2\n3\n4\nfive\n6\n7\n8\n9\n"),
            "--- a\n+++ a\n@@ -2,7 +2,7 @@\n 2\n 3\n 4\n-5\n+five\n 6\n 7\n 8\n");
  EXPECT_EQ(unified_difference("a", "1\n2\n3\n4\n5\n6\n7\n8\n9\n10\n", "0\n2\n3\n4\n5\n6\n7\n8\n9\n10"),
            "--- a\n+++ a\n@@ -1,4 +1,4 @@\n-1\n+0\n 2\n 3\n 4\n@@ -7,4 +7,4 @@\n 7\n 8\n 9\n-10\n+10\n"
            "\\ No newline at end of file\n");
}

}  // namespace
}  // namespace touchline::setup
