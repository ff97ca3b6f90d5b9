#include "firmware/config/user_files.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/results.h"
#include "tests/tools/program_folder.h"

namespace touchline::config {
namespace {

namespace fs = std::filesystem;

class UserFiles : public touchline::testing::ProgramFolder {
 protected:
  void SetUp() override {
    fs::create_directories(path("here"));
    fs::create_directories(path("config/touchline"));
    fs::current_path(path("here"));
    ::setenv("XDG_CONFIG_HOME", path("config").c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  }
  void TearDown() override {
    fs::current_path("/");
    ::unsetenv("XDG_CONFIG_HOME");  // NOLINT(concurrency-mt-unsafe)
    ::unsetenv("XDG_STATE_HOME");   // NOLINT(concurrency-mt-unsafe)
  }
};

TEST_F(UserFiles, TheWorkingFolderComesBeforeTheUsersFolder) {
  write("config/touchline/board.toml", "");
  EXPECT_EQ(find_board_file().value(), path("config/touchline/board.toml"));
  write("here/board.toml", "");
  EXPECT_EQ(find_board_file().value(), "board.toml");
}

TEST_F(UserFiles, NamesThePlacesIfThereIsNone) {
  if (fs::exists("/etc/touchline/board.toml")) GTEST_SKIP() << "Touchline is installed here";
  const Result<std::string> found = find_board_file();
  EXPECT_EQ(found.code(), ErrorCode::kNotFound);
  EXPECT_NE(found.text().find(path("config/touchline/board.toml")), std::string::npos) << found.text();
}

TEST_F(UserFiles, StateIsInTheUsersStateFolder) {
  ::setenv("XDG_STATE_HOME", path("state").c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  EXPECT_EQ(user_state_file("console-token"), path("state/touchline/console-token"));
  ::setenv("XDG_STATE_HOME", "relative", 1);  // NOLINT(concurrency-mt-unsafe)
  EXPECT_NE(user_state_file("console-token").find("/.local/state/touchline/console-token"), std::string::npos)
      << "the specification ignores relative paths";
}

}  // namespace
}  // namespace touchline::config
