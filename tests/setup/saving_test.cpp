#include <gtest/gtest.h>
#include <sys/mount.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include "tests/results.h"
#include "tests/setup/small_disk.h"
#include "tests/tools/program_folder.h"
#include "tools/programs/setup/saving.h"
#include "tools/programs/setup/setup_archive.h"
#include "tools/programs/setup/unified_difference.h"

namespace touchline::setup {
namespace {

constexpr std::size_t kPageBytes = 4096, kDiskPages = 64;

// Fills the disk until `pages` are free.
void leave_free(const std::string& ballast, std::size_t pages) {
  std::filesystem::remove(ballast);
  const std::filesystem::space_info space = std::filesystem::space(std::filesystem::path(ballast).parent_path());
  ASSERT_GE(space.available, pages * kPageBytes);
  std::ofstream(ballast) << std::string(space.available - pages * kPageBytes, 'x');
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

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

// Each file has several pages, so different amounts of free space let the disk become full at different files, backups
// or journals.
void save_on_a_disk_that_is_full(const std::string& folder, SetupFiles before, SetupFiles after) {
  const std::string etc = folder + "/etc", ballast = folder + "/ballast";
  std::filesystem::create_directory(etc);
  for (SetupFiles* files : {&before, &after}) {
    for (auto& [name, content] : files->content) {
      content = std::make_shared<const std::string>(*content + "# " + std::string(2 * kPageBytes, name[0]) + "\n");
    }
  }
  ASSERT_OK(write_folder(before, etc));
  const std::vector<std::string> names = {"board.toml", "venue.toml", "venue-light.png"};
  std::size_t free_pages = 0;
  for (; free_pages < kDiskPages; ++free_pages) {
    SCOPED_TRACE(free_pages);
    leave_free(ballast, free_pages);
    const Result<void> saved = save_files(after, names, etc, folder + "/saving.json");
    ASSERT_OK_AND_ASSIGN(const SetupFiles now, read_setup(etc + "/board.toml"));
    EXPECT_FALSE(std::filesystem::exists(folder + "/saving.json"));
    if (saved.ok()) {
      EXPECT_TRUE(changed_files(now, after).empty());
      break;
    }
    EXPECT_NE(saved.text().find("No space left on device"), std::string::npos) << saved.text();
    EXPECT_TRUE(changed_files(now, before).empty());
    for (const std::string& name : names_in(etc)) {
      const std::string whose = name.ends_with(".bak") ? name.substr(0, name.size() - 4) : name;
      EXPECT_EQ(before.content.count(whose), 1u) << name << " is left over";
    }
  }
  // Three new files and the journal of three pages each at the least.
  EXPECT_GT(free_pages, 12u);
  EXPECT_LT(free_pages, kDiskPages);
}

TEST_F(Saving, AFullDiskChangesNothing) {
  std::filesystem::create_directory(path("disk"));
  const bool is_permitted = on_small_disk(path("disk"), kDiskPages * kPageBytes, [this] {
    save_on_a_disk_that_is_full(path("disk"), files("before"), files("after"));
  });
  if (!is_permitted) GTEST_SKIP() << "mount namespaces are not permitted here";
}

// The kernel refuses to rename over a file on which another one is mounted. The picture before it is replaced already.
void save_over_a_file_that_cannot_be_replaced(const std::string& folder, const SetupFiles& before,
                                              const SetupFiles& after) {
  const std::string etc = folder + "/etc", busy = etc + "/venue.toml", copy = folder + "/venue.toml";
  std::filesystem::create_directory(etc);
  ASSERT_OK(write_folder(before, etc));
  std::filesystem::copy_file(busy, copy);
  ASSERT_EQ(::mount(copy.c_str(), busy.c_str(), nullptr, MS_BIND, nullptr), 0);
  const Result<void> saved =
      save_files(after, {"board.toml", "venue.toml", "venue-light.png"}, etc, folder + "/saving.json");
  EXPECT_NE(saved.text().find("venue.toml: cannot be replaced"), std::string::npos) << saved.text();
  ASSERT_OK_AND_ASSIGN(const SetupFiles now, read_setup(etc + "/board.toml"));
  EXPECT_TRUE(changed_files(now, before).empty());
  EXPECT_FALSE(std::filesystem::exists(folder + "/saving.json"));
}

TEST_F(Saving, AFileThatCannotBeReplacedChangesNothing) {
  std::filesystem::create_directory(path("disk"));
  const bool is_permitted = on_small_disk(path("disk"), kDiskPages * kPageBytes, [this] {
    save_over_a_file_that_cannot_be_replaced(path("disk"), files("before"), files("after"));
  });
  if (!is_permitted) GTEST_SKIP() << "mount namespaces are not permitted here";
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
