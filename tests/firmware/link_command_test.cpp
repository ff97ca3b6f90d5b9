#include "firmware/link_command.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/results.h"
#include "tests/tools/program_folder.h"

namespace touchline {
namespace {

namespace fs = std::filesystem;

/// An installed board in a folder, with a systemctl that only records its arguments.
class LinkCommand : public testing::ProgramFolder {
 protected:
  void SetUp() override {
    for (const char* folder : {"bin", "etc/touchline", "usr/lib/systemd/system", "usr/share/touchline/avahi",
                               "etc/avahi/services", "var/lib/touchline"}) {
      fs::create_directories(path(folder));
    }
    write("usr/lib/systemd/system/touchline.service", "[Service]\n");
    write("usr/share/touchline/avahi/touchline.service", "<service-group/>\n");
    write("etc/touchline/board.toml",
          "version = 1\nname = \"here\"\nvenue = \"venue.toml\"\nteam = \"team.toml\"\n"
          "[camera]\nbackend = \"mock\"\n[radio]\nbackend = \"mock\"\n[gpio]\nbackend = \"mock\"\n");
    write("bin/systemctl", "#!/bin/sh\necho \"$*\" >>'" + path("asked") + "'\n");
    fs::permissions(path("bin/systemctl"), fs::perms::owner_all);
  }

  [[nodiscard]] LinkOptions options(bool is_undone) const {
    return {
        .is_undone = is_undone, .root = path("").substr(0, path("").size() - 1), .systemctl = path("bin/systemctl")};
  }
  const std::string drop_in_ = "etc/systemd/system/touchline.service.d/link.conf";
};

TEST_F(LinkCommand, OpensThePageAndClosesItAgain) {
  const Result<std::string> opened = link_command(options(false));
  ASSERT_OK(opened);
  EXPECT_NE(read(drop_in_).find("console.address=\"0.0.0.0:8642\""), std::string::npos) << read(drop_in_);
  EXPECT_EQ(read(drop_in_).find("HOST"), std::string::npos);
  const std::string token = read("var/lib/touchline/console-token");
  EXPECT_NE(opened.value().find("/login?token=" + token.substr(0, 64)), std::string::npos) << opened.value();
  EXPECT_NE(opened.value().find("HTTP"), std::string::npos);
  EXPECT_TRUE(fs::exists(path("etc/avahi/services/touchline.service")));
  EXPECT_EQ(read("asked"), "enable --quiet --now touchline-setup.service\ndaemon-reload\nrestart touchline.service\n");

  ASSERT_OK(link_command(options(false)));
  EXPECT_EQ(read("var/lib/touchline/console-token"), token) << "links stay valid";

  ASSERT_OK(link_command(options(true)));
  EXPECT_FALSE(fs::exists(path(drop_in_)));
  EXPECT_FALSE(fs::exists(path("etc/avahi/services/touchline.service")));
  EXPECT_OK(link_command(options(true)));  // twice does no harm
}

TEST_F(LinkCommand, SaysThatTheServiceIsMissing) {
  fs::remove(path("usr/lib/systemd/system/touchline.service"));
  const Result<std::string> refused = link_command(options(false));
  EXPECT_EQ(refused.code(), ErrorCode::kNotFound);
  EXPECT_NE(refused.text().find("touchline run --lan"), std::string::npos) << refused.text();
  EXPECT_FALSE(fs::exists(path(drop_in_)));
}

TEST_F(LinkCommand, AWrongBoardFileChangesNothing) {
  write("etc/touchline/board.toml", "version = 1\ncamera = 5\n");
  EXPECT_FALSE(link_command(options(false)).ok());
  EXPECT_FALSE(fs::exists(path(drop_in_)));
  EXPECT_FALSE(fs::exists(path("asked")));
}

TEST_F(LinkCommand, NothingIsOpenIfTheServiceDoesNotRestart) {
  write("bin/systemctl", "#!/bin/sh\ncase $1 in restart) exit 1 ;; esac\n");
  EXPECT_EQ(link_command(options(false)).code(), ErrorCode::kIo);
  EXPECT_FALSE(fs::exists(path(drop_in_)));
  EXPECT_EQ(link_command(options(true)).code(), ErrorCode::kIo) << "the page may still be open";
}

TEST_F(LinkCommand, OnlyATerminalGetsTheToken) {
  LinkOptions piped = options(false);
  piped.is_terminal = false;
  const Result<std::string> opened = link_command(piped);
  ASSERT_OK(opened);
  EXPECT_EQ(opened.value().find(read("var/lib/touchline/console-token").substr(0, 64)), std::string::npos);
}

}  // namespace
}  // namespace touchline
