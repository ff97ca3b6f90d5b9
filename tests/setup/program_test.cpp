#include <signal.h>

#include <filesystem>

#include "tests/setup/scripted_firmware.h"

// touchline-setup over its socket.
namespace touchline::setup {
namespace {

namespace fs = std::filesystem;

const nlohmann::json kMiroSot = {{"preset", "mirosot-middle"}, {"camera_height_m", 2.3}};

TEST_F(ScriptedFirmware, FindsTheFieldAndSavesIt) {
  start_program();
  camera_ = {arena_picture(hal::mock::Floor::kField, 1), arena_picture(hal::mock::Floor::kField, 2)};
  expect_ok("begin");
  ASSERT_TRUE(state_["open"]);
  EXPECT_FALSE(state_["steps"]["field"]["done"]);
  expect_ok("field.find", kMiroSot);
  EXPECT_EQ(delivered_, 4u);
  const nlohmann::json field = state_["steps"]["field"];
  EXPECT_TRUE(field["done"]);
  EXPECT_EQ(field["quality"]["level"], "ok") << field["quality"];
  EXPECT_GT(field["rms_mm"].get<double>(), 0.05);
  EXPECT_LT(field["rms_mm"].get<double>(), 1.0);
  EXPECT_NEAR(field["camera_height_m"].get<double>(), 2.3, 0.03);
  EXPECT_EQ(picture(field["error_map"]).bytes.substr(1, 3), "PNG");
  EXPECT_EQ(state_["undo"], nlohmann::json({"field found"}));
  EXPECT_FALSE(fs::exists(saved("venue.toml"))) << "nothing is written before it is saved";

  const nlohmann::json difference = expect_ok("differences");
  ASSERT_EQ(difference["files"].size(), 1u);
  EXPECT_EQ(difference["files"][0]["name"], "venue.toml");
  EXPECT_NE(difference["files"][0]["diff"].get<std::string>().find("+[camera_model]"), std::string::npos);
  EXPECT_NE(difference["problems"].get<std::string>().find("color"), std::string::npos);

  expect_ok("save");
  EXPECT_FALSE(state_["open"]);
  EXPECT_NE(read("etc/venue.toml").find("[camera_model]"), std::string::npos);
  ASSERT_FALSE(used_.empty());
  EXPECT_EQ(used_.back()["source"], "saved");
}

TEST_F(ScriptedFirmware, UndoesAndRedoesOneStep) {
  start_program();
  camera_ = {arena_picture(hal::mock::Floor::kField, 1)};
  expect_ok("begin");
  expect_error("undo", {}, "nothing to undo");
  expect_ok("field.find", kMiroSot);
  const nlohmann::json found = state_["steps"]["field"];
  expect_ok("undo");
  EXPECT_FALSE(state_["steps"]["field"]["done"]);
  EXPECT_EQ(state_["redo"], nlohmann::json({"field found"}));
  EXPECT_FALSE(fs::exists(path("state/draft/venue.toml")));
  expect_ok("redo");
  EXPECT_EQ(state_["steps"]["field"], found);
  EXPECT_TRUE(fs::exists(path("state/draft/venue.toml")));
  expect_error("redo", {}, "nothing to redo");
}

}  // namespace
}  // namespace touchline::setup
