// Links in the documentation lead somewhere: in the repository, and where the package puts it.
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

TEST_F(Documentation, LinksLeadSomewhere) {
  const Links links = links_of({repository_ / "README.md", repository_ / "docs", repository_ / "boards"});
  EXPECT_EQ(links.broken, std::vector<std::string>());
  EXPECT_GT(links.count, 30U);
}

TEST_F(Documentation, LinksLeadSomewhereOnABoardToo) {
  const fs::path script = repository_ / "toolchain/package/install-documentation";
  ASSERT_EQ(std::system(("'" + script.string() + "' '" + (folder_ / "share").string() + "'").c_str()), 0);
  const Links links = links_of({folder_ / "share"});
  EXPECT_EQ(links.broken, std::vector<std::string>());
  EXPECT_GT(links.count, 25U);
  EXPECT_TRUE(fs::exists(folder_ / "share/touchline/boards/mock/board.toml"));
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
