// main() of every test program.
#include <gtest/gtest.h>

#include <csignal>

// The leak sanitizer looks this function up by name. fontconfig never frees its cache of the system's fonts.
extern "C" const char* __lsan_default_suppressions();   // NOLINT(bugprone-reserved-identifier)
extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "leak:libfontconfig";
}

namespace {

/// Gives every signal its default action and unblocks all. A process inherits ignored signals (nohup ignores SIGHUP, a
/// shell's background job SIGINT) and blocked ones, and hands them on to the programs that the tests start.
void reset_signals() {
  for (int signal = 1; signal < NSIG; ++signal) {
    // SIGKILL, SIGSTOP and the C library's own signals refuse it.
    static_cast<void>(std::signal(signal, SIG_DFL));
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

}  // namespace

int main(int argc, char** argv) {
  reset_signals();
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
