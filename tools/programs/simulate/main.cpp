#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "hal/files/input_file.h"
#include "hal/files/output_file.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/command_line/progress.h"
#include "tools/programs/simulate/game_series.h"
#include "tools/programs/simulate/game_video.h"
#include "tools/programs/simulate/scenario.h"
#include "tools/programs/simulate/series_report.h"
#include "tools/programs/simulate/serve_command.h"

namespace touchline::simulate {
namespace {

struct Options {
  std::string board = "boards/mock/board.toml", own = "play", opponent = "univector", baseline, json, preset;
  VideoSettings video;
  std::vector<std::string> overrides, compare;
  SeriesSettings series;
  int robots = 0;
  bool table = false;
  int scenarios = 0;
};

Result<Series> play(const Options& options, const Team& own, const Team& opponent) {
  Progress progress("games of " + own.name + " against " + opponent.name,
                    static_cast<std::size_t>(options.series.seeds));
  return play_series(fair_arena(*own.configuration, options.robots), own, opponent, options.series,
                     [&](int) { progress.step(); });
}

Result<void> write(const Options& options, const std::vector<Series>& all) {
  if (options.json.empty()) return {};
  return hal::write_file(options.json, to_json(all));
}

Result<void> play_table(const Options& options) {
  std::vector<Series> all;
  const std::vector<std::string> names = strategy_names();
  for (const std::string& name : names) {
    TOUCHLINE_TRY_ASSIGN(const Team own, load_team(options.board, name, options.overrides));
    for (const std::string& other : names) {
      TOUCHLINE_TRY_ASSIGN(const Team opponent, load_team(options.board, other, options.overrides));
      TOUCHLINE_TRY_ASSIGN(Series series, play(options, own, opponent));
      all.push_back(std::move(series));
    }
  }
  std::printf("%d games of %.0f s for each pair; mean goal difference of the row's team with its 95 %% interval\n%s",
              options.series.seeds, options.series.duration_s, table_text(names, all).c_str());
  return write(options, all);
}

// Prints the game's figures as those of a series of one game.
Result<void> play_video(const Options& options) {
  TOUCHLINE_TRY_ASSIGN(const Team own, load_team(options.board, options.own, options.overrides));
  TOUCHLINE_TRY_ASSIGN(const Team opponent, load_team(options.board, options.opponent, options.overrides));
  VideoSettings video = options.video;
  video.seed = options.series.first_seed;
  video.duration_s = options.series.duration_s;
  video.view = options.series.view;
  Progress progress("pictures of " + own.name + " against " + opponent.name,
                    static_cast<std::size_t>(video.duration_s * video.rate_hz) + 1);
  TOUCHLINE_TRY_ASSIGN(const GameResult game, record_game(fair_arena(*own.configuration, options.robots), own, opponent,
                                                          video, [&] { progress.step(); }));
  const std::vector<Series> all{{own.name, opponent.name, video.duration_s, video.view, {game}, 0.0}};
  std::fputs(series_text(all[0]).c_str(), stdout);
  return write(options, all);
}

Result<void> play_pair(const Options& options) {
  TOUCHLINE_TRY_ASSIGN(const Team own, load_team(options.board, options.own, options.overrides));
  TOUCHLINE_TRY_ASSIGN(const Team opponent, load_team(options.board, options.opponent, options.overrides));
  std::vector<Series> all;
  if (!options.baseline.empty()) {
    TOUCHLINE_TRY_ASSIGN(const Team baseline, load_team(options.board, options.baseline, options.overrides));
    TOUCHLINE_TRY_ASSIGN(Series series, play(options, baseline, opponent));
    all.push_back(std::move(series));
  }
  TOUCHLINE_TRY_ASSIGN(Series series, play(options, own, opponent));
  all.push_back(std::move(series));
  for (const Series& each : all) std::fputs(series_text(each).c_str(), stdout);
  if (all.size() == 2) {
    TOUCHLINE_TRY_ASSIGN(const Comparison comparison, compare(all[0], all[1]));
    std::fputs(comparison_text(all[0], all[1], comparison).c_str(), stdout);
  }
  return write(options, all);
}

// A game needs about 520 bytes: enough for 380,000 games.
constexpr std::size_t kMaxFile = 200'000'000;

Result<std::vector<Series>> read(const std::string& path) {
  TOUCHLINE_TRY_ASSIGN(const std::string text, hal::read_file(path, kMaxFile));
  Result<std::vector<Series>> all = from_json(text);
  if (!all.ok()) return prefixed(path, std::move(all).error());
  return all;
}

// Compares each series of the second file with that of the first one against the same opponent.
Result<void> compare_files(const std::string& first, const std::string& second) {
  TOUCHLINE_TRY_ASSIGN(const std::vector<Series> before, read(first));
  TOUCHLINE_TRY_ASSIGN(const std::vector<Series> after, read(second));
  bool found = false;
  for (const Series& b : after) {
    for (const Series& a : before) {
      if (a.opponent != b.opponent || (after.size() > 1 && a.own != b.own)) continue;
      TOUCHLINE_TRY_ASSIGN(const Comparison comparison, compare(a, b));
      std::fputs(comparison_text(a, b, comparison).c_str(), stdout);
      found = true;
    }
  }
  if (found) return {};
  return failure(ErrorCode::kInconsistent, "%s and %s have no opponent in common", first.c_str(), second.c_str());
}

Result<void> play_scenarios(const Options& options) {
  TOUCHLINE_TRY_ASSIGN(const Team own, load_team(options.board, options.own, options.overrides));
  TOUCHLINE_TRY_ASSIGN(const std::string text, scenario_text(own, options.scenarios));
  std::fputs(text.c_str(), stdout);
  return {};
}

Result<void> run(Options options) {
  if (!options.preset.empty()) {
    TOUCHLINE_TRY_ASSIGN(std::vector<std::string> overrides, preset_overrides(options.preset));
    overrides.insert(overrides.end(), options.overrides.begin(), options.overrides.end());
    options.overrides = std::move(overrides);
  }
  if (options.scenarios > 0) return play_scenarios(options);
  if (!options.compare.empty()) return compare_files(options.compare[0], options.compare[1]);
  if (!options.video.path.empty()) return play_video(options);
  return options.table ? play_table(options) : play_pair(options);
}

// What the program does instead of playing a series with one own side, and the options that have no meaning then.
void exclude(CLI::App& app, const char* option, std::initializer_list<const char*> others) {
  for (const char* other : others) app.get_option(option)->excludes(app.get_option(other));
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("--board", options.board, "Board file of the arena")->type_name("FILE")->capture_default_str();
  app.add_option("--own", options.own, "Who plays for the own side: a strategy or a team file")
      ->type_name("TEAM")
      ->capture_default_str();
  app.add_option("--opponent", options.opponent, "Who plays for the other side: a strategy or a team file")
      ->type_name("TEAM")
      ->capture_default_str();
  app.add_option("--baseline", options.baseline,
                 "Play the same seeds also with this own side, and compare both with --own")
      ->type_name("TEAM");
  app.add_option(
         "--preset", options.preset,
         "Parameter set of the robots and the ball, which both sides know: mirosot, rsim or firasim (default: as "
         "in the three files); --set wins over it")
      ->type_name("NAME");
  app.add_option("--seeds", options.series.seeds, "Number of games, each with its own random numbers")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--first-seed,--seed", options.series.first_seed, "Seed of the first game, or of the only one")
      ->capture_default_str();
  app.add_option("--duration", options.series.duration_s, "Length of a game in s")
      ->check(number_range(1.0, 36000.0))
      ->capture_default_str();
  app.add_option("--robots", options.robots, "Robots of each side (default: as in the board file)")
      ->check(CLI::Range(1, 11));
  app.add_flag_callback(
      "--pictures", [&options] { options.series.view = OwnView::kPictures; },
      "Let the own side see rendered pictures, as `touchline run` does; about as fast as real time");
  app.add_flag("--table", options.table, "Let every strategy play against every strategy");
  app.add_option("--scenarios", options.scenarios,
                 "Instead of games, play this many trials of each situation with the side --own: a resting ball in the "
                 "field and at a wall, and shots at the goalkeeper")
      ->check(CLI::Range(1, 100000));
  app.add_option(
         "--video", options.video.path,
         "Play the game of --seed alone and draw it from above, with what each robot does: a video (.mp4), or a "
         "folder of PNG files")
      ->type_name("PATH");
  app.add_option("--video-rate", options.video.rate_hz, "Pictures per second of the game for --video")
      ->check(number_range(0.01, 200.0))
      ->capture_default_str();
  app.add_option("--jobs", options.series.jobs, "Games that are played at the same time (default: one per processor)")
      ->check(CLI::Range(1, 256));
  app.add_option("--json", options.json, "Write all results to this file")->type_name("FILE");
  app.add_option("--compare", options.compare, "Compare two files of --json, for example of two builds")
      ->type_name("FILE")
      ->expected(2);
  add_overrides(app, options.overrides, "the three files");
  app.get_option("--video-rate")->needs(app.get_option("--video"));
  exclude(app, "--table", {"--own", "--opponent", "--baseline"});
  exclude(app, "--video", {"--seeds", "--jobs", "--baseline", "--table"});
  exclude(app, "--scenarios",
          {"--opponent", "--baseline", "--seeds", "--seed", "--duration", "--robots", "--pictures", "--table",
           "--video", "--jobs", "--json"});
  exclude(app, "--compare",
          {"--board", "--own", "--opponent", "--baseline", "--seeds", "--seed", "--duration", "--robots", "--pictures",
           "--table", "--scenarios", "--video", "--jobs", "--json", "--preset", "--set"});
}

}  // namespace
}  // namespace touchline::simulate

