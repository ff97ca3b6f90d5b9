#include "tests/config/config_files.h"

#include <unistd.h>
#include <fstream>
#include <sstream>

namespace touchline::config {
namespace {

constexpr const char* kBoard = R"(version = 1
name = "test"
venue = "venue.toml"
team = "team.toml"

[camera]
backend = "v4l2"
device = "/dev/video7"
format = "rgb24"
width_px = 640
height_px = 480

[radio]
backend = "none"
)";

constexpr const char* kVenue = R"(version = 1

[picture]
width_px = 640
height_px = 480

[field]
length_m = 2.2
width_m = 1.8

[camera_model]
kind = "full"
[camera_model.full]
fx_px = 500.0
fy_px = 500.0
cx_px = 320.0
cy_px = 240.0
rotation_rad = [3.14159, 0.0, 0.0]
position_m = [0.0, 0.0, 2.0]

[colors]
space = "rgb"

[[color]]
name = "orange"
shown_rgb = [255, 128, 0]
[[color.box]]
low = [180, 60, 0]
high = [255, 160, 80]

[[color]]
name = "blue"
[[color.box]]
low = [0, 0, 150]
high = [80, 80, 255]

[[color]]
name = "red"
[[color.box]]
low = [150, 0, 0]
high = [255, 40, 60]

[[color]]
name = "green"
[[color.box]]
low = [0, 150, 0]
high = [80, 255, 80]
)";

constexpr const char* kTeam = R"(version = 1

[own]
layout = "paper"
color = "blue"
max_robots = 2
[[own.robot]]
id = 0
colors = ["red"]
[[own.robot]]
id = 1
colors = ["green"]

[ball]
color = "orange"
)";

}  // namespace

ConfigFiles::ConfigFiles() {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  folder_ = std::filesystem::temp_directory_path() /
            (std::string("touchline-") + test->name() + "-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder_);
  write("board.toml", kBoard);
  write("venue.toml", kVenue);
  write("team.toml", kTeam);
}

ConfigFiles::~ConfigFiles() { std::filesystem::remove_all(folder_); }

std::string ConfigFiles::read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void ConfigFiles::write(const std::string& name, const std::string& text) const {
  std::ofstream(folder_ / name, std::ios::binary) << text;
}

void ConfigFiles::replace(const std::string& name, const std::string& from, const std::string& to) const {
  std::string text = read(folder_ / name);
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  ASSERT_EQ(text.find(from, at + 1), std::string::npos) << from << " is there twice";
  write(name, text.replace(at, from.size(), to));
}

Result<void> ConfigFiles::load(std::vector<std::string> overrides) {
  configuration_ = std::make_unique<Configuration>();
  result_ = config::load({path("board.toml"), "", "", std::move(overrides)}, *configuration_);
  return result_;
}

std::string ConfigFiles::errors() const {
  std::string text = result_.text();
  if (!text.empty()) text += "\n";
  const std::string prefix = folder_.string() + "/";
  for (std::size_t at = text.find(prefix); at != std::string::npos; at = text.find(prefix, at)) {
    text.erase(at, prefix.size());
  }
  return text;
}

std::string ConfigFiles::refusal(std::vector<std::string> overrides) {
  EXPECT_FALSE(load(std::move(overrides)).ok());
  return errors();
}

}  // namespace touchline::config
