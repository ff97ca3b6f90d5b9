#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/benchmark/step_benchmark.h"

// Runs the pipeline step, or its first stage alone, for a profiler: profile_step scan|step [CALLS]
namespace touchline::testing {
namespace {

[[gnu::noinline]] void counted_call(StepBenchmark& benchmark, bool scan) {
  if (scan) {
    benchmark.scan_only();
  } else {
    static_cast<void>(benchmark.step());
  }
}

int run(int argc, char** argv) {
  static StepBenchmark benchmark;
  if (const Result<void> prepared = benchmark.prepare(TOUCHLINE_BOARDS "/mock/board.toml"); !prepared.ok()) {
    std::fprintf(stderr, "profile_step: %s\n", prepared.text().c_str());
    return 1;
  }
  const bool scan = argc > 1 && std::strcmp(argv[1], "scan") == 0;
  for (int i = argc > 2 ? std::atoi(argv[2]) : 1; i > 0; --i) counted_call(benchmark, scan);
  return 0;
}

}  // namespace
}  // namespace touchline::testing

int main(int argc, char** argv) { return touchline::testing::run(argc, argv); }