int main(int argc, char** argv) {
  using namespace touchline;
  simulate::Options options;
  options.series.jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  CLI::App app(
      "Plays games of the arena, without pictures many times faster than real time, and says how sure the result\n"
      "is. Both sides have their own camera errors, tracker, radio and robots. A side is a strategy:\n" +
          simulate::strategies_text() + "or a team file (.toml), whose settings the built-in play uses",
      "touchline-simulate");
  simulate::add_options(app, options);
  add_examples(app, {{"touchline-simulate --opponent univector --seeds 100", "measure the built-in play"},
                     {"touchline-simulate --own new.toml --baseline team.toml", "compare two team files"},
                     {"touchline-simulate --table --seeds 10 --duration 120", "everybody against everybody"},
                     {"touchline-simulate --video game.mp4 --seed 7 --duration 60", "watch a game"}});
  simulate::ServeOptions serve_options;
  serve_options.board = options.board;
  const CLI::App* const serve = simulate::add_serve_command(app, serve_options);
  app.require_subcommand(0, 1);
  if (const auto exit_code = parse_arguments(app, argc, argv)) return *exit_code;
  if (const std::string ignored = ignored_option(app, *serve); !ignored.empty()) {
    return fail("touchline-simulate", ignored, kExitBadCommandLine);
  }
  const Result<void> done = serve->parsed() ? simulate::run_serve(serve_options) : simulate::run(options);
  return done.ok() ? kExitOk : fail("touchline-simulate", done.text());
}
