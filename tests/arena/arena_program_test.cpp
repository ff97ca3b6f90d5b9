// Tests of the program touchline-arena: the files of every scene, and error messages.
#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include <gtest/gtest.h>

#include "hal/replay/picture.h"
#include "tests/command_output.h"
#include "tests/replay/media.h"
#include "tests/results.h"
#include "tools/programs/arena/scenes.h"
#include "tools/programs/evaluate/records.h"

namespace touchline::arena {
namespace {

using testing::CommandOutput;

// Runs the program; the text has standard output and error.
CommandOutput touchline_arena(const std::string& arguments) {
  return testing::run_command("'" TOUCHLINE_ARENA "' " + arguments + " 2>&1");
}

const std::string kBoard = "--board '" TOUCHLINE_BOARDS "/mock/board.toml' ";
// Options for small pictures that show the same part of the field.
const std::string kSmall = kBoard +
                           "--set camera.width_px=160 --set camera.height_px=120 --set arena.camera.focal_px=140.0 "
                           "--set arena.camera.center_u_px=80.0 --set arena.camera.center_v_px=60.0 ";

class ArenaProgram : public ::testing::Test {
 protected:
  [[nodiscard]] std::string out(const std::string& scene) const { return "--out '" + folder_ / scene + "' "; }
  nlohmann::json json(const std::string& file) const {
    std::ifstream stream(folder_ / file);
    return nlohmann::json::parse(stream, nullptr, false);
  }

  media::Folder folder_;
};

TEST_F(ArenaProgram, WritesEverySceneWithItsTruth) {
  for (const SceneType& scene : scene_types()) {
    const std::string word(scene.name);
    const CommandOutput outcome = touchline_arena(word + " " + kSmall + out(word) + "--count 3");
    ASSERT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_EQ(outcome.text, "3 pictures of scene " + word + " in " + folder_ / word + "\n");
    const auto truth = evaluate::read_truth(folder_ / word + "/truth.jsonl");
    ASSERT_TRUE(truth.ok()) << truth.text();
    ASSERT_EQ(truth.value().size(), 3U);
    const bool things = scene.kind != SceneKind::kEmpty && scene.kind != SceneKind::kGrey;
    for (const evaluate::FrameRecord& frame : truth.value()) {
      EXPECT_EQ(frame.sightings.robots.size(), things ? 10U : 0U);
      EXPECT_EQ(frame.sightings.ball.has_value(), things);
      EXPECT_TRUE(std::filesystem::exists(folder_ / word + "/" + frame.file));
    }
    for (const char* file : {"scene.json", "field-points.txt"}) {
      EXPECT_TRUE(std::filesystem::exists(folder_ / word + "/" + file)) << file;
    }
    EXPECT_EQ(std::filesystem::exists(folder_ / word + "/clicks.json"), scene.kind == SceneKind::kSamples);
  }
}

TEST_F(ArenaProgram, TheTruthMatchesThePicture) {
  ASSERT_EQ(touchline_arena("layouts " + kBoard + out("layouts") + "--count 1 --quiet").code, 0);
  std::ifstream file(folder_ / "layouts/truth.jsonl");
  const auto line = nlohmann::json::parse(file);
  ASSERT_OK_AND_ASSIGN(const hal::Picture picture, hal::read_picture(folder_ / "layouts/000000.png"));
  // Compares the hue of the pixel with that of the paint, independent of brightness.
  const auto hue_of = [](double r, double g, double b) {
    return std::atan2(std::sqrt(3.0) * (g - b), 2.0 * r - g - b);
  };
  const auto hue_at = [&](const nlohmann::json& at) {
    const auto u = static_cast<std::size_t>(std::lround(at[0].get<double>()));
    const auto v = static_cast<std::size_t>(std::lround(at[1].get<double>()));
    const std::uint8_t* rgb = &picture.rgb8[3 * (v * picture.width_px + u)];
    return hue_of(rgb[0], rgb[1], rgb[2]);
  };
  const hal::mock::ArenaParameters parameters;
  ASSERT_EQ(line["robots"].size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    const auto& robot = line["robots"][i];
    for (const auto& [at, name] : {std::pair{robot["team_px"], robot["team"].get<std::string>()},
                                   {robot["ident_px"][0], parameters.robot[i].colors[0]}}) {
      const hal::mock::Srgb& rgb = hal::mock::find_paint(parameters, name)->rgb;
      const double difference = std::remainder(hue_at(at) - hue_of(rgb[0], rgb[1], rgb[2]), 2.0 * 3.14159265);
      EXPECT_NEAR(difference, 0.0, 0.25) << "robot " << i << ' ' << name;
    }
  }
  const hal::mock::Srgb& ball = hal::mock::find_paint(parameters, "orange")->rgb;
  EXPECT_NEAR(hue_at({line["ball"]["u"], line["ball"]["v"]}), hue_of(ball[0], ball[1], ball[2]), 0.25);
}

TEST_F(ArenaProgram, DescriptionAndPointsAgree) {
  ASSERT_EQ(touchline_arena("empty " + kBoard + out("empty") + "--quiet").code, 0);
  const nlohmann::json scene = json("empty/scene.json");
  ASSERT_FALSE(scene.is_discarded());
  EXPECT_EQ(scene["field_m"], (nlohmann::json{2.2, 1.8}));
  EXPECT_EQ(scene["corners_px"].size(), 4U);
  std::ifstream points(folder_ / "empty/field-points.txt");
  std::size_t lines = 0;
  for (std::string line; std::getline(points, line); ++lines) {
    double x = 0.0, y = 0.0, u = 0.0, v = 0.0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &x, &y, &u, &v), 4) << line;
    const nlohmann::json& point = scene["points"][lines];
    EXPECT_NEAR(point["x"].get<double>(), x, 1e-5);
    EXPECT_NEAR(point["y"].get<double>(), y, 1e-5);
    EXPECT_NEAR(point["pixel"][0].get<double>(), u, 0.2501) << "rounded to half a pixel";
    EXPECT_NEAR(point["pixel"][1].get<double>(), v, 0.2501);
    EXPECT_EQ(u * 2.0, std::round(u * 2.0));
  }
  EXPECT_EQ(lines, scene["points"].size());
  EXPECT_EQ(lines, 18U);
}

