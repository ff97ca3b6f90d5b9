#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "tests/setup/scripted_firmware.h"

// touchline-setup over its socket: what its steps measure and find.
namespace touchline::setup {
namespace {

namespace fs = std::filesystem;

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
  EXPECT_NEAR(field["seen_height_m"].get<double>(), 2.3, 0.1);
  EXPECT_EQ(field["entered"]["camera_height_m"], 2.3);
  EXPECT_EQ(field["entered"]["preset"], "mirosot-middle");
  // Border, goals, center line and circle: the arena has no penalty areas.
  EXPECT_EQ(field["overlay"].size(), 4u + 6u + 2u + 4u) << "and the triangles in the corners";
  EXPECT_EQ(field["values"]["penalty_area_depth_m"], 0.0);
  EXPECT_EQ(field["values"]["center_circle_m"], 0.25);
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

class SetupWithRegion : public ScriptedFirmware {
 protected:
  // Returns the warning about the field if the region of interest ends at this column.
  nlohmann::json field_with(const std::string& right_px) {
    write("etc/venue.toml", "version = 1\n[region_of_interest]\nu_px = [0, " + right_px + ", " + right_px +
                                ", 0]\nv_px = [0, 0, 480, 480]\n");
    start_program();
    camera_ = {arena_picture(hal::mock::Floor::kField, 1)};
    expect_ok("begin");
    expect_ok("field.find", kMiroSot);
    return state_["steps"]["field"];
  }
};

// A region drawn for another view of the camera would hide robots without a message.
TEST_F(SetupWithRegion, ThatLeavesOutHalfTheFieldIsNamed) {
  const nlohmann::json field = field_with("320");
  EXPECT_EQ(field["quality"]["level"], "warning");
  EXPECT_NE(field["notes"].dump().find("the region of interest leaves out 5"), std::string::npos) << field["notes"];
}

TEST_F(SetupWithRegion, ThatContainsTheFieldIsNotMentioned) {
  const nlohmann::json field = field_with("640");
  EXPECT_EQ(field["quality"]["level"], "ok");
  EXPECT_EQ(field["notes"].dump().find("region"), std::string::npos) << field["notes"];
}

// A result that the page calls good states its assumptions; a result that the picture contradicts is rejected.
TEST_F(ScriptedFirmware, JudgesAHeightByThePicture) {
  start_program();
  camera_ = {arena_picture(hal::mock::Floor::kField, 1)};
  expect_ok("begin");
  nlohmann::json field = kMiroSot;
  field["camera_height_m"] = 1.5;
  expect_error("field.find", field, "the picture alone says 2.3");
  field["camera_height_m"] = 2.3;
  expect_ok("field.find", field);
  EXPECT_NE(state_["steps"]["field"]["quality"]["text"].get<std::string>().find("if the height is right"),
            std::string::npos)
      << state_["steps"]["field"]["quality"];
  EXPECT_EQ(state_["steps"]["field"]["top_assumes"], " if the height is right");
  // No paper lies on this field.
  expect_error("light.measure", {{"surface", "grey"}}, "the field is not covered with grey paper");
}

// Goes from no venue file to robots that the pipeline recognizes.
TEST_F(ScriptedFirmware, CalibratesFromNothingAndSavesAllFiles) {
  start_program();
  camera_ = {arena_picture(hal::mock::Floor::kField, 1)};
  expect_ok("begin");
  expect_error("colors.find", {}, "calibrate the field first");
  expect_ok("field.find", kMiroSot);
  expect_ok("light.measure", {{"surface", "field"}});
  EXPECT_TRUE(state_["steps"]["light"]["done"]);
  EXPECT_GT(state_["steps"]["light"]["most"][0].get<double>(), state_["steps"]["light"]["least"][0].get<double>());
  picture(state_["steps"]["light"]["before"]);
  picture(state_["steps"]["light"]["after"]);

  camera_ = scene_pictures(arena::SceneKind::kStatic, 1, 3);
  expect_ok("colors.find");
  const nlohmann::json colors = state_["steps"]["colors"];
  EXPECT_TRUE(colors["done"]) << colors.dump();
  EXPECT_EQ(colors["wanted"], nlohmann::json::array());
  EXPECT_NE(colors["self_check"].get<std::string>().find("10 of 10 robots explained"), std::string::npos)
      << colors.dump();
  EXPECT_NE(colors["quality"]["level"], "bad") << colors["quality"];
  EXPECT_EQ(colors["confusion"]["rows"].size(), colors["names"].size());
  ASSERT_EQ(colors["pictures"].size(), 1u);
  picture(colors["pictures"][0]);
  picture(colors["found"][0]);
  picture(colors["checks"][0]);
  EXPECT_FALSE(state_["steps"]["robots"]["similar"].empty());
  EXPECT_EQ(expect_ok("differences")["problems"], "");

  // A click with a wrong color is not used, so it takes no pixels away.
  expect_ok("colors.click", {{"name", "orange"}, {"u_px", 5}, {"v_px", 5}});
  ASSERT_EQ(state_["steps"]["colors"]["clicks"].size(), 1u);
  EXPECT_FALSE(state_["steps"]["colors"]["clicks"][0]["used"]);
  picture(state_["steps"]["colors"]["mask"]);
  expect_ok("undo");
  EXPECT_EQ(state_["steps"]["colors"], colors);

  const nlohmann::json exported = expect_ok("export");
  const nlohmann::json written = expect_ok("save");
  EXPECT_EQ(written["files"].size(), 3u) << written.dump();
  EXPECT_NE(read("etc/venue.toml").find("name = \"orange\""), std::string::npos);
  // The export of the calibrated setup makes the same draft again.
  fs::remove(saved("venue.toml"));
  expect_ok("begin");
  const std::string text = exported["text"];
  constexpr std::size_t kPiece = 3000;
  const std::size_t parts = (text.size() + kPiece - 1) / kPiece;
  for (std::size_t part = 0; part < parts; ++part) {
    expect_ok("import", {{"part", part}, {"parts", parts}, {"text", text.substr(part * kPiece, kPiece)}});
  }
  EXPECT_TRUE(state_["steps"]["colors"]["done"]);
}

TEST_F(ScriptedFirmware, MeasuresTheCameraWithoutAStep) {
  start_program();
  expect_ok("begin");
  camera_ = {arena_picture(hal::mock::Floor::kField, 1)};
  const nlohmann::json sharp = expect_ok("camera.quality");
  EXPECT_EQ(sharp["histogram"].size(), 3u);
  ASSERT_TRUE(sharp["focus"].is_number()) << sharp.dump();
  hal::Picture& blurred = camera_[0];
  const std::vector<std::uint8_t> original = blurred.rgb8;
  constexpr std::size_t kReach = 4;
  for (std::size_t i = 3 * kReach; i + 3 * kReach < original.size(); ++i) {
    unsigned sum = 0;
    for (std::size_t k = 0; k <= 2 * kReach; ++k) sum += original[i - 3 * kReach + 3 * k];
    blurred.rgb8[i] = static_cast<std::uint8_t>(sum / (2 * kReach + 1));
  }
  const nlohmann::json soft = expect_ok("camera.quality");
  EXPECT_LT(soft["focus"].get<double>(), 0.6 * sharp["focus"].get<double>());
  EXPECT_NE(soft["quality"]["level"], "ok") << soft["quality"];
  EXPECT_EQ(state_["undo"], nlohmann::json::array());
}

// A person who follows the advice must not get the same advice again.
TEST_F(ScriptedFirmware, IsContentWithTheExposureThatItAdvises) {
  start_program();
  camera_ = {arena_picture(hal::mock::Floor::kField, 1)};
  const auto advised_us = [](const nlohmann::json& quality) {
    const std::string text = quality["notes"].dump(), before = "expose at most ";
    const std::size_t at = text.find(before);
    return at == std::string::npos ? 0 : std::stoi(text.substr(at + before.size()));
  };
  expect_ok("begin");
  int rounded_up = 0;
  for (const double speed : {0.7, 0.9, 1.1, 1.3, 1.7, 1.9, 2.3}) {
    expect_ok("set", {{"key", "control.drive.max_speed_mps"}, {"value", speed}});
    expect_ok("set", {{"key", "camera.exposure_us"}, {"value", 30000}});
    const nlohmann::json before = expect_ok("camera.quality");
    const int advice_us = advised_us(before);
    ASSERT_GT(advice_us, 0) << before["notes"];
    rounded_up += std::lround(before["exposure_limit_us"].get<double>()) > advice_us ? 1 : 0;
    expect_ok("set", {{"key", "camera.exposure_us"}, {"value", advice_us}});
    EXPECT_EQ(advised_us(expect_ok("camera.quality")), 0) << advice_us << " us was advised";
    expect_ok("set", {{"key", "camera.exposure_us"}, {"value", advice_us + 1}});
    EXPECT_EQ(advised_us(expect_ok("camera.quality")), advice_us);
  }
  EXPECT_GT(rounded_up, 0) << "a limit whose nearest whole number is too long";
}

// The picture with the advised exposure would be rejected, too, because it is too dark.
TEST_F(ScriptedFirmware, AdvisesMoreLightWithAnExposureThatWouldBeTooDark) {
  start_program();
  camera_ = {arena_picture(hal::mock::Floor::kField, 1)};
  expect_ok("begin");
  expect_ok("set", {{"key", "camera.exposure_us"}, {"value", 900000}});
  expect_ok("set", {{"key", "control.drive.max_speed_mps"}, {"value", 2.0}});
  EXPECT_NE(expect_ok("camera.quality")["notes"].dump().find(" us, with more light or more gain"), std::string::npos);
}

TEST_F(SetupOfACalibratedBoard, MeasuresTheNoiseOfStandingRobots) {
  start_program();
  const hal::Picture still = scene_pictures(arena::SceneKind::kStatic, 1, 3)[0];
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 3);
  for (int i = 0; i < 20; ++i) {
    hal::Picture& picture = camera_.emplace_back(still);
    for (std::uint8_t& value : picture.rgb8) {
      value = static_cast<std::uint8_t>(std::clamp(value + noise(random), 0.0, 255.0));
    }
  }
  expect_ok("begin");
  const std::string before = read("state/draft/venue.toml");
  expect_ok("confirm", {{"step", "robots"}});
  expect_ok("robots.noise");
  EXPECT_EQ(delivered_, 100u);
  const nlohmann::json robots = state_["steps"]["robots"];
  EXPECT_TRUE(robots["done"]) << "what was confirmed remains so";
  ASSERT_EQ(robots["noise"]["objects"].size(), 11u) << robots["noise"];
  for (const nlohmann::json& one : robots["noise"]["objects"]) {
    EXPECT_GE(one["sightings"].get<int>(), 95) << one;
    EXPECT_GT(one["position_mm"].get<double>(), 0.01) << one;
    EXPECT_LT(one["position_mm"].get<double>(), 0.5) << one;
    EXPECT_EQ(one["heading_deg"].is_null(), one["name"] == "ball") << one;
  }
  EXPECT_TRUE(robots["noise"]["has_ball"]);
  const std::string written = read("state/draft/venue.toml");
  EXPECT_NE(written, before);
  EXPECT_NE(written.find("[noise]"), std::string::npos);
  EXPECT_EQ(state_["undo"].back(), "noise of standing robots");
  expect_ok("undo");
  EXPECT_EQ(read("state/draft/venue.toml"), before);
  EXPECT_FALSE(state_["steps"]["robots"].contains("noise"));
}

TEST_F(SetupOfACalibratedBoard, RefusesTheNoiseOfMovingRobots) {
  start_program();
  camera_ = {scene_pictures(arena::SceneKind::kStatic, 1, 3)[0], scene_pictures(arena::SceneKind::kStatic, 1, 4)[0]};
  expect_ok("begin");
  expect_error("robots.noise", {}, "no robot stands still");
  EXPECT_EQ(state_["undo"], nlohmann::json::array());
}

TEST_F(ScriptedFirmware, MeasuresNoNoiseBeforeTheColors) {
  start_program();
  expect_ok("begin");
  expect_error("robots.noise", {}, "camera_model");
  EXPECT_TRUE(state_["busy"].is_null());
}

}  // namespace
}  // namespace touchline::setup
