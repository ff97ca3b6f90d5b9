// Checks that links and paths in the documentation exist, in the repository and where the package installs it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace touchline::checks {
namespace {

namespace fs = std::filesystem;

struct Links {
  std::size_t count = 0;
  std::vector<std::string> broken;
};

void read_page(const fs::path& page, Links& links) {
  std::ostringstream read;
  read << std::ifstream(page).rdbuf();
  const std::string text = read.str();
  const std::regex link(R"(\]\(([^)#]+)(#[^)]*)?\))");
  for (auto found = std::sregex_iterator(text.begin(), text.end(), link); found != std::sregex_iterator(); ++found) {
    const std::string target = (*found)[1];
    if (target.starts_with("http")) continue;
    ++links.count;
    if (!fs::exists(page.parent_path() / target)) links.broken.push_back(page.string() + ": " + target);
  }
}

Links links_of(std::initializer_list<fs::path> places) {
  Links links;
  for (const fs::path& place : places) {
    if (!fs::is_directory(place)) {
      read_page(place, links);
      continue;
    }
    for (const auto& entry : fs::recursive_directory_iterator(place)) {
      if (entry.path().extension() == ".md") read_page(entry.path(), links);
    }
  }
  return links;
}

/// Finds paths of the repository that a page names in backquotes: `core/pipeline.cpp`.
Links named_paths(const fs::path& page, const fs::path& repository) {
  std::ostringstream read;
  read << std::ifstream(page).rdbuf();
  const std::string text = read.str();
  Links paths;
  const std::regex path(R"(`((core|hal|firmware|tools|tests|toolchain|docs|boards|\.ci)/[\w./-]*)`)");
  for (auto found = std::sregex_iterator(text.begin(), text.end(), path); found != std::sregex_iterator(); ++found) {
    ++paths.count;
    if (!fs::exists(repository / (*found)[1].str())) paths.broken.push_back((*found)[1]);
  }
  return paths;
}

class Documentation : public ::testing::Test {
 protected:
  Documentation() {
    std::string name = (fs::temp_directory_path() / "touchline-documentation-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~Documentation() override { fs::remove_all(folder_); }
  const fs::path repository_ = TOUCHLINE_SOURCE_DIR;
  fs::path folder_;
};

TEST_F(Documentation, LinksAreValid) {
  const Links links = links_of({repository_ / "README.md", repository_ / "CONTRIBUTING.md", repository_ / "docs",
                                repository_ / "boards", repository_ / "core", repository_ / "hal",
                                repository_ / "firmware", repository_ / "tools/robot"});
  EXPECT_EQ(links.broken, std::vector<std::string>());
  EXPECT_GT(links.count, 30U);
}

TEST_F(Documentation, LinksAreValidOnABoard) {
  const fs::path script = repository_ / "toolchain/package/install-documentation";
  ASSERT_EQ(std::system(("'" + script.string() + "' '" + (folder_ / "share").string() + "'").c_str()), 0);
  const Links links = links_of({folder_ / "share"});
  EXPECT_EQ(links.broken, std::vector<std::string>());
  EXPECT_GT(links.count, 25U);
  EXPECT_TRUE(fs::exists(folder_ / "share/touchline/boards/mock/board.toml"));
}

TEST_F(Documentation, PathsForContributorsExist) {
  for (const char* page : {"CONTRIBUTING.md", "docs/testing.md"}) {
    const Links paths = named_paths(repository_ / page, repository_);
    EXPECT_EQ(paths.broken, std::vector<std::string>()) << page;
    EXPECT_GT(paths.count, 5U) << page;
  }
}

TEST_F(Documentation, AMissingPathIsFound) {
  std::ofstream(folder_ / "page.md") << "`core/pipeline.h`, `core/no_such_file.h`, `build/release`\n";
  const Links paths = named_paths(folder_ / "page.md", repository_);
  EXPECT_EQ(paths.count, 2U);
  EXPECT_EQ(paths.broken, std::vector<std::string>{"core/no_such_file.h"});
}

TEST_F(Documentation, ABrokenLinkIsFound) {
  std::ofstream(folder_ / "page.md")
      << "[there](page.md#part), [not there](other.md), [elsewhere](https://example.org)\n";
  const Links links = links_of({folder_});
  EXPECT_EQ(links.count, 2U);
  ASSERT_EQ(links.broken.size(), 1U);
  EXPECT_EQ(links.broken[0], (folder_ / "page.md").string() + ": other.md");
}

}  // namespace
}  // namespace touchline::checks
