#include "firmware/console/access.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <filesystem>

namespace touchline::console {
namespace {

TEST(HostHeader, AddressesInNumbersLocalhostAndListedNamesArePermitted) {
  const std::vector<std::string> hosts{"touchline.local"};
  for (const char* const host : {"127.0.0.1", "127.0.0.1:8642", "192.168.1.7:80", "[::1]:8642", "localhost",
                                 "localhost:9000", "LOCALHOST", "touchline.local:8642", "Touchline.Local"}) {
    EXPECT_TRUE(is_host_permitted(host, hosts)) << host;
  }
  for (const char* const host : {"", ":8642", "evil.example", "evil.example:8642", "127.0.0.1.evil.example",
                                 "localhost.evil.example", "touchline.local.evil.example", "xtouchline.local",
                                 "[::1].evil.example", "[evil]", "evil.example#127.0.0.1", "user@127.0.0.1"}) {
    EXPECT_FALSE(is_host_permitted(host, hosts)) << host;
  }
  EXPECT_FALSE(is_host_permitted("touchline.local", {}));
}

TEST(OriginHeader, MustBeTheConsoleItself) {
  const auto permitted = [](std::string_view origin, std::string_view site, bool is_navigation) {
    return is_origin_permitted({"127.0.0.1:8642", origin, site, "", ""}, is_navigation);
  };
  EXPECT_TRUE(permitted("http://127.0.0.1:8642", "same-origin", false));
  EXPECT_TRUE(permitted("", "", false)) << "a program that is no browser";
  EXPECT_TRUE(permitted("", "none", false)) << "typed into the address line";
  EXPECT_TRUE(permitted("", "cross-site", true)) << "a link to the page";
  EXPECT_FALSE(permitted("", "cross-site", false));
  EXPECT_FALSE(permitted("", "same-site", false)) << "another port of this computer is another site";
  for (const char* const origin : {"http://evil.example", "http://127.0.0.1", "http://127.0.0.1:8643", "null",
                                   "127.0.0.1:8642", "http://127.0.0.1:8642.evil.example"}) {
    EXPECT_FALSE(permitted(origin, "", false)) << origin;
    EXPECT_FALSE(permitted(origin, "", true)) << origin;
  }
}

TEST(Token, IsComparedCompletely) {
  EXPECT_TRUE(equal_in_constant_time("abcd", "abcd"));
  for (const char* const given : {"", "abc", "abcde", "abce", "bbcd", "ABCD"}) {
    EXPECT_FALSE(equal_in_constant_time(given, "abcd")) << given;
  }
}

TEST(Token, IsFoundAmongOtherCookies) {
  EXPECT_EQ(token_of_cookie("touchline_token=12ab"), "12ab");
  EXPECT_EQ(token_of_cookie("a=b; touchline_token=12ab; c=d"), "12ab");
  EXPECT_EQ(token_of_cookie("xtouchline_token=12ab; touchline_tokenx=3; touchline_token"), "");
  EXPECT_EQ(token_of_cookie(";;=; ="), "");
}

TEST(Access, OtherComputersNeedTheToken) {
  const AccessRules rules{{}, "5eed"};
  const auto may = [&](std::string_view peer, std::string_view cookie) {
    return has_access({"192.168.1.7", "", "", cookie, peer}, rules);
  };
  EXPECT_TRUE(may("127.0.0.1", ""));
  EXPECT_TRUE(may("::ffff:127.0.0.1", ""));
  EXPECT_TRUE(may("192.168.1.9", "touchline_token=5eed"));
  EXPECT_FALSE(may("192.168.1.9", ""));
  EXPECT_FALSE(may("192.168.1.9", "touchline_token=5eee"));
  EXPECT_FALSE(may("127.evil", "")) << "not an address";
  EXPECT_FALSE(has_access({"192.168.1.7", "", "", "touchline_token=", "192.168.1.9"}, {})) << "no token, no access";
}

TEST(Token, IsMadeOnceAndReadableByItsOwnerOnly) {
  const std::string path = ::testing::TempDir() + "console-token-" + std::to_string(::getpid());
  std::filesystem::remove(path);
  EXPECT_EQ(read_token(path).code(), ErrorCode::kNotFound);
  const Result<std::string> made = make_token(path);
  ASSERT_TRUE(made.ok()) << made.text();
  EXPECT_EQ(made.value().size(), 64U);
  struct stat status {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  const Result<std::string> again = make_token(path);
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again.value(), made.value());
  std::filesystem::resize_file(path, 20);
  EXPECT_EQ(make_token(path).code(), ErrorCode::kCorruptFrame) << "half a token is none";
  std::filesystem::remove(path);
}

// `touchline link` runs as root in a folder of the service's user, who could put anything in the file's place.
TEST(Token, IsReadFromARegularFileOnly) {
  const std::string path = ::testing::TempDir() + "odd-token-" + std::to_string(::getpid()), target = path + "-target";
  const Result<std::string> other = make_token(target);
  ASSERT_TRUE(other.ok()) << other.text();
  std::filesystem::create_symlink(target, path);
  EXPECT_EQ(make_token(path).code(), ErrorCode::kUnsupported);
  EXPECT_EQ(read_token(path).code(), ErrorCode::kUnsupported);
  std::filesystem::remove(path);
  std::filesystem::create_symlink(target + "-missing", path);
  EXPECT_FALSE(make_token(path).ok());
  EXPECT_FALSE(std::filesystem::exists(target + "-missing"));
  std::filesystem::remove(path);
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(make_token(path).code(), ErrorCode::kUnsupported) << "and nothing waits for a writer";
  std::filesystem::remove(path);
  std::filesystem::remove(target);
}

TEST(Token, OfRootBelongsToTheOwnerOfItsFolder) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give files away";
  constexpr uid_t kService = 4321;
  const std::string folder = ::testing::TempDir() + "token-folder-" + std::to_string(::getpid()),
                    path = folder + "/console-token";
  std::filesystem::create_directory(folder);
  ASSERT_EQ(::chown(folder.c_str(), kService, kService), 0);
  const auto owner = [&path] {
    struct stat status {};
    return ::stat(path.c_str(), &status) == 0 ? status.st_uid : 0;
  };
  EXPECT_TRUE(make_token(path).ok());
  EXPECT_EQ(owner(), kService);
  ASSERT_EQ(::chown(path.c_str(), 0, 0), 0);  // as an earlier version left it
  EXPECT_TRUE(make_token(path).ok());
  EXPECT_EQ(owner(), kService);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace touchline::console
