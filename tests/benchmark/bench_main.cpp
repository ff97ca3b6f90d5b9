#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "tests/benchmark/measurement.h"
#include "tests/benchmark/step_subject.h"

namespace touchline::testing {
namespace {

constexpr char kHelp[] =
    "How long classification and regions take, against reading the frame once and against what one would use instead.\n"
    "Checks all results first. Started by tools/bench, which builds it.\n"
    "  --quick            50 repetitions instead of 500\n"
    "  --repetitions N    that many, 1 to 100000\n"
    "  --filter TEXT      only frames whose names contain it\n"
    "  --json FILE        also writes all times there\n"
    "  --check            checks, measures nothing\n"
    "  --search SECONDS   looks for the slowest picture instead (--seed N) and prints how to make it\n"
    "  --list             names of what --once can call\n"
    "  --once FRAME/WHAT  one call of `counted_call`, for a profiler that counts instructions\n";

struct Options {
  std::string filter, json, once;
  std::size_t repetitions = 500;
  double search_s = 0.0;
  unsigned seed = 1;
  bool check = false, list = false;
};

// False: the command line is wrong.
bool parse(int argc, char** argv, Options& options) {
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (option == "--quick") {
      options.repetitions = 50;
    } else if (option == "--check") {
      options.check = true;
    } else if (option == "--list") {
      options.list = true;
    } else if (i + 1 == argc) {
      return false;
    } else if (option == "--filter") {
      options.filter = argv[++i];
    } else if (option == "--json") {
      options.json = argv[++i];
    } else if (option == "--once") {
      options.once = argv[++i];
    } else {
      char* end = nullptr;
      const double number = std::strtod(argv[++i], &end);
      if (*end != '\0' || !(number >= 1.0) || number > 100000.0) return false;
      if (option == "--repetitions") {
        options.repetitions = static_cast<std::size_t>(number);
      } else if (option == "--search") {
        options.search_s = number;
      } else if (option == "--seed") {
        options.seed = static_cast<unsigned>(number);
      } else {
        return false;
      }
    }
  }
  return true;
}

[[gnu::noinline]] void counted_call(const std::function<void()>& work) { work(); }

int call_once(const Options& options) {
  const std::size_t slash = options.once.find('/');
  const std::string frame = options.once.substr(0, slash);
  for (const auto& subject : make_subjects(frame)) {
    if (subject->name != frame || slash == std::string::npos) continue;
    if (const std::string wrong = add_methods(*subject); !wrong.empty()) {
      std::fprintf(stderr, "touchline-bench: %s: %s\n", frame.c_str(), wrong.c_str());
      return 1;
    }
    for (const Method& method : subject->methods) {
      if (options.once.substr(slash + 1) != method.name) continue;
      method.work();  // grows the peers' memory to its size
      counted_call(method.work);
      return 0;
    }
  }
  std::fprintf(stderr, "touchline-bench: there is no %s\n", options.once.c_str());
  return 64;
}

// The whole way of a frame, beside its first stage alone.
std::string add_step(Subjects& subjects, StepSubject& step, const std::string& part) {
  auto subject = std::make_unique<Subject>(Subject{
      .name = "step, ten robots and ball", .picture = OwnedPicture(PixelFormat::kRgb24, 1, 1, 0), .parameters = {}});
  if (subject->name.find(part) == std::string::npos) return {};
  if (std::string wrong = step.prepare(TOUCHLINE_BOARDS "/mock/board.toml"); !wrong.empty()) return wrong;
  subject->methods.push_back({"scan", [&step] { step.scan_only(); }, {}});
  subject->methods.push_back({"step", [&step] { static_cast<void>(step.step()); }, {}});
  subjects.push_back(std::move(subject));
  return {};
}

int run(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], "--help") == 0) {
    std::fputs(kHelp, stdout);
    return 0;
  }
  Options options;
  if (!parse(argc, argv, options)) {
    std::fputs(kHelp, stderr);
    return 64;
  }
  if (!options.once.empty()) return call_once(options);
  if (options.search_s > 0.0) {
    search(options.search_s, options.seed);
    return 0;
  }

  Subjects subjects = make_subjects(options.filter);
  for (const auto& subject : subjects) {
    const std::string wrong = add_methods(*subject);
    if (!wrong.empty()) {
      std::fprintf(stderr, "touchline-bench: %s: %s\n", subject->name.c_str(), wrong.c_str());
      return 1;
    }
    for (const Method& method : subject->methods) {
      if (options.list) std::printf("%s/%s\n", subject->name.c_str(), method.name.c_str());
    }
  }
  if (options.list) return 0;
  if (options.check) {
    std::printf("%zu frames, the right regions on each\n", subjects.size());
    return 0;
  }
  static StepSubject step;
  if (const std::string wrong = add_step(subjects, step, options.filter); !wrong.empty()) {
    std::fprintf(stderr, "touchline-bench: step: %s\n", wrong.c_str());
    return 1;
  }
  if (subjects.empty()) {
    std::fprintf(stderr, "touchline-bench: no frame is called %s\n", options.filter.c_str());
    return 64;
  }
  measure(subjects, options.repetitions);
  const std::vector<Goal> goals = goals_of(subjects);
  print_table(subjects);
  print_goals(goals);
  print_memory();
  if (!options.json.empty() && !write_json(options.json, subjects, goals, options.repetitions)) {
    std::fprintf(stderr, "touchline-bench: cannot write %s\n", options.json.c_str());
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace touchline::testing

int main(int argc, char** argv) { return touchline::testing::run(argc, argv); }
