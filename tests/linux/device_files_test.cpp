#include "hal/linux/device_files.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace touchline::hal {
namespace {

// A pseudo terminal: a real device that another process can hold.
TEST(DeviceFiles, NamesTheProcessThatHasADeviceOpen) {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(::grantpt(terminal) + ::unlockpt(terminal), 0);
  const std::string device = ::ptsname(terminal);  // NOLINT(concurrency-mt-unsafe): one thread
  EXPECT_EQ(users_of(device), "") << "the program itself holds only the other end";
  int opened[2];  // NOLINT(modernize-avoid-c-arrays): pipe() wants one
  ASSERT_EQ(::pipe(opened), 0);
  const pid_t holder = ::fork();
  if (holder == 0) {
    if (::open(device.c_str(), O_RDWR | O_NOCTTY) < 0) ::_exit(1);
    static_cast<void>(::write(opened[1], "x", 1));
    ::pause();
    ::_exit(0);
  }
  char ready = 0;
  ASSERT_EQ(::read(opened[0], &ready, 1), 1);
  const std::string users = users_of(device), link = std::string(::testing::TempDir()) + "terminal-link";
  std::filesystem::remove(link);
  std::filesystem::create_symlink(device, link);
  EXPECT_NE(users.find("(process " + std::to_string(holder) + ")"), std::string::npos) << users;
  EXPECT_EQ(users_of(link), users) << "a board file names a link";
  std::filesystem::remove(link);
  ::kill(holder, SIGKILL);
  ::waitpid(holder, nullptr, 0);
  EXPECT_EQ(users_of(device), "");
  EXPECT_EQ(users_of("/dev/there-is-no-such-device"), "");
  for (const int file : {terminal, opened[0], opened[1]}) ::close(file);
}

}  // namespace
}  // namespace touchline::hal
