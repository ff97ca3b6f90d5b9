#include "firmware/console/page_files.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <filesystem>
#include <fstream>

namespace touchline::console {
namespace {

TEST(PageFiles, OnlyFilesOfTheFolderAreFound) {
  const std::filesystem::path above = ::testing::TempDir() + "page-" + std::to_string(::getpid());
  const std::filesystem::path folder = above / "dist";
  std::filesystem::create_directories(folder / "assets");
  std::ofstream(above / "secret.txt") << "secret";
  const PageFiles before(folder.string());
  EXPECT_TRUE(before.empty());
  std::ofstream(folder / "index.html") << "page";
  std::ofstream(folder / "favicon.svg") << "icon";
  std::ofstream(folder / "assets/main-1a2b.js") << "code";
  std::filesystem::create_symlink(above / "secret.txt", folder / "link.txt");
  std::filesystem::create_symlink(above, folder / "above");
  EXPECT_TRUE(before.empty()) << "they are read once";
  const PageFiles files(folder.string());
  EXPECT_FALSE(files.empty());
  ASSERT_NE(files.find("/"), nullptr);
  EXPECT_EQ(files.find("/")->content_type, "text/html; charset=utf-8");
  ASSERT_NE(files.find("/assets/main-1a2b.js"), nullptr);
  EXPECT_EQ(files.find("/assets/main-1a2b.js")->content_type, "text/javascript; charset=utf-8");
  ASSERT_NE(files.find("/favicon.ico"), nullptr) << "browsers ask for it by themselves";
  EXPECT_EQ(files.find("/favicon.ico")->content_type, "image/svg+xml");
  for (const char* const address : {"", "/assets", "/assets/", "/../secret.txt", "/assets/../../secret.txt",
                                    "/link.txt", "/above/secret.txt", "//index.html", "/index.html/"}) {
    EXPECT_EQ(files.find(address), nullptr) << address;
  }
  // After another build, a client with the former page still requests the former assets.
  std::filesystem::remove(folder / "assets/main-1a2b.js");
  std::ofstream(folder / "assets/main-9f9f.js") << "other code";
  std::ofstream(folder / "index.html") << "other page";
  EXPECT_EQ(files.find("/")->content, "page");
  const PageFiles next(folder.string(), &files);
  EXPECT_EQ(next.find("/")->content, "other page");
  EXPECT_EQ(next.find("/assets/main-1a2b.js")->content, "code");
  EXPECT_EQ(next.find("/assets/main-9f9f.js")->content, "other code");
  EXPECT_EQ(PageFiles(folder.string()).find("/assets/main-1a2b.js"), nullptr);
  std::filesystem::remove_all(above);
  EXPECT_TRUE(PageFiles("").empty());
}

}  // namespace
}  // namespace touchline::console
