#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/console/lossy_link.h"

// lossy_link COMMAND [ARGUMENTS]: runs the command on the laptop's side of a link as in lossy_link.h. Programs that it
// starts with `nsenter --net=$BOARD_NETWORK` run on the board's side, whose address is $BOARD_ADDRESS. Exit code: that
// of the command; 77: namespaces or TUN devices are not permitted.
namespace {

// Namespaces of an account that is not root belong to a user namespace in which it is.
void become_root() {
  const uid_t user = ::getuid();
  const gid_t group = ::getgid();
  if (user == 0 || ::unshare(CLONE_NEWUSER) != 0) return;
  std::ofstream("/proc/self/setgroups") << "deny";
  std::ofstream("/proc/self/uid_map") << "0 " << user << " 1";
  std::ofstream("/proc/self/gid_map") << "0 " << group << " 1";
}

}  // namespace

int main(int count, char** words) {
  using touchline::console::LossyLink;
  if (count < 2) {
    std::fputs("usage: lossy_link COMMAND [ARGUMENTS]\n", stderr);
    return 64;
  }
  become_root();
  LossyLink link;
  if (const touchline::Result<void> opened = link.open({}); !opened.ok()) {
    std::printf("skipped: no link between namespaces: %s\n", opened.text().c_str());
    return 77;
  }
  const std::string network = "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(link.board_namespace());
  ::setenv("BOARD_NETWORK", network.c_str(), 1);
  ::setenv("BOARD_ADDRESS", LossyLink::kBoardAddress, 1);
  const pid_t child = ::fork();
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    link.enter_laptop();
    ::execvp(words[1], words + 1);
    std::perror(words[1]);
    ::_exit(127);
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) continue;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}
