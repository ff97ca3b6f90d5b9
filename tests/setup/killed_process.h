#pragma once

#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdint>

namespace touchline::setup {

enum class Killed : std::uint8_t { kYes, kEndedBefore, kNotPermitted };

/// Returns whether a system call can change a file or a folder. (Further such calls exist, but are not used.)
inline bool changes_files(std::uint64_t system_call) {
  constexpr std::array kChanges{SYS_write,  SYS_openat,   SYS_renameat, SYS_renameat2, SYS_unlinkat,
                                SYS_fchmod, SYS_fchownat, SYS_mkdirat,  SYS_ftruncate,
#ifdef SYS_rename  // not on 64-bit ARM
                                SYS_rename, SYS_unlink,   SYS_rmdir
#endif
  };
  return std::find(kChanges.begin(), kChanges.end(), static_cast<long>(system_call)) != kChanges.end();
}

/// Runs `work` in a process of its own and kills it with SIGKILL before the `number`-th (from 0) system call that
/// changes files. These calls are all steps at which a save can be interrupted.
template <class Work>
Killed kill_at_change(int number, const Work& work) {
  const pid_t process = ::fork();
  if (process == 0) {
    if (::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) ::_exit(1);
    ::raise(SIGSTOP);
    work();
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(process, &status, 0);
  if (!WIFSTOPPED(status)) return Killed::kNotPermitted;
  ::ptrace(PTRACE_SETOPTIONS, process, nullptr, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL);
  for (int changes = -1; changes < number;) {
    ::ptrace(PTRACE_SYSCALL, process, nullptr, nullptr);
    ::waitpid(process, &status, 0);
    if (!WIFSTOPPED(status)) return Killed::kEndedBefore;
    __ptrace_syscall_info call{};
    ::ptrace(PTRACE_GET_SYSCALL_INFO, process, sizeof call, &call);
    if (call.op == PTRACE_SYSCALL_INFO_ENTRY && changes_files(call.entry.nr)) ++changes;
  }
  ::kill(process, SIGKILL);
  ::waitpid(process, &status, 0);
  return Killed::kYes;
}

}  // namespace touchline::setup
