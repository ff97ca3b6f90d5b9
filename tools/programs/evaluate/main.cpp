#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "firmware/config/configuration.h"
#include "hal/linux/files/output_file.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/evaluate/cramer_rao_bound.h"
#include "tools/programs/evaluate/report.h"

namespace {

using namespace touchline::evaluate;

struct Options {
  std::vector<std::string> files;
  std::string annotated, json;
  std::string pictures, venue, team;
  bool spread = false;
  double seen_within_m = 0.02;
  PictureTolerance tolerance;
  std::vector<std::string> names;
};

int fail(const std::string& message) {
  std::cerr << "touchline-evaluate: " << message << '\n';
  return 1;
}

bool parse_names(const std::vector<std::string>& texts, NameMap& names, std::string& error) {
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      error = "--name " + text + ": must be NAME_IN_RESULT=NAME_IN_TRUTH";
      return false;
    }
    names[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return true;
}

bool write_json(const std::string& path, const std::string& text, std::string& error) {
  return path.empty() || touchline::hal::write_file(path, text, error).ok();
}

bool read_results(const std::vector<std::string>& paths, const NameMap& names, std::vector<FrameRecord>& all,
                  std::string& error) {
  for (const std::string& path : paths) {
    std::vector<FrameRecord> records;
    if (!read_result(path, names, records, error)) return false;
    all.insert(all.end(), records.begin(), records.end());
  }
  return true;
}

// How far the measured noise is above its bound, for `json` as well; nothing without --pictures.
bool show_bounds(const Options& options, std::string& json, std::string& error) {
  if (options.pictures.empty()) return true;
  namespace config = touchline::config;
  const auto files = std::make_unique<config::Configuration>();
  config::Problems problems;
  const auto usable = [&] {
    if (!config::load_venue_and_team({{}, options.venue, options.team, {}}, *files, problems).ok()) return false;
    const auto format = files->venue.colors.space == touchline::ColorSpace::kRgb ? touchline::PixelFormat::kRgb24
                                                                                 : touchline::PixelFormat::kYuyv;
    const auto& picture = files->venue.picture;
    return config::resolve({format, picture.width_px, picture.height_px, options.pictures}, *files, problems).ok();
  };
  BoundInputs setting;
  if (!usable()) {
    error = problems.text();
    while (!error.empty() && error.back() == '\n') error.pop_back();
    return false;
  }
  if (!setting.camera.configure(files->pipeline.camera).ok()) {
    error = options.venue + ": the camera model refuses its values";
    return false;
  }
  setting.layouts = {files->pipeline.marker.teams[0].layout, files->pipeline.marker.teams[1].layout};
  setting.teams = {files->team.own.color, files->team.opponent.color};
  std::vector<FrameRecord> results;
  // By the names of the team file, whatever --name says.
  if (!read_result(options.files.back(), {}, results, error)) return false;
  std::vector<PoseBound> bounds;
  if (!cramer_rao_bounds(results, options.pictures, setting, bounds, error)) return false;
  std::cout << '\n';
  print(bounds, std::cout);
  json = with_bounds(json, bounds);
  return true;
}

int compare_with_truth(const Options& options, const NameMap& names) {
  std::string error;
  std::vector<FrameRecord> truth, result;
  if (options.files.size() != 2) return fail("needs two files, TRUTH.jsonl and RESULT.jsonl (see --help)");
  if (!read_truth(options.files[0], truth, error) || !read_result(options.files[1], names, result, error))
    return fail(error);
  PoseReport report;
  if (!evaluate_poses(truth, result, options.seen_within_m, report, error)) return fail(error);
  print(report, options.seen_within_m, std::cout);
  std::string json = to_json(report, options.seen_within_m);
  return show_bounds(options, json, error) && write_json(options.json, json, error) ? 0 : fail(error);
}

int show_spread(const Options& options, const NameMap& names) {
  std::string error;
  std::vector<FrameRecord> result;
  if (!read_results(options.files, names, result, error)) return fail(error);
  const std::vector<PoseSpread> spread = pose_spreads(result);
  print(spread, result.size(), std::cout);
  std::string json = to_json(spread, result.size());
  return show_bounds(options, json, error) && write_json(options.json, json, error) ? 0 : fail(error);
}

int compare_with_pictures(const Options& options, const NameMap& names) {
  std::string error;
  std::vector<std::string> files;
  std::error_code io_error;
  if (std::filesystem::is_directory(options.annotated, io_error)) {
    for (const auto& entry : std::filesystem::directory_iterator(options.annotated, io_error)) {
      if (entry.path().extension() == ".json") files.push_back(entry.path().string());
    }
    std::sort(files.begin(), files.end());
    if (files.empty()) return fail(options.annotated + ": holds no annotation (json)");
  } else {
    files.push_back(options.annotated);
  }
  std::vector<FrameRecord> results;
  if (!read_results(options.files, names, results, error)) return fail(error);
  std::vector<PictureReport> reports;
  std::vector<std::string> without;
  for (const std::string& file : files) {
    AnnotatedPicture truth;
    if (!read_annotated(file, truth, error)) return fail(error);
    PictureReport report;
    if (evaluate_picture(truth, results, options.tolerance, report, error)) {
      reports.push_back(report);
    } else {
      without.push_back(error);
    }
  }
  if (reports.empty()) return fail(without.front());
  print(reports, options.tolerance, std::cout);
  for (const std::string& line : without) std::cout << line << '\n';
  return write_json(options.json, to_json(reports, options.tolerance), error) ? 0 : fail(error);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Holds what touchline-replay saw against the truth.\n"
      "  touchline-evaluate TRUTH.jsonl RESULT.jsonl            poses of rendered or measured scenes\n"
      "  touchline-evaluate --annotated TRUTH.json RESULT.jsonl...  pixels of pictures annotated by hand (or a "
      "folder)\n"
      "  touchline-evaluate --spread RESULT.jsonl               noise of what stands still, without any truth",
      "touchline-evaluate"};
  app.add_option("files", options.files, "TRUTH.jsonl and RESULT.jsonl; else only results")->required();
  app.add_option("--annotated", options.annotated, "An annotated picture (json), or a folder of them");
  app.add_flag("--spread", options.spread, "RMS and largest distance of each id from its mean");
  app.add_option("--seen-within", options.seen_within_m, "Meters within which a robot or ball is the same (0.02)")
      ->check(touchline::number_range(1e-6, 10.0));
  app.add_option("--same-robot", options.tolerance.same_robot_px, "Pixels within which a patch is the same (8)")
      ->check(touchline::number_range(0.1, 1000.0));
  app.add_option("--good-within", options.tolerance.good_px, "Pixels within which a patch or ball is good (2)")
      ->check(touchline::number_range(0.01, 1000.0));
  app.add_option("--name", options.names, "Team or color that the truth calls otherwise: NAME_IN_RESULT=NAME_IN_TRUTH")
      ->allow_extra_args(false);
  CLI::Option* pictures =
      app.add_option("--pictures", options.pictures,
                     "Folder of the result's pictures, in which nothing moves: show the Cramer-Rao bound");
  CLI::Option* venue = app.add_option("--venue", options.venue, "Venue file, for the bound's camera");
  CLI::Option* team = app.add_option("--team", options.team, "Team file, for the bound's layouts");
  pictures->needs(venue, team);
  app.add_option("--json", options.json, "Write the numbers into this file");
  if (const auto exit_code = touchline::parse_arguments(app, argc, argv)) return *exit_code;

  NameMap names;
  std::string error;
  if (!parse_names(options.names, names, error)) return fail(error);
  if (options.spread && !options.annotated.empty()) return fail("--spread and --annotated exclude each other");
  if (!options.pictures.empty() && !options.annotated.empty())
    return fail("--pictures needs results of standing robots, not --annotated");
  if (options.spread) return show_spread(options, names);
  return options.annotated.empty() ? compare_with_truth(options, names) : compare_with_pictures(options, names);
}
