#include <unistd.h>
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "firmware/config/configuration.h"
#include "hal/files/output_file.h"
#include "hal/mock/sensor.h"
#include "hal/replay/picture.h"
#include "tools/programs/arena/scene_files.h"
#include "tools/programs/arena/serve_command.h"
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

int fail(const std::string& message) { return touchline::fail("touchline-arena", message); }

std::string number_of(std::size_t index) {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "%06zu.png", index);
  return name.data();
}

// Renders the frames and writes all files. Pictures are RGB, independent of the camera's format.
int write_scene(const config::BoardFile& board, const arena::SceneType& scene,
                const std::vector<arena::SceneFrame>& frames, const Options& options) {
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
  std::string truth;
  const std::string prefix = options.out + "/";
  const bool progress = !options.quiet && ::isatty(STDERR_FILENO) != 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    files.push_back(number_of(i));
    const arena::SceneFrame& frame = frames[i];
    sensor.expose(frame.objects ? renderer.render(frame.begin, frame.end) : renderer.render_floor(), picture.rgb8);
    const Result<void> written = hal::write_picture(prefix + files[i], picture, {.sync = false});
    if (!written.ok()) return fail(written.text());
    truth += arena::truth_line(frame, files[i], parameters, renderer.lens()) + "\n";
    if (progress) std::fprintf(stderr, "\r%zu of %zu pictures", i + 1, frames.size());
  }
  if (progress) std::fputc('\n', stderr);
  std::vector<std::pair<std::string, std::string>> documents{
      {"truth.jsonl", truth},
      {"scene.json", arena::scene_description(parameters, renderer.lens())},
      {"field-points.txt", arena::field_points(parameters, renderer.lens())}};
  if (scene.kind == arena::SceneKind::kSamples) {
    documents.emplace_back("clicks.json", arena::clicks(frames, files, parameters, renderer.lens()));
  }
  for (const auto& [name, text] : documents) {
    if (const Result<void> written = hal::write_file(prefix + name, text); !written.ok()) return fail(written.text());
  }
  if (!options.quiet)
    std::printf("%zu pictures of scene %s in %s\n", files.size(), options.scene.c_str(), options.out.c_str());
  return touchline::kExitOk;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Renders pictures of the mock arena with their truth, for calibration and for measuring recognition;\n"
      "`serve` lets another program play in the arena",
      "touchline-arena"};
  std::string scenes = "Scenes:";
  std::vector<std::string> words;
  for (const arena::SceneType& scene : arena::scene_types()) {
    scenes += "\n  " + std::string(scene.name) + ": " + std::string(scene.help);
    words.emplace_back(scene.name);
  }
  app.add_option("scene", options.scene, "What the pictures show")->check(touchline::one_of(words));
  app.add_option("--out", options.out,
                 "Folder for pictures, truth.jsonl, scene.json, field-points.txt (samples: also clicks.json)")
      ->type_name("DIR");
  app.add_option("--board", options.board, "Board file with the sections [camera] and [arena]")
      ->type_name("FILE")
      ->capture_default_str();
  touchline::add_overrides(app, options.overrides, "the board file");
  app.add_option("--count", options.count, "Number of pictures (default: depends on the scene)")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--seed", options.seed, "Random seed of poses and noise")->capture_default_str();
  app.add_flag("--quiet", options.quiet, "Print only errors");
  touchline::add_examples(app,
                          {{"touchline-arena --out samples samples", "pictures with clicks, to learn the colors from"},
                           {"touchline-arena --out match --count 100 --seed 7 match", "100 pictures of a game"}},
                          scenes);
  arena::ServeOptions serve_options;
  const CLI::App* const serve = arena::add_serve_command(app, serve_options);
  app.require_subcommand(0, 1);
  app.parse_complete_callback([&] {
    if (serve->parsed()) return;
    if (options.scene.empty()) throw CLI::RequiredError("scene");
    if (options.out.empty()) throw CLI::RequiredError("--out");
  });
  if (const auto exit_code = touchline::parse_arguments(app, argc, argv)) return *exit_code;
  if (const std::string ignored = touchline::ignored_option(app, *serve); !ignored.empty()) {
    return touchline::fail("touchline-arena", ignored, touchline::kExitBadCommandLine);
  }
  if (serve->parsed()) {
    const Result<void> served = arena::run_serve(serve_options);
    return served.ok() ? touchline::kExitOk : fail(served.text());
  }

  const arena::SceneType* const scene = arena::find_scene(options.scene);
  const auto configuration = std::make_unique<config::Configuration>();
  const Result<void> loaded = config::load_board(options.board, options.overrides, *configuration);
  if (!loaded.ok()) {
    std::cerr << loaded.error().text << '\n';
    return touchline::kExitBadFile;
  }
  const config::BoardFile& board = configuration->board;
  const unsigned count = options.count == 0 ? scene->pictures : options.count;
  const auto frames = arena::make_scene(scene->kind, board.arena, board.camera.rate_hz, count, options.seed);
  if (frames.empty()) return fail(options.board + ": the field has no room for all its robots and the ball");
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error) return fail(options.out + ": cannot be created: " + error.message());
  return write_scene(board, *scene, frames, options);
}
