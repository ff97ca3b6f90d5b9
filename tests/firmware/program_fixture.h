#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/command_output.h"

namespace touchline::testing {

/// Runs the program touchline. The text has standard output and error.
inline CommandOutput touchline(const std::string& arguments) {
  return run_command("'" TOUCHLINE_PROGRAM "' " + arguments + " 2>&1");
}

/// A folder with a board of 64 x 48 pixels and a recording of 30 pictures.
class Program : public ::testing::Test {
 protected:
  Program() : folder_(std::filesystem::temp_directory_path() / ("touchline-program-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
    write("venue.toml",
          "version = 1\n[picture]\nwidth_px = 64\nheight_px = 48\n[field]\nlength_m = 2.2\nwidth_m = 1.8\n"
          "[camera_model]\nkind = \"full\"\n[camera_model.full]\nfx_px = 60.0\nfy_px = 60.0\ncx_px = 31.5\n"
          "cy_px = 23.5\nrotation_rad = [3.14159, 0.0, 0.0]\nposition_m = [0.0, 0.0, 2.0]\n[colors]\nspace = \"rgb\"\n"
          "[[color]]\nname = \"orange\"\n[[color.box]]\nlow = [200, 100, 0]\nhigh = [255, 160, 60]\n"
          "[[color]]\nname = \"blue\"\n[[color.box]]\nlow = [0, 0, 200]\nhigh = [60, 60, 255]\n"
          "[[color]]\nname = \"red\"\n[[color.box]]\nlow = [200, 0, 0]\nhigh = [255, 60, 60]\n");
    write("team.toml",
          "version = 1\n[own]\ncolor = \"blue\"\n[[own.robot]]\nid = 0\ncolors = [\"red\"]\n[ball]\ncolor = "
          "\"orange\"\n");
    std::filesystem::create_directories(folder_ / "frames");
    for (int i = 0; i < 30; ++i) {
      write("frames/" + std::to_string(i) + ".ppm", "P6\n64 48\n255\n" + std::string(std::size_t{64} * 48 * 3, '\0'));
    }
    write_board("replay", "frames");
  }
  ~Program() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  void write_board(const std::string& backend, const std::string& device) const {
    write("board.toml",
          "version = 1\nvenue = \"venue.toml\"\nteam = \"team.toml\"\n[camera]\nbackend = \"" + backend +
              "\"\ndevice = \"" + (folder_ / device).string() +
              "\"\nformat = \"rgb24\"\nwidth_px = 64\nheight_px = 48\nrate_hz = 30.0\n[radio]\nbackend = \"none\"\n");
  }
  [[nodiscard]] std::string board() const { return "--board '" + (folder_ / "board.toml").string() + "' "; }

  std::filesystem::path folder_;
};

}  // namespace touchline::testing
