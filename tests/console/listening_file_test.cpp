// How `touchline console --link` finds the ports of running programs.
#include "firmware/console/listening_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <filesystem>
#include <fstream>

namespace touchline::console {
namespace {

namespace fs = std::filesystem;

class ListeningFileTest : public ::testing::Test {
 protected:
  ListeningFileTest() : folder_(::testing::TempDir() + "listening-" + std::to_string(::getpid())) {
    fs::create_directory(folder_);
  }
  ~ListeningFileTest() override { fs::remove_all(folder_); }
  [[nodiscard]] std::vector<std::uint16_t> ports() const {
    std::vector<std::uint16_t> found;
    for (const ListeningAddress& one : running_consoles(token_)) found.push_back(one.port);
    return found;
  }
  using Ports = std::vector<std::uint16_t>;

  const std::string folder_, token_ = folder_ + "/console-token";
};

TEST_F(ListeningFileTest, NamesThePortsOfRunningPrograms) {
  EXPECT_EQ(ports(), Ports{});
  ListeningFile first;
  first.write(token_, {"0.0.0.0", 8642});
  {
    ListeningFile second;  // the port was busy
    second.write(token_, {"192.0.2.7", 8643});
    EXPECT_EQ(ports(), (Ports{8642, 8643}));
    EXPECT_EQ(running_consoles(token_).back().address, "192.0.2.7");
  }
  EXPECT_EQ(ports(), Ports{8642});
  first.remove();
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(ListeningFileTest, ACrashedProgramIsNotListed) {
  const pid_t crashed = ::fork();
  if (crashed == 0) {
    ListeningFile file;
    file.write(token_, {"0.0.0.0", 8642});
    ::_exit(running_consoles(token_).size() == 1 ? 0 : 1);  // no destructor is called
  }
  int status = 0;
  ASSERT_EQ(::waitpid(crashed, &status, 0), crashed);
  ASSERT_EQ(status, 0);
  ASSERT_FALSE(fs::is_empty(folder_));
  EXPECT_EQ(ports(), Ports{});
  ListeningFile next;
  next.write(token_, {"0.0.0.0", 8642});
  EXPECT_EQ(ports(), Ports{8642});
}

TEST_F(ListeningFileTest, OddFilesAreIgnored) {
  fs::create_symlink("/etc/hostname", folder_ + "/console-1.listening");
  ASSERT_EQ(::mkfifo((folder_ + "/console-2.listening").c_str(), 0600), 0);
  std::ofstream(folder_ + "/console-3.listening") << "0.0.0.0:3\n";
  EXPECT_EQ(ports(), Ports{});
  ListeningFile nowhere;
  nowhere.write(folder_ + "/missing/console-token", {"0.0.0.0", 8642});
  EXPECT_TRUE(running_consoles(folder_ + "/missing/console-token").empty());
}

}  // namespace
}  // namespace touchline::console
