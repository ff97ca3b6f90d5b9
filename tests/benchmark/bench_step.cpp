#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/benchmark/step_subject.h"

// One frame's whole way as often as is asked, for a profiler: bench_step scan|step [CALLS]
namespace touchline::testing {
namespace {

[[gnu::noinline]] void counted_call(StepSubject& subject, bool scan) {
  if (scan) {
    subject.scan_only();
  } else {
    static_cast<void>(subject.step());
  }
}

int run(int argc, char** argv) {
  static StepSubject subject;
  if (const std::string wrong = subject.prepare(TOUCHLINE_BOARDS "/mock/board.toml"); !wrong.empty()) {
    std::fprintf(stderr, "bench_step: %s\n", wrong.c_str());
    return 1;
  }
  const bool scan = argc > 1 && std::strcmp(argv[1], "scan") == 0;
  for (int i = argc > 2 ? std::atoi(argv[2]) : 1; i > 0; --i) counted_call(subject, scan);
  return 0;
}

}  // namespace
}  // namespace touchline::testing

int main(int argc, char** argv) { return touchline::testing::run(argc, argv); }
