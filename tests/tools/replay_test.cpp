#include "tools/programs/replay/replay.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <thread>

#include "core/geometry/camera_model.h"
#include "hal/replay/replay_camera.h"
#include "tests/command_output.h"
#include "tests/replay/media.h"
#include "tests/results.h"
#include "tools/programs/evaluate/pose_evaluation.h"

namespace touchline::replay {
namespace {

constexpr const char* kVenue = R"(version = 1
[picture]
width_px = 320
height_px = 240
[field]
length_m = 1.5
width_m = 1.3
[camera_model]
kind = "full"
[camera_model.full]
fx_px = 280.0
fy_px = 280.0
cx_px = 159.5
cy_px = 119.5
rotation_rad = [3.14159265, 0.0, 0.0]
position_m = [0.0, 0.0, 2.0]
[colors]
space = "rgb"
[[color]]
name = "orange"
[[color.box]]
low = [230, 110, 0]
high = [255, 160, 40]
[[color]]
name = "blue"
[[color.box]]
low = [0, 0, 200]
high = [40, 40, 255]
[[color]]
name = "red"
[[color.box]]
low = [200, 0, 0]
high = [255, 40, 40]
[[color]]
name = "green"
[[color.box]]
low = [0, 200, 0]
high = [40, 255, 40]
)";
constexpr const char* kTeam = R"(version = 1
[own]
color = "blue"
[[own.robot]]
id = 1
colors = ["red"]
[[own.robot]]
id = 4
colors = ["green"]
[ball]
color = "orange"
)";

struct Placed {
  int id;
  Pose pose;
};

// A picture of the arena, painted with 3 x 3 samples per pixel.
class Scene {
 public:
  Scene() {
    CameraParameters parameters;
    parameters.full.fx_px = parameters.full.fy_px = 280.0f;
    parameters.full.cx_px = 159.5f;
    parameters.full.cy_px = 119.5f;
    parameters.full.rotation_rad = {std::numbers::pi_v<float>, 0.0f, 0.0f};
    parameters.full.position_m = {0.0f, 0.0f, 2.0f};
    EXPECT_TRUE(camera_.configure(parameters).ok());
  }

  [[nodiscard]] hal::Picture paint(const std::vector<Placed>& robots, FieldPoint ball) const {
    constexpr int kSamples = 3;
    hal::Picture picture{320, 240, std::vector<std::uint8_t>(320 * 240 * 3), {}};
    for (std::size_t v = 0; v < 240; ++v) {
      for (std::size_t u = 0; u < 320; ++u) {
        std::array<int, 3> sum{};
        for (int i = 0; i < kSamples * kSamples; ++i) {
          const auto offset = [](int k) { return (static_cast<float>(k) + 0.5f) / kSamples - 0.5f; };
          const PixelPoint p{static_cast<float>(u) + offset(i % kSamples),
                             static_cast<float>(v) + offset(i / kSamples)};
          const std::array<int, 3> color = color_at(p, robots, ball);
          for (std::size_t c = 0; c < 3; ++c) sum[c] += color[c];
        }
        for (std::size_t c = 0; c < 3; ++c) {
          picture.rgb8[(v * 320 + u) * 3 + c] = static_cast<std::uint8_t>(sum[c] / (kSamples * kSamples));
        }
      }
    }
    return picture;
  }

 private:
  [[nodiscard]] std::array<int, 3> color_at(PixelPoint p, const std::vector<Placed>& robots, FieldPoint ball) const {
    const FieldPoint top = camera_.to_field(p, 0.075f);
    for (const Placed& robot : robots) {
      const float dx = top.x_m - robot.pose.position.x_m, dy = top.y_m - robot.pose.position.y_m;
      const float c = std::cos(robot.pose.theta_rad), s = std::sin(robot.pose.theta_rad);
      const float x = c * dx + s * dy, y = -s * dx + c * dy;
      constexpr float kHalf = 0.0345f / 2.0f, kPlace = 0.01875f;
      if (std::abs(x - kPlace) < kHalf && std::abs(y - kPlace) < kHalf) return {20, 20, 230};
      if (std::abs(x + kPlace) < kHalf && std::abs(y + kPlace) < kHalf) {
        return robot.id == 1 ? std::array<int, 3>{230, 20, 20} : std::array<int, 3>{20, 230, 20};
      }
      if (std::max(std::abs(x), std::abs(y)) < 0.0375f) return {15, 15, 15};
    }
    const FieldPoint middle = camera_.to_field(p, 0.02135f);
    if (std::hypot(middle.x_m - ball.x_m, middle.y_m - ball.y_m) < 0.02135f) return {245, 135, 20};
    return {60, 60, 60};
  }
  CameraModel camera_;
};

