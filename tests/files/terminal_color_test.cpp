#include "hal/files/terminal_color.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

namespace touchline::hal {
namespace {

class TerminalColor : public ::testing::Test {
 protected:
  TerminalColor() {
    EXPECT_EQ(::grantpt(terminal_), 0);
    ::setenv("TERM", "xterm", 1);
    ::unsetenv("NO_COLOR");
  }
  ~TerminalColor() override {
    ::unsetenv("NO_COLOR");
    ::close(terminal_);
  }
  const int terminal_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
};

TEST_F(TerminalColor, IsShownOnATerminalOnly) {
  EXPECT_TRUE(shows_color(terminal_));
  const int file = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  EXPECT_FALSE(shows_color(file));
  ::close(file);
  EXPECT_FALSE(shows_color(-1));
}

TEST_F(TerminalColor, IsSwitchedOffByTheEnvironment) {
  ::setenv("NO_COLOR", "", 1);
  EXPECT_TRUE(shows_color(terminal_)) << "no-color.org: when present and not empty";
  ::setenv("NO_COLOR", "0", 1);
  EXPECT_FALSE(shows_color(terminal_)) << "whatever the value is";
  ::unsetenv("NO_COLOR");
  ::setenv("TERM", "dumb", 1);
  EXPECT_FALSE(shows_color(terminal_));
}

}  // namespace
}  // namespace touchline::hal
