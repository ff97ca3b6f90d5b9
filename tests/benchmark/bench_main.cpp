#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "tests/benchmark/clutter_step.h"
#include "tests/benchmark/measurement.h"
#include "tests/benchmark/mjpg_benchmark.h"
#include "tests/benchmark/real_pictures.h"
#include "tests/benchmark/step_benchmark.h"
#include "tests/benchmark/store_pictures.h"
#include "tools/programs/command_line/command_line.h"

namespace touchline::testing {
namespace {

constexpr char kProgram[] = "touchline-bench";

struct Options {
  std::string filter, json, once, search_of = "all";
  std::vector<std::string> store;
  std::size_t repetitions = 500, calls = 1, pictures = kMaxRealPictures;
  double search_s = 0.0;
  unsigned seed = 1;
  bool quick = false, check = false, list = false;
};

void add_options(CLI::App& app, Options& options) {
  constexpr std::size_t kMaxRepetitions = 100000;
  app.add_flag("--quick", options.quick, "50 repetitions");
  app.add_option("--repetitions", options.repetitions, "Calls per method")
      ->check(CLI::Range(std::size_t{1}, kMaxRepetitions))
      ->capture_default_str();
  app.add_option("--filter", options.filter, "Measure only the frames whose names contain this text");
  app.add_option("--pictures", options.pictures,
                 "Pictures of each real set that are measured in turn; a single one stays in the cache")
      ->check(CLI::Range(std::size_t{1}, kMaxRealPictures))
      ->capture_default_str();
  app.add_option("--json", options.json, "Write all times into this file")->type_name("FILE");
  app.add_flag("--check", options.check, "Check the results without measuring");
  app.add_option("--search", options.search_s,
                 "Search for the slowest pictures and print them, each of --of for this many seconds")
      ->check(number_range(1.0, 100000.0));
  app.add_option("--of", options.search_of,
                 "What --search makes slow: the scan, the whole step, the step with more robots")
      ->check(one_of({"all", "scan", "step", "large-step"}))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "Random seed of the search")->check(CLI::Range(1, 100000));
  app.add_flag("--list", options.list, "List the names that --once accepts");
  app.add_option("--once", options.once, "Call one method once, for a profiler that counts in `counted_call`")
      ->type_name("FRAME/METHOD");
  app.add_option("--calls", options.calls, "Calls of --once; each takes the next of several pictures")
      ->check(CLI::Range(std::size_t{1}, kMaxRepetitions))
      ->capture_default_str();
  app.add_option("--store", options.store, "Write pictures for profile_step into a file: game, or the name of clutter")
      ->type_name("PICTURE FORMAT VENUE FILE")
      ->expected(4);
  add_examples(app, {{"touchline-bench --quick", "measure everything in a minute"},
                     {"touchline-bench --filter \"field 640\"", "measure the frames with this text in their names"}});
}

[[gnu::noinline]] void counted_call(const std::function<void()>& work) { work(); }

// Adds the cases whose names contain `filter`, with their methods.
Result<void> add_cases(BenchmarkCases& cases, const std::string& filter, std::size_t pictures) {
  cases = make_cases(filter);
  for (const auto& benchmark : cases) {
    if (Result<void> added = add_methods(*benchmark); !added.ok()) {
      return prefixed(benchmark->name, std::move(added).error());
    }
  }
  TOUCHLINE_TRY(add_clutter_cases(cases, filter));
  TOUCHLINE_TRY(add_real_pictures(cases, filter, pictures));
  return add_mjpg_cases(cases, filter);
}

int search(const Options& options) {
  const auto wanted = [&](const char* what) { return options.search_of == "all" || options.search_of == what; };
  if (wanted("scan")) search_slowest_picture(options.search_s, options.seed);
  for (const auto& [what, teams] : {std::pair{"step", ClutterTeams::kMock}, {"large-step", ClutterTeams::kLargest}}) {
    if (!wanted(what)) continue;
    const Result<void> searched = search_slowest_step(options.search_s, options.seed, teams);
    if (!searched.ok()) return fail(kProgram, searched.text());
  }
  return kExitOk;
}

int call_once(const Options& options) {
  const std::size_t slash = options.once.find('/');
  const std::string frame = options.once.substr(0, slash);
  BenchmarkCases cases;
  if (const Result<void> added = add_cases(cases, frame, options.pictures); !added.ok())
    return fail(kProgram, added.text());
  for (const auto& benchmark : cases) {
    if (benchmark->name != frame || slash == std::string::npos) continue;
    for (const Method& method : benchmark->methods) {
      if (options.once.substr(slash + 1) != method.name) continue;
      method.work();  // the first call lets the method allocate its memory
      for (std::size_t i = 0; i < options.calls; ++i) counted_call(method.work);
      return kExitOk;
    }
  }
  return fail(kProgram, "there is no method \"" + options.once + "\"; --list shows all", kExitBadCommandLine);
}

// Adds the whole pipeline step and, for comparison, its first stage alone.
Result<void> add_step(BenchmarkCases& cases, StepBenchmark& step, const std::string& filter) {
  auto benchmark = std::make_unique<BenchmarkCase>(BenchmarkCase{
      .name = "step, ten robots and ball", .picture = OwnedPicture(PixelFormat::kRgb24, 1, 1, 0), .parameters = {}});
  if (benchmark->name.find(filter) == std::string::npos) return {};
  TOUCHLINE_TRY(step.prepare(mock_files()));
  benchmark->methods.push_back({std::string("scan") + kEveryRow, [&step] { step.scan_only(); }, {}});
  benchmark->methods.push_back({"step", [&step] { static_cast<void>(step.step()); }, {}});
  cases.push_back(std::move(benchmark));
  return {};
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Measures classification and region labeling against a plain read of the frame and against other methods.\n"
      "It checks all results first. tools/bench builds and starts it.",
      kProgram};
  add_options(app, options);
  if (const auto exit_code = parse_arguments(app, argc, argv)) return *exit_code;
  if (options.quick) options.repetitions = 50;
  if (!options.once.empty()) return call_once(options);
  if (options.search_s > 0.0) return search(options);
  if (!options.store.empty()) {
    const Result<void> stored = store_pictures(options.store[0], options.store[1], options.store[2], options.store[3]);
    return stored.ok() ? kExitOk : fail(kProgram, stored.text());
  }

  BenchmarkCases cases;
  if (const Result<void> added = add_cases(cases, options.filter, options.pictures); !added.ok())
    return fail(kProgram, added.text());
  for (const auto& benchmark : cases) {
    for (const Method& method : benchmark->methods) {
      if (options.list) std::printf("%s/%s\n", benchmark->name.c_str(), method.name.c_str());
    }
  }
  if (options.list) return kExitOk;
  if (options.check) {
    std::printf("%zu frames: all methods find the right regions\n", cases.size());
    return kExitOk;
  }
  static StepBenchmark step;
  if (const Result<void> added = add_step(cases, step, options.filter); !added.ok()) {
    return fail(kProgram, "step: " + added.text());
  }
  if (cases.empty()) return fail(kProgram, "no frame's name contains \"" + options.filter + "\"", kExitBadCommandLine);
  measure(cases, options.repetitions);
  const std::vector<Goal> goals = goals_of(cases);
  print_table(cases);
  print_goals(goals);
  print_memory();
  if (options.json.empty()) return kExitOk;
  const Result<void> written = write_json(options.json, cases, goals, options.repetitions);
  return written.ok() ? kExitOk : fail(kProgram, written.text());
}

}  // namespace
}  // namespace touchline::testing

int main(int argc, char** argv) { return touchline::testing::run(argc, argv); }
