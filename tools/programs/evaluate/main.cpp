#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <memory>

#include "firmware/config/configuration.h"
#include "hal/files/output_file.h"
#include "hal/replay/replay_camera.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/evaluate/cramer_rao_bound.h"
#include "tools/programs/evaluate/motion_evaluation.h"
#include "tools/programs/evaluate/report.h"
#include "tools/programs/evaluate/result_comparison.h"

namespace {

using namespace touchline;
using namespace touchline::evaluate;

struct Options {
  std::vector<std::string> files;
  std::string annotated, json;
  std::string pictures, venue, team;
  std::string board;
  std::vector<std::string> overrides;
  std::uint64_t seed = 1;
  double duration_s = 30.0, hide_s = 0.0;
  bool spread = false, without_pictures = false;
  double seen_within_m = 0.02;
  PictureTolerance tolerance;
  std::vector<std::string> names;
};

int fail(const std::string& message) { return touchline::fail("touchline-evaluate", message); }

Result<NameMap> parse_names(const std::vector<std::string>& texts) {
  NameMap names;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      return failure(ErrorCode::kOutOfRange, "--name %s: must be NAME_IN_RESULT=NAME_IN_TRUTH", text.c_str());
    }
    names[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return names;
}

Result<void> write_json(const std::string& path, const std::string& text) {
  return path.empty() ? Result<void>() : hal::write_file(path, text);
}

Result<std::vector<FrameRecord>> read_results(const std::vector<std::string>& paths, const NameMap& names) {
  std::vector<FrameRecord> all;
  for (const std::string& path : paths) {
    TOUCHLINE_TRY_ASSIGN(const std::vector<FrameRecord> records, read_result(path, names));
    all.insert(all.end(), records.begin(), records.end());
  }
  return all;
}

Result<BoundInputs> bound_inputs(const Options& options) {
  const auto files = std::make_unique<config::Configuration>();
  TOUCHLINE_TRY(config::load_venue_and_team({{}, options.venue, options.team, {}}, *files));
  const PixelFormat format = hal::replay_format(files->venue.colors.space);
  const auto& picture = files->venue.picture;
  TOUCHLINE_TRY(config::resolve({format, picture.width_px, picture.height_px, options.pictures}, *files));
  BoundInputs inputs;
  if (!inputs.camera.configure(files->pipeline.camera).ok()) {
    return failure(ErrorCode::kInconsistent, "%s: the camera model has invalid values", options.venue.c_str());
  }
  inputs.layouts = {files->pipeline.marker.teams[0].layout, files->pipeline.marker.teams[1].layout};
  inputs.teams = {files->team.own.color, files->team.opponent.color};
  return inputs;
}

// With --pictures: prints the Cramer-Rao bounds and adds them to `json`.
Result<void> add_bounds(const Options& options, std::string& json) {
  if (options.pictures.empty()) return {};
  TOUCHLINE_TRY_ASSIGN(const BoundInputs inputs, bound_inputs(options));
  // The names are those of the team file, independent of --name.
  TOUCHLINE_TRY_ASSIGN(const std::vector<FrameRecord> results, read_result(options.files.back(), {}));
  TOUCHLINE_TRY_ASSIGN(const std::vector<PoseBound> bounds, cramer_rao_bounds(results, options.pictures, inputs));
  std::cout << '\n';
  print(bounds, std::cout);
  json = with_bounds(json, bounds);
  return {};
}

Result<void> compare_two_results(const Options& options, const NameMap& names) {
  std::array<std::vector<FrameRecord>, 2> results;
  for (std::size_t i = 0; i < results.size(); ++i) {
    TOUCHLINE_TRY_ASSIGN(results[i], read_result(options.files[i], names));
  }
  TOUCHLINE_TRY_ASSIGN(const ResultComparison comparison,
                       compare_results(results[0], results[1], options.seen_within_m));
  print(comparison, std::cout);
  return write_json(options.json, to_json(comparison));
}

Result<void> compare_with_truth(const Options& options, const NameMap& names) {
  if (options.files.size() != 2) {
    return failure(ErrorCode::kOutOfRange,
                   "needs two files, TRUTH.jsonl or RESULT.jsonl, and RESULT.jsonl (see --help)");
  }
  TOUCHLINE_TRY_ASSIGN(const bool has_no_truth, is_result(options.files[0]));
  if (has_no_truth && options.pictures.empty()) return compare_two_results(options, names);
  TOUCHLINE_TRY_ASSIGN(const std::vector<FrameRecord> truth, read_truth(options.files[0]));
  TOUCHLINE_TRY_ASSIGN(const std::vector<FrameRecord> result, read_result(options.files[1], names));
  TOUCHLINE_TRY_ASSIGN(const PoseReport report, evaluate_poses(truth, result, options.seen_within_m));
  print(report, options.seen_within_m, std::cout);
  std::string json = to_json(report, options.seen_within_m);
  TOUCHLINE_TRY(add_bounds(options, json));
  return write_json(options.json, json);
}

Result<void> show_spread(const Options& options, const NameMap& names) {
  TOUCHLINE_TRY_ASSIGN(const std::vector<FrameRecord> result, read_results(options.files, names));
  const std::vector<PoseSpread> spread = pose_spreads(result);
  print(spread, result.size(), std::cout);
  std::string json = to_json(spread, result.size());
  TOUCHLINE_TRY(add_bounds(options, json));
  return write_json(options.json, json);
}

Result<std::vector<std::string>> annotation_files(const std::string& path) {
  std::error_code io_error;
  if (!std::filesystem::is_directory(path, io_error)) return std::vector<std::string>{path};
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(path, io_error)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  if (files.empty()) return failure(ErrorCode::kNotFound, "%s: contains no annotations (json)", path.c_str());
  return files;
}

Result<void> compare_with_pictures(const Options& options, const NameMap& names) {
  TOUCHLINE_TRY_ASSIGN(const std::vector<std::string> files, annotation_files(options.annotated));
  TOUCHLINE_TRY_ASSIGN(const std::vector<FrameRecord> results, read_results(options.files, names));
  std::vector<PictureReport> reports;
  std::vector<Error> without_result;
  for (const std::string& file : files) {
    TOUCHLINE_TRY_ASSIGN(const AnnotatedPicture truth, read_annotated(file));
    Result<PictureReport> report = evaluate_picture(truth, results, options.tolerance);
    if (report.ok()) {
      reports.push_back(std::move(report).value());
    } else {
      without_result.push_back(std::move(report).error());
    }
  }
  if (reports.empty()) return without_result.front();
  print(reports, options.tolerance, std::cout);
  for (const Error& error : without_result) std::cout << error.text.str() << '\n';
  return write_json(options.json, to_json(reports, options.tolerance));
}

// Plays a game in the arena and compares tracks and sightings with its ground truth.
Result<void> play_game(const Options& options) {
  constexpr double kSettled_s = 0.5;  // time until tracks are confirmed and robots drive
  if (!options.files.empty()) {
    return failure(ErrorCode::kOutOfRange, "--game plays a game of its own and reads no results");
  }
  const auto game = std::make_unique<RecordedGame>();
  const config::FilePaths files{options.board, {}, {}, options.overrides};
  TOUCHLINE_TRY(options.without_pictures ? game->load_without_pictures(files, options.seed)
                                         : game->load(files, options.seed));
  TOUCHLINE_TRY(game->skip(kSettled_s));
  if (options.hide_s > 0.0) game->hide_robots(options.hide_s, options.duration_s - kSettled_s);
  TOUCHLINE_TRY(game->play(options.duration_s - kSettled_s));
  const MotionReport report = evaluate_motion(*game);
  print(report, std::cout);
  return write_json(options.json, to_json(report));
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Compares the results of touchline-replay with the truth, or with each other.", "touchline-evaluate"};
  app.add_option("files", options.files, "TRUTH.jsonl and RESULT.jsonl, two results, or only results")
      ->type_name("FILE");
  app.add_option("--annotated", options.annotated, "An annotated picture (json), or a folder of them")
      ->type_name("PATH");
  app.add_flag("--spread", options.spread, "RMS and largest deviation of each id from its mean");
  app.add_option("--seen-within", options.seen_within_m,
                 "Largest distance of a report from its robot or ball, or from the other result's, in m (0.02)")
      ->check(number_range(1e-6, 10.0));
  app.add_option("--same-robot", options.tolerance.same_robot_px,
                 "Largest distance of a report from its patch in px (8)")
      ->check(number_range(0.1, 1000.0));
  app.add_option("--good-within", options.tolerance.good_px, "Largest error of a good patch or ball center in px (2)")
      ->check(number_range(0.01, 1000.0));
  app.add_option("--name", options.names, "Translate a team or color: NAME_IN_RESULT=NAME_IN_TRUTH")
      ->allow_extra_args(false);
  CLI::Option* pictures =
      app.add_option("--pictures", options.pictures,
                     "Folder of the result's pictures of a stationary scene: add the Cramer-Rao bound")
          ->type_name("DIR");
  CLI::Option* venue =
      app.add_option("--venue", options.venue, "Venue file with the camera model, for the bound")->type_name("FILE");
  CLI::Option* team =
      app.add_option("--team", options.team, "Team file with the marker layouts, for the bound")->type_name("FILE");
  pictures->needs(venue, team);
  CLI::Option* game = app.add_option("--game", options.board, "Board file whose arena plays a game")->type_name("FILE");
  app.add_option("--duration", options.duration_s, "Duration of the game in s (30)")
      ->check(number_range(1.0, 3600.0))
      ->needs(game);
  app.add_flag("--without-pictures", options.without_pictures,
               "The game's own side sees the arena without pictures, as in touchline-simulate")
      ->needs(game);
  app.add_option("--hide", options.hide_s,
                 "Hide every robot again and again for so long, in s, and compare its track with the truth at the end")
      ->check(number_range(0.02, 10.0))
      ->needs(game);
  app.add_option("--seed", options.seed, "Seed of the game (1)")->needs(game);
  add_overrides(app, options.overrides, "the board, venue and team files")->needs(game);
  app.add_option("--json", options.json, "Write the numbers into this file")->type_name("FILE");
  add_examples(
      app, {{"touchline-evaluate truth.jsonl result.jsonl", "compare poses of rendered or measured scenes"},
            {"touchline-evaluate before.jsonl after.jsonl", "compare two results of a game without a truth"},
            {"touchline-evaluate --annotated truth.json result.jsonl", "compare pixels of pictures annotated by hand"},
            {"touchline-evaluate --spread result.jsonl", "measure the noise of stationary robots, without a truth"},
            {"touchline-evaluate --game board.toml", "compare tracks and sightings of a game in the arena"},
            {"touchline-evaluate --game board.toml --hide 0.3", "measure tracks of robots that are hidden for 0.3 s"}});
  if (const auto exit_code = parse_arguments(app, argc, argv)) return *exit_code;

  if (options.spread && !options.annotated.empty()) return fail("--spread and --annotated exclude each other");
  if (!options.pictures.empty() && !options.annotated.empty()) {
    return fail("--pictures needs results of stationary robots, not --annotated");
  }
  const Result<NameMap> names = parse_names(options.names);
  if (!names.ok()) return fail(names.text());
  if (options.board.empty() && options.files.empty()) {
    return touchline::fail("touchline-evaluate", "needs files, or --game (see --help)", kExitBadCommandLine);
  }
  const Result<void> done = !options.board.empty()      ? play_game(options)
                            : options.spread            ? show_spread(options, names.value())
                            : options.annotated.empty() ? compare_with_truth(options, names.value())
                                                        : compare_with_pictures(options, names.value());
  return done.ok() ? kExitOk : fail(done.text());
}