class Replay : public ::testing::Test {
 protected:
  Replay() {
    media::write_text(folder / "venue.toml", kVenue);
    media::write_text(folder / "team.toml", kTeam);
    std::filesystem::create_directory(folder / "in");
    options.input = folder / "in";
    options.venue = folder / "venue.toml";
    options.team = folder / "team.toml";
    options.out = folder / "result.jsonl";
  }
  void write_flat(const std::string& name, std::uint32_t width = 320, std::uint32_t height = 240) const {
    media::write_png(folder / ("in/" + name),
                     {width, height, std::vector<std::uint8_t>(std::size_t{3} * width * height, 60), {}});
  }
  bool run() {
    const auto show = [this](std::uint64_t done, std::uint64_t total) { progress = {done, total}; };
    const Result<ReplaySummary> result = replay(options, show, stop);
    summary = result.ok() ? result.value() : ReplaySummary();
    error = result.text();
    return result.ok();
  }
  // Checks that the input is refused and no file remains.
  void expect_refused(const std::string& complaint) {
    EXPECT_FALSE(run());
    EXPECT_NE(error.find(complaint), std::string::npos) << error;
    EXPECT_FALSE(std::filesystem::exists(folder / "result.jsonl"));
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      EXPECT_NE(entry.path().extension(), ".part") << entry;
    }
  }

  media::Folder folder;
  ReplayOptions options;
  std::atomic<bool> stop = false;
  ReplaySummary summary;
  std::string error;
  std::pair<std::uint64_t, std::uint64_t> progress;
};

TEST_F(Replay, RecognizesThePaintedScene) {
  const Scene scene;
  std::vector<evaluate::FrameRecord> truth;
  for (int i = 0; i < 3; ++i) {
    const float step = 0.004f * static_cast<float>(i);
    const std::vector<Placed> robots{{1, {{-0.4f + step, 0.2f}, 0.3f}}, {4, {{0.35f, -0.25f + step}, -2.5f}}};
    const FieldPoint ball{0.1f - step, 0.05f};
    const std::string name = std::to_string(i) + ".png";
    media::write_png(folder / ("in/" + name), scene.paint(robots, ball));
    evaluate::FrameRecord record;
    record.file = name;
    record.frame = i;
    for (const Placed& robot : robots) {
      const FieldPoint p = robot.pose.position;
      record.sightings.robots.push_back({"blue",
                                         robot.id,
                                         {static_cast<double>(p.x_m), static_cast<double>(p.y_m)},
                                         static_cast<double>(robot.pose.theta_rad),
                                         {}});
    }
    record.sightings.ball =
        evaluate::BallRecord{{static_cast<double>(ball.x_m), static_cast<double>(ball.y_m)}, std::nullopt};
    record.tracks = record.sightings;
    truth.push_back(record);
  }
  options.plot = folder / "motion.svg";
  options.plot_robot = "blue:4";
  ASSERT_TRUE(run()) << error;
  EXPECT_EQ(summary.frames, 3u);
  EXPECT_TRUE(std::filesystem::exists(options.plot));
  options.plot_robot = "blue:2";
  EXPECT_FALSE(run());
  EXPECT_NE(error.find("blue:2: it was never seen"), std::string::npos) << error;
  options.plot_robot = "green:1";
  EXPECT_FALSE(run());
  EXPECT_NE(error.find("such as blue:0"), std::string::npos) << error;
  options.plot_robot.clear();
  ASSERT_TRUE(run()) << error;
  EXPECT_EQ(summary.robots, 6u);
  EXPECT_EQ(summary.robots_with_id, 6u);
  EXPECT_EQ(summary.frames_with_ball, 3u);
  EXPECT_EQ(progress, (std::pair<std::uint64_t, std::uint64_t>{3, 3}));

  const auto records = evaluate::read_result(options.out, {});
  ASSERT_TRUE(records.ok()) << records.text();
  const std::vector<evaluate::FrameRecord>& result = records.value();
  const auto evaluated = evaluate::evaluate_poses(truth, result, 0.01);
  ASSERT_TRUE(evaluated.ok()) << evaluated.text();
  const evaluate::PoseReport& report = evaluated.value();
  EXPECT_EQ(report.sightings.right, 6u);
  EXPECT_EQ(report.sightings.ghosts, 0u);
  EXPECT_EQ(report.sightings.balls_seen, 3u);
  EXPECT_LT(report.sightings.position.max, 0.002);
  EXPECT_LT(report.sightings.angle.max, 0.1);
  EXPECT_NEAR(result[2].t_s, 2.0 / 30.0, 1e-6);
}

