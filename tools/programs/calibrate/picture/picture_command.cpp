#include "tools/programs/calibrate/picture/picture_command.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "firmware/config/configuration.h"
#include "firmware/devices.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"
#include "tools/programs/command_line/command_line.h"

namespace touchline::calibrate {
namespace {

// If a camera delivers no good frame for this time, it has failed.
constexpr Duration kPatience = std::chrono::seconds(5);

bool is_temporary(ErrorCode code) {
  return code == ErrorCode::kTimeout || code == ErrorCode::kShortFrame || code == ErrorCode::kCorruptFrame;
}

// Returns "empty.png", or "empty-1.png" if there are several pictures.
std::string name_of(const std::string& out, unsigned number, unsigned count) {
  if (count == 1) return out;
  const std::filesystem::path path(out);
  return (path.parent_path() / (path.stem().string() + "-" + std::to_string(number) + path.extension().string()))
      .string();
}

int camera_failed(const Error& error) {
  static_cast<void>(fail("touchline-calibrate", error.text.str()));
  return 2;
}

// Opens and starts the camera; stops and closes it at the end of the scope.
struct Streaming {
  explicit Streaming(hal::Camera& c) : camera(c), started(c.open()) {
    if (started.ok()) started = camera.start();
  }
  ~Streaming() {
    camera.stop();
    camera.close();
  }
  Streaming(const Streaming&) = delete;
  Streaming& operator=(const Streaming&) = delete;
  hal::Camera& camera;
  Result<void> started;
};

}  // namespace

void PictureCommand::add_options(CLI::App& app) {
  app.add_option("--board", board, "Board file; its section [camera] is used")->required()->type_name("FILE");
  app.add_option("--set", overrides, "KEY=VALUE of the board file for this time: --set camera.exposure_us=4000")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all();
  app.add_option("--out", out, "PNG file to write; several pictures are named NAME-1.png, NAME-2.png, ...")
      ->required()
      ->type_name("FILE");
  app.add_option("--count", count, "Number of pictures")->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_option("--every", every_s, "Seconds from one picture to the next")->check(number_range(0.0, 3600.0));
  app.add_option("--after", after_s,
                 "Seconds before the first picture, in which automatic exposure and white balance settle")
      ->check(number_range(0.0, 3600.0));
  add_examples(
      app,
      {{"touchline-calibrate picture --board board.toml --out empty.png", "take a picture of the field"},
       {"touchline-calibrate picture --board board.toml --out light.png --count 5 --every 1",
        "take five, one a second"}},
      "No robot is driven. The service must not use the camera: sudo systemctl stop touchline\n"
      "Exit codes: 0 all pictures were written, 1 a file is wrong, 2 the camera failed, 64 the command line is wrong.");
}

int PictureCommand::run() const {
  if (!out.ends_with(".png")) return fail("touchline-calibrate", out + " does not end in .png");
  const auto configuration = std::make_unique<config::Configuration>();
  if (const Result<void> loaded = config::load_board(board, overrides, *configuration); !loaded.ok()) {
    std::fprintf(stderr, "%s\n", loaded.error().text.c_str());
    return kExitBadFile;
  }

  Devices devices;
  devices.make(*configuration, 1);
  const HalDevices parts = devices.hal_devices();
  const Streaming streaming(parts.camera);
  if (!streaming.started.ok()) return camera_failed(streaming.started.error());
  if (!parts.camera.info().description.empty()) std::printf("camera: %s\n", parts.camera.info().description.c_str());
  const std::string& negotiated = parts.camera.info().negotiated;
  if (!negotiated.empty()) std::printf("camera: %s\n", negotiated.c_str());
  Instant last_good = parts.clock.now(), due = last_good + from_seconds(after_s);
  for (unsigned written = 0; written < count;) {
    const Result<hal::FrameLease> lease = parts.camera.wait(parts.clock.now() + kPatience);
    const Instant now = parts.clock.now();
    if (!lease.ok()) {
      if (is_temporary(lease.code()) && now - last_good < kPatience) continue;
      return camera_failed(lease.error());
    }
    last_good = now;
    if (now < due) continue;
    due = now + from_seconds(every_s);
    const std::string name = name_of(out, ++written, count);
    const Result<void> saved = hal::write_picture(name, picture_of(lease.value().frame()));
    if (!saved.ok()) return fail("touchline-calibrate", saved.text());
    std::printf("%s\n", name.c_str());
    std::fflush(stdout);
  }
  const PixelFormat format = parts.camera.info().format;
  if (is_yuv(color_space(format))) {
    std::printf("the camera delivers YUV: use touchline-calibrate colors --format %s with these pictures\n",
                info_of(format).word.data());
  }
  return 0;
}

}  // namespace touchline::calibrate
