#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "firmware/config/configuration.h"
#include "hal/files/output_file.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/control/ball_drill.h"
#include "tools/programs/control/crowd_drill.h"
#include "tools/programs/control/drive_drill.h"
#include "tools/programs/control/pose_drill.h"
#include "tools/programs/control/tracking_drill.h"

namespace touchline::control_evaluation {
namespace {

struct Options {
  std::string board = "boards/mock/board.toml", json;
  std::vector<std::string> overrides, only;
  std::uint64_t seed = 1;
  bool quick = false;
};

// One line of the table: a figure and its goal.
struct Row {
  std::string drill, figure;
  double value = 0.0, goal = 0.0;
  bool at_least = false;  // the goal is a lower limit

  [[nodiscard]] bool reached() const { return at_least ? value >= goal : value <= goal; }
};

class Report {
 public:
  void most(std::string drill, std::string figure, double value, double goal) {
    add({std::move(drill), std::move(figure), value, goal, false});
  }
  void least(std::string drill, std::string figure, double value, double goal) {
    add({std::move(drill), std::move(figure), value, goal, true});
  }
  [[nodiscard]] std::string json() const {
    nlohmann::json rows = nlohmann::json::array();
    for (const Row& row : rows_) {
      rows.push_back({{"drill", row.drill},
                      {"figure", row.figure},
                      {"value", row.value},
                      {"goal", row.goal},
                      {"at_least", row.at_least},
                      {"reached", row.reached()}});
    }
    return nlohmann::json{{"schema", "touchline-control/1"}, {"rows", rows}}.dump(1) + "\n";
  }

