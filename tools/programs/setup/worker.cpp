#include "tools/programs/setup/worker.h"

#include <fcntl.h>
#include <linux/capability.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <exception>

#include "hal/linux/system_error.h"
#include "tools/programs/command_line/formatted.h"

namespace touchline::setup {
namespace {

// Drops the right to write all files of the board (CAP_DAC_OVERRIDE), which the service has. If a malicious picture
// takes over a decoder, it does not get this right.
bool drop_capabilities() {
  // Fails only on kernels that have no ambient capabilities.
  ::prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  // This needs CAP_SETPCAP; without it, no set has a capability that a program could get from the bounding set.
  for (unsigned long one = 0; one <= CAP_LAST_CAP; ++one) ::prctl(PR_CAPBSET_DROP, one, 0, 0, 0);
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  const std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> none{};
  return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && ::syscall(SYS_capset, &header, none.data()) == 0;
}

// Runs the work in the new process, and never returns.
[[noreturn]] void run(const Worker::Work& work, int descriptor) {
  // The work must not outlive the program, and must not inherit its blocked signals.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const Worker::Reporter reporter(descriptor);
  std::string error;
  try {
    error = drop_capabilities() ? work(reporter).text() : "the work cannot be started: it keeps its capabilities";
  } catch (const std::exception& fault) {
    error = formatted("this work failed: %s", fault.what());
  }
  reporter.send({{"type", "done"}, {"error", error}});
  // Skip destructors and exit handlers, which only the parent must run.
  ::_exit(EXIT_SUCCESS);
}

}  // namespace

void Worker::Reporter::progress(std::string_view text, double share) const {
  nlohmann::json content = {{"type", "progress"}, {"text", text}, {"progress", nullptr}};
  if (share >= 0) content["progress"] = share;
  send(content);
}

void Worker::Reporter::send(const nlohmann::json& content, std::string_view bytes) const {
  const std::string message = framed(content, bytes);
  for (std::size_t sent = 0; sent < message.size();) {
    const ssize_t count = ::send(descriptor_, message.data() + sent, message.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return;  // the program has ended, so this process ends soon
    sent += static_cast<std::size_t>(count);
  }
}

Result<void> Worker::start(const Work& work) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    return failure(ErrorCode::kIo, "the work cannot be started: %s", hal::system_text(errno));
  }
  hal::Descriptor here(ends[0]), there(ends[1]);
  if (::fcntl(here.get(), F_SETFL, O_NONBLOCK) != 0) {
    return failure(ErrorCode::kIo, "the work cannot be started: %s", hal::system_text(errno));
  }
  const pid_t process = ::fork();
  if (process < 0) return failure(ErrorCode::kIo, "the work cannot be started: %s", hal::system_text(errno));
  if (process == 0) {
    here.reset();
    run(work, there.get());
  }
  process_ = process;
  link_ = MessageLink(std::move(here));
  return {};
}

std::string Worker::finish() {
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = 0;
  link_.close();
  if (WIFSIGNALED(status)) return formatted("this work ended unexpectedly (%s)", ::strsignal(WTERMSIG(status)));
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? "" : "this work ended unexpectedly";
}

void Worker::cancel() {
  if (process_ <= 0) return;
  ::kill(process_, SIGKILL);
  finish();
}

}  // namespace touchline::setup
