#include <unistd.h>
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "firmware/config/configuration.h"
#include "hal/linux/files/output_file.h"
#include "hal/mock/sensor.h"
#include "hal/replay/picture.h"
#include "tools/programs/arena/scene_files.h"
#include "tools/programs/command_line/command_line.h"

namespace {

using namespace touchline;

struct Options {
  std::string board = "boards/mock/board.toml", scene, out;
  std::vector<std::string> overrides;
  unsigned count = 0;
  std::uint64_t seed = 1;
  bool quiet = false;
};

int fail(const std::string& message) {
  std::cerr << "touchline-arena: " << message << '\n';
  return 1;
}

std::string number_of(std::size_t index) {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "%06zu.png", index);
  return name.data();
}

// What was rendered; as RGB, whatever the board's camera delivers: files are for every tool.
int write_scene(const config::BoardFile& board, const arena::SceneWord& scene,
                const std::vector<arena::Moment>& moments, const Options& options) {
  const hal::mock::ArenaParameters& parameters = board.arena;
  const std::uint16_t width = board.camera.width_px, height = board.camera.height_px;
  hal::mock::Renderer renderer(
      parameters, width, height,
      scene.kind == arena::SceneKind::kGrey ? hal::mock::Floor::kGreyPaper : hal::mock::Floor::kField);
  hal::mock::Sensor sensor(parameters.sensor, PixelFormat::kRgb24, width, height, options.seed);
  hal::Picture picture;
  picture.width_px = width;
  picture.height_px = height;
  picture.rgb8.resize(std::size_t{3} * width * height);
  std::vector<std::string> files;
  std::string truth, reason;
  const std::string prefix = options.out + "/";
  const bool progress = !options.quiet && ::isatty(STDERR_FILENO) != 0;
  for (std::size_t i = 0; i < moments.size(); ++i) {
    files.push_back(number_of(i));
    const arena::Moment& moment = moments[i];
    sensor.expose(moment.objects ? renderer.render(moment.begin, moment.end) : renderer.render_floor(), picture.rgb8);
    if (!hal::write_picture(prefix + files[i], picture, reason, {.sync = false}).ok()) return fail(reason);
    truth += arena::truth_line(moment, files[i], parameters, renderer.lens()) + "\n";
    if (progress) std::fprintf(stderr, "\r%zu of %zu pictures", i + 1, moments.size());
  }
  if (progress) std::fputc('\n', stderr);
  if (!hal::write_file(prefix + "truth.jsonl", truth, reason).ok() ||
      !hal::write_file(prefix + "scene.json", arena::scene_description(parameters, renderer.lens()), reason).ok() ||
      !hal::write_file(prefix + "field-points.txt", arena::field_points(parameters, renderer.lens()), reason).ok()) {
    return fail(reason);
  }
  if (scene.kind == arena::SceneKind::kSamples &&
      !hal::write_file(prefix + "clicks.json", arena::clicks(moments, files, parameters, renderer.lens()), reason)
           .ok()) {
    return fail(reason);
  }
  if (!options.quiet)
    std::printf("%zu pictures of scene %s in %s\n", files.size(), options.scene.c_str(), options.out.c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Pictures of the mock arena with their truth: to calibrate from, and to measure recognition with",
               "touchline-arena"};
  std::string scenes;
  for (const arena::SceneWord& scene : arena::scene_words()) {
    scenes += "\n  " + std::string(scene.word) + ": " + std::string(scene.help);
  }
  app.add_option("scene", options.scene, "One of:" + scenes)->required();
  app.add_option("--out", options.out,
                 "Folder for pictures, truth.jsonl, scene.json, field-points.txt (and clicks.json of samples)")
      ->required();
  app.add_option("--board", options.board, "Board file whose [camera] and [arena] are used")->capture_default_str();
  app.add_option("--set", options.overrides, "KEY=VALUE of the board file for this time; repeatable");
  app.add_option("--count", options.count, "Pictures; unless given, as many as such a scene needs")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--seed", options.seed, "Of placements and noise")->capture_default_str();
  app.add_flag("--quiet", options.quiet, "Say nothing but errors");
  if (const auto exit_code = touchline::parse_arguments(app, argc, argv)) return *exit_code;

  const arena::SceneWord* scene = arena::find_scene(options.scene);
  if (scene == nullptr) {
    return fail("there is no scene \"" + options.scene + "\"; there are:" + scenes);
  }
  const auto configuration = std::make_unique<config::Configuration>();
  config::Problems problems;
  config::SortedOverrides overrides;
  static_cast<void>(config::sort_overrides(options.overrides, overrides, problems));
  static_cast<void>(config::load_board(options.board, overrides.board, *configuration, problems));
  if (!problems.empty()) {
    std::cerr << problems.text();
    return 1;
  }
  const config::BoardFile& board = configuration->board;
  const unsigned count = options.count == 0 ? scene->pictures : options.count;
  const auto moments = arena::make_scene(scene->kind, board.arena, board.camera.rate_hz, count, options.seed);
  if (moments.empty()) return fail(options.board + ": the field has no room for all its robots and the ball");
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error) return fail(options.out + ": cannot be made: " + error.message());
  return write_scene(board, *scene, moments, options);
}