TEST_F(Replay, AnnotatesIntoFolderAndVideo) {
  write_flat("a.png");
  write_flat("b.png");
  options.annotate = folder / "seen/pictures";
  ASSERT_TRUE(run()) << error;
  ASSERT_OK_AND_ASSIGN(const hal::Picture picture, hal::read_picture(folder / "seen/pictures/000001_b.png"));
  EXPECT_EQ(picture.width_px, 640u);
  EXPECT_GT(picture.height_px, 480u);

  options.annotate = folder / "seen.mp4";
  ASSERT_TRUE(run()) << error;
  hal::ReplayCamera camera({.path = options.annotate});
  ASSERT_OK(camera.open());
  EXPECT_EQ(camera.frame_count(), 2u);
  EXPECT_EQ(camera.info().width_px, 640);
}

TEST_F(Replay, NeverOverwritesAnInput) {
  write_flat("a.png");
  options.out = options.venue;
  EXPECT_FALSE(run());
  EXPECT_NE(error.find("would overwrite"), std::string::npos) << error;
  options.out = folder / "in/a.png";
  EXPECT_FALSE(run());
  options.out = folder / "in/../in/a.png";
  EXPECT_FALSE(run());
  options.out = folder / "result.jsonl";
  options.annotate = folder / "in";
  EXPECT_FALSE(run());
  options.annotate = options.out;
  EXPECT_FALSE(run());
  EXPECT_EQ(media::read_bytes(options.venue).size(), std::string(kVenue).size());
  options.annotate.clear();
  options.out = folder / "in/result.jsonl";  // not a picture, so it is allowed
  EXPECT_TRUE(run()) << error;
}

// Without --annotate, the empty path of the pictures counted as the folder of a file without one.
TEST_F(Replay, OutputsNeedNoFolder) {
  write_flat("a.png");
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  options.out = "result.jsonl";
  options.plot = "motion.svg";
  EXPECT_TRUE(run()) << error;
  options.plot = folder / "result.jsonl";
  std::filesystem::remove(options.plot);
  EXPECT_FALSE(run()) << "two names of one file that does not exist";
  options.plot = "seen/motion.svg";
  options.annotate = folder / "seen/";
  EXPECT_FALSE(run()) << "a plot among the annotated pictures";
  std::filesystem::current_path(before);
}

TEST_F(Replay, DevicesAndFifosAreNotReplaced) {
  write_flat("a.png");
  ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
  std::string received;
  std::thread reader([&] {
    std::ifstream file(folder / "fifo");
    std::getline(file, received);
  });
  options.out = folder / "fifo";
  const bool written = run();
  if (!std::filesystem::is_fifo(folder / "fifo")) {
    // The reader still waits at the FIFO, which has no name any more.
    reader.detach();
    FAIL() << "the FIFO was replaced by a regular file";
  }
  reader.join();
  EXPECT_TRUE(written) << error;
  EXPECT_EQ(received.substr(0, 1), "{") << received;

  if (::mknod((folder / "null").c_str(), S_IFCHR | 0666, ::makedev(1, 3)) != 0) GTEST_SKIP() << "needs root";
  options.out = folder / "null";
  EXPECT_TRUE(run()) << error;
  EXPECT_TRUE(std::filesystem::is_character_file(folder / "null"));
}