TEST_F(ArenaProgram, ClicksNameEveryPatchAndTheBall) {
  ASSERT_EQ(touchline_arena("samples " + kSmall + out("samples") + "--count 2 --quiet").code, 0);
  const nlohmann::json clicks = json("samples/clicks.json");
  ASSERT_FALSE(clicks.is_discarded());
  EXPECT_EQ(clicks["samples"].size(), 2U * 21U);
  EXPECT_EQ(clicks["samples"][0]["color"], "orange");
  EXPECT_EQ(clicks["samples"][1]["color"], "blue");
  EXPECT_EQ(clicks["samples"][2]["color"], "red");
  EXPECT_EQ(clicks["samples"][41]["image"], "000001.png");
}

TEST_F(ArenaProgram, TheSameSeedRepeatsThePictures) {
  for (const char* name : {"a", "b"}) {
    ASSERT_EQ(touchline_arena("match " + kSmall + out(name) + "--count 4 --seed 9 --quiet").code, 0);
  }
  ASSERT_EQ(touchline_arena("match " + kSmall + out("c") + "--count 4 --seed 10 --quiet").code, 0);
  for (const char* file : {"/000003.png", "/truth.jsonl"}) {
    EXPECT_EQ(media::read_bytes(folder_ / std::string("a") + file),
              media::read_bytes(folder_ / std::string("b") + file));
    EXPECT_NE(media::read_bytes(folder_ / std::string("a") + file),
              media::read_bytes(folder_ / std::string("c") + file));
  }
}

TEST_F(ArenaProgram, RefusesBadArgumentsWithAMessage) {
  const auto refused = [&](const std::string& arguments, const std::string& part) {
    const CommandOutput outcome = touchline_arena(arguments);
    EXPECT_NE(outcome.code, 0) << arguments;
    EXPECT_NE(outcome.text.find(part), std::string::npos) << outcome.text;
  };
  refused("", "scene is required");
  refused("layouts " + kBoard, "--out is required");
  refused("cup " + kBoard + out("x"), "scene: \"cup\" is no choice; known choices: ");
  refused("layouts " + kBoard + out("x") + "--count 0", "--count");
  refused("layouts " + kBoard + out("x") + "--seed minus", "--seed");
  refused("layouts --board '" + folder_ / "none.toml" + "' " + out("x"), "none.toml: no such file");
  refused("layouts " + kBoard + out("x") + "--set arena.robot_side_m=9.0", "out of range: 0.02 to 0.4 m");
  refused("layouts " + kBoard + out("x") + "--set arena.ball_color=purple", "\"purple\" is not in [[arena.paint]]");
  // Six large robots fit side by side, but not at random angles.
  std::string board =
      "version = 1\nvenue = \"venue.toml\"\nteam = \"team.toml\"\n[camera]\nbackend = \"mock\"\n[radio]\nbackend = "
      "\"mock\"\n[arena]\nrobot_side_m = "
      "0.3\n[arena.field]\n"
      "length_m = 1.0\nwidth_m = 0.8\n";
  for (int i = 0; i < 6; ++i) {
    board += "[[arena.robot]]\nid = " + std::to_string(i) + "\nx_m = " + std::to_string(0.31 * (i % 3) - 0.31) +
             "\ny_m = " + std::to_string(0.31 * (i / 3) - 0.155) + "\ncolors = [\"red\"]\n";
  }
  media::write_text(folder_ / "full.toml", board);
  refused("layouts --board '" + folder_ / "full.toml" + "' " + out("x"),
          "full.toml: the field has no room for all its robots and the ball");
  media::write_text(folder_ / "file", "a file where the folder should be");
  refused("layouts " + kBoard + out("file"), "file: cannot be created: ");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x")) << "nothing must be written on error";
}

}  // namespace
}  // namespace touchline::arena