 private:
  void add(Row row) {
    if (rows_.empty()) std::printf("%-36s %-46s %9s   %s\n", "drill", "figure", "value", "goal");
    std::printf("%-36s %-46s %9.2f   %s %.2f%s\n", row.drill.c_str(), row.figure.c_str(), row.value,
                row.at_least ? ">=" : "<=", row.goal, row.reached() ? "" : "  (!)");
    std::fflush(stdout);
    rows_.push_back(std::move(row));
  }
  std::vector<Row> rows_;
};

Result<void> evaluate_poses(const config::Configuration& configuration, const Options& options, Report& report) {
  TOUCHLINE_TRY_ASSIGN(const PoseResult poses, pose_drill(configuration, options.quick ? 40 : 200, options.seed));
  const std::string name = "go to a pose";
  report.most(name, "time / (bound + 0.15 s), median", poses.median, 1.05);
  report.most(name, "time / (bound + 0.15 s), p95", poses.p95, 1.3);
  report.least(name, "arrived within 3 mm and 1 degree, %", 100.0 * poses.arrived, 95.0);
  report.most(name, "error after arrival, p95, mm", poses.p95_mm, 3.0);
  return {};
}

Result<void> evaluate_eight(const config::Configuration& configuration, const Options& options, Report& report,
                            const std::string& name, const TrackingSettings& settings) {
  const std::uint64_t seeds = options.quick ? 2 : 6;
  double sum2 = 0.0, bound = 0.0;
  for (std::uint64_t i = 0; i < seeds; ++i) {
    TOUCHLINE_TRY_ASSIGN(const TrackingResult one, tracking_drill(configuration, settings, options.seed + i));
    sum2 += one.rms_mm * one.rms_mm;
    bound = one.bound_mm;
  }
  const auto limits = settings.rate_hz < 60.0 ? 7.8 : settings.true_delay_s ? 15.6 : 10.4;
  char figure[64];
  std::snprintf(figure, sizeof figure, "RMS, mm (no controller is below %.1f)", bound);
  report.most(name, figure, std::sqrt(sum2 / static_cast<double>(seeds)), limits);
  return {};
}

Result<void> evaluate_eights(const config::Configuration& configuration, const Options& options, Report& report) {
  TOUCHLINE_TRY(evaluate_eight(configuration, options, report, "figure eight, 1 m/s", {}));
  TOUCHLINE_TRY(
      evaluate_eight(configuration, options, report, "figure eight, 100 ms radio delay", {1.0, 60.0, 0.1, {}}));
  TOUCHLINE_TRY(evaluate_eight(configuration, options, report, "figure eight, 0.5 m/s, 30 Hz", {0.5, 30.0, {}, {}}));
  // The delay is measured before the rounds that count.
  constexpr double kMeasured_s = 15.0;
  TOUCHLINE_TRY(
      evaluate_eight(configuration, options, report, "figure eight, 60 ms delay", {1.0, 60.0, 0.06, {}, kMeasured_s}));
  return evaluate_eight(configuration, options, report, "figure eight, 60 ms delay, file: 18",
                        {1.0, 60.0, 0.06, 0.018, kMeasured_s});
}

Result<void> evaluate_ball(const config::Configuration& configuration, const Options& options, Report& report) {
  TOUCHLINE_TRY_ASSIGN(const BallResult ball, ball_drill(configuration, options.quick ? 20 : 100, options.seed));
  const std::string name = "ball rolling at 1 m/s";
  report.least(name, "met within 0.5 s of the oracle, %", 100.0 * ball.in_time, 85.0);
  report.least(name, "met, %", 100.0 * ball.met, 85.0);
  report.most(name, "behind the oracle, median, s", ball.median_late_s, 0.5);
  return {};
}

Result<void> evaluate_crowds(const config::Configuration& configuration, const Options& options, Report& report) {
  CrowdSettings settings;
  settings.duration_s = options.quick ? 30.0 : 240.0;
  TOUCHLINE_TRY_ASSIGN(const CrowdResult crowd, crowd_drill(configuration, settings, options.seed));
  const std::string name = "5 + 5 robots to random goals";
  report.most(name, "own-own contacts per robot and minute", crowd.own_contacts, 0.5);
  report.most(name, "contacts with opponents per robot and minute", crowd.mixed_contacts, 0.5);
  report.least(name, "goals per robot and minute", crowd.goals_per_minute, 35.0);
  CrowdSettings strict{11, 0, settings.duration_s, 0.2, true};
  TOUCHLINE_TRY_ASSIGN(const CrowdResult lab, crowd_drill(configuration, strict, options.seed));
  const std::string strict_name = "11 robots at 0.2 m/s, strict";
  report.most(strict_name, "contacts per robot and minute", lab.own_contacts, 0.0);
  report.least(strict_name, "goals of the slowest robot per minute", lab.least_goals_per_minute, 10.0);
  return {};
}

// Squares of errors over games.
struct ErrorSums {
  double delay2 = 0.0, lag2 = 0.0, gain2 = 0.0, sigmas2 = 0.0;
  int games = 0, wheels = 0, known = 0;