TEST_F(Replay, LinksAndNeighboringFilesAreNotReplaced) {
  write_flat("a.png");
  std::filesystem::create_symlink("target.jsonl", folder / "link.jsonl");
  for (const char* name : {"link.jsonl.part", "target.jsonl.part"}) {
    media::write_text(folder / name, "somebody else's");
  }
  options.out = folder / "link.jsonl";
  EXPECT_TRUE(run()) << error;
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.jsonl"));
  EXPECT_GT(media::read_bytes(folder / "target.jsonl").size(), 0u);
  for (const char* name : {"link.jsonl.part", "target.jsonl.part"}) {
    ASSERT_TRUE(std::filesystem::exists(folder / name)) << name;
    EXPECT_EQ(media::read_bytes(folder / name).size(), 15u) << name;
  }
}

TEST_F(Replay, RefusesUnusableInputs) {
  expect_refused("no picture");
  write_flat("a.png");
  write_flat("b.png", 320, 200);
  expect_refused("b.png is 320 x 200, but a.png is 320 x 240");
  options.team = folder / "none.toml";
  expect_refused("none.toml");
  options.team = folder / "team.toml";
  options.overrides = {"ball.radius_m=seven"};
  expect_refused("ball.radius_m");
}

TEST_F(Replay, RefusesPicturesOfAnotherSizeThanTheCalibration) {
  write_flat("a.png", 160, 120);
  expect_refused("160 x 120");
}

TEST_F(Replay, ADamagedPictureEndsTheReplayUnlessSkipped) {
  write_flat("a.png");
  write_flat("c.png");
  const std::vector<std::uint8_t> whole = media::read_bytes(folder / "in/a.png");
  media::write_bytes(folder / "in/b.png", std::span(whole).first(whole.size() / 2));
  expect_refused("b.png");
  options.skip_damaged = true;
  ASSERT_TRUE(run()) << error;
  EXPECT_EQ(summary.frames, 2u);
  EXPECT_EQ(summary.damaged, 1u);
}

// The first picture decides the size, so the camera reads it when it is opened.
TEST_F(Replay, TheFirstPictureMayBeDamagedToo) {
  write_flat("c.png");
  const std::vector<std::uint8_t> whole = media::read_bytes(folder / "in/c.png");
  for (const char* name : {"a.png", "b.png"}) {
    media::write_bytes(folder / ("in/" + std::string(name)), std::span(whole).first(whole.size() / 2));
  }
  expect_refused("a.png");
  options.skip_damaged = true;
  ASSERT_TRUE(run()) << error;
  EXPECT_EQ(summary.frames, 1u);
  EXPECT_EQ(summary.damaged, 2u);
  std::filesystem::remove(folder / "in/c.png");
  std::filesystem::remove(folder / "result.jsonl");
  expect_refused("none of its 2 pictures can be decoded");
}

TEST_F(Replay, NamesTheFirstFileOfAnotherFormat) {
  expect_refused("no picture of a format that is read (png, ppm, pgm, jpg, jpeg); it has no file at all");
  for (const char* name : {"frame10.bmp", "frame9.bmp", "frame11.tif"})
    std::ofstream(folder / ("in/" + std::string(name)));
  expect_refused("no picture of a format that is read (png, ppm, pgm, jpg, jpeg); frame9.bmp is of another one");
}

TEST(ReplayProgram, AWrongCommandLineGivesExitCode64) {
  const auto run = [](const std::string& arguments) {
    return testing::run_command("'" TOUCHLINE_REPLAY "' in --venue v --team t --out r.jsonl " + arguments + " 2>&1");
  };
  const testing::CommandOutput ending = run("--plot motion.png");
  EXPECT_EQ(ending.code, 64);
  EXPECT_NE(ending.text.find("motion.png: the name must end in .svg"), std::string::npos) << ending.text;
  EXPECT_EQ(run("--plot-robot blue:1").code, 64);
  EXPECT_EQ(run("--plot-robot blue:1 --plot motion.svg").code, 1) << "no input";
}

TEST_F(Replay, StoppingLeavesNoFiles) {
  write_flat("a.png");
  stop = true;
  expect_refused("stopped");
}

}  // namespace
}  // namespace touchline::replay