  void add(const DriveErrors& one) {
    ++games;
    known += one.is_delay_known && one.is_lag_known ? 1 : 0;
    delay2 += one.delay_s * one.delay_s;
    lag2 += one.lag_s * one.lag_s;
    wheels += one.known_robots;
    gain2 += one.known_robots * one.gain * one.gain;
    sigmas2 += (one.delay_sigmas * one.delay_sigmas + one.lag_sigmas * one.lag_sigmas) / 2.0;
  }
};

Result<void> evaluate_drives(const config::Configuration& configuration, const Options& options, Report& report) {
  struct Case {
    const char* name;
    DriveTruth truth;
  };
  for (const Case& one :
       {Case{"drives: 20 ms, lag 40 ms", {0.020, 0.04}}, Case{"drives: 60 ms, lag 80 ms", {0.06, 0.08}},
        Case{"drives: 120 ms, lag 160 ms", {0.12, 0.16}},
        Case{"drives: 60 ms, lag 80 ms, 30 Hz", {0.06, 0.08, 0.02, 30.0}},
        Case{"drives: 60 ms, lag 80 ms, 90 Hz", {0.06, 0.08, 0.02, 90.0}},
        Case{"drives: 60 ms, jitter 10 ms, loss 10 %", {0.06, 0.08, 0.02, 60.0, 0.01, 0.1}},
        Case{"drives: 60 ms, slip 10 %", {0.06, 0.08, 0.02, 60.0, 0.003, 0.03, 0.1}}}) {
    ErrorSums sums;
    for (std::uint64_t i = 0; i < (options.quick ? 2 : 10); ++i) {
      TOUCHLINE_TRY_ASSIGN(const DriveErrors errors, drive_drill(configuration, one.truth, options.seed + i));
      sums.add(errors);
    }
    const auto rms = [](double square, int count) { return std::sqrt(square / std::max(count, 1)); };
    report.least(one.name, "games with known delay and lag, %", 100.0 * sums.known / sums.games, 100.0);
    report.most(one.name, "delay after 10 s, RMS of errors, ms", 1e3 * rms(sums.delay2, sums.games), 3.0);
    report.most(one.name, "lag after 30 s, RMS of errors, ms", 1e3 * rms(sums.lag2, sums.games), 10.0);
    report.most(one.name, "known gains after 30 s, RMS of errors, %", 100.0 * rms(sums.gain2, sums.wheels), 0.5);
    report.most(one.name, "errors in stated standard deviations, RMS", rms(sums.sigmas2, sums.games), 2.0);
  }
  return {};
}

Result<void> run(const Options& options) {
  config::Configuration configuration;
  TOUCHLINE_TRY(config::load({options.board, "", "", options.overrides}, configuration));
  Report report;
  const auto wanted = [&](const char* name) {
    return options.only.empty() || std::find(options.only.begin(), options.only.end(), name) != options.only.end();
  };
  if (wanted("poses")) TOUCHLINE_TRY(evaluate_poses(configuration, options, report));
  if (wanted("eights")) TOUCHLINE_TRY(evaluate_eights(configuration, options, report));
  if (wanted("ball")) TOUCHLINE_TRY(evaluate_ball(configuration, options, report));
  if (wanted("drives")) TOUCHLINE_TRY(evaluate_drives(configuration, options, report));
  if (wanted("crowds")) TOUCHLINE_TRY(evaluate_crowds(configuration, options, report));
  if (options.json.empty()) return {};
  return hal::write_file(options.json, report.json());
}

}  // namespace
}  // namespace touchline::control_evaluation

int main(int argc, char** argv) {
  using namespace touchline;
  control_evaluation::Options options;
  CLI::App app(
      "Measures how robots drive in the arena without pictures: to poses, on trajectories, to a rolling ball, and "
      "among\n"
      "other robots; and how well their delay, lag and wheel gains are measured during games. Prints a table with "
      "goals; (!) marks a goal that is not reached",
      "touchline-control");
  app.add_option("--board", options.board, "Board file of the arena")->type_name("FILE")->capture_default_str();
  app.add_option("--only", options.only, "Only these drills: poses, eights, ball, crowds, drives")
      ->check(CLI::IsMember({"poses", "eights", "ball", "crowds", "drives"}));
  app.add_option("--seed", options.seed, "Seed of the random numbers")->capture_default_str();
  app.add_flag("--quick", options.quick, "Fewer runs");
  app.add_option("--json", options.json, "Write all figures to this file")->type_name("FILE");
  add_overrides(app, options.overrides, "the three files");
  add_examples(app, {{"touchline-control --json control.json", "measure this build"},
                     {"touchline-control --only eights --set arena.physics.wheel_lag_s=0.12", "other robots"}});
  if (const auto exit_code = parse_arguments(app, argc, argv)) return *exit_code;
  const Result<void> done = control_evaluation::run(options);
  return done.ok() ? kExitOk : fail("touchline-control", done.text());
}
