#include <signal.h>

#include <filesystem>

#include "tests/setup/scripted_firmware.h"

// touchline-setup over its socket: the draft, its keys, trying and saving it.
namespace touchline::setup {
namespace {

namespace fs = std::filesystem;

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
  EXPECT_EQ(read("state/draft/venue.toml"), "version = 1\n");
  expect_ok("redo");
  EXPECT_EQ(state_["steps"]["field"], found);
  EXPECT_NE(read("state/draft/venue.toml"), "version = 1\n");
  expect_error("redo", {}, "nothing to redo");
}

TEST_F(ScriptedFirmware, SetsKeysAsStepsOfUndo) {
  start_program();
  expect_ok("begin");
  expect_ok("set", {{"key", "camera.exposure_us"}, {"value", 2000}});
  EXPECT_EQ(state_["steps"]["camera"]["values"]["exposure_us"], 2000);
  EXPECT_EQ(state_["undo"], nlohmann::json({"camera.exposure_us 2000"}));
  // All moves of a slider count as one step; another key begins a new one.
  expect_ok("set", {{"key", "camera.exposure_us"}, {"value", 2500}, {"continues", true}});
  EXPECT_EQ(state_["undo"], nlohmann::json({"camera.exposure_us 2500"}));
  expect_ok("set", {{"key", "camera.gain"}, {"value", 7}, {"continues", true}});
  EXPECT_EQ(state_["undo"].size(), 2u);
  expect_ok("undo");
  expect_ok("undo");
  EXPECT_EQ(state_["undo"], nlohmann::json::array());
  EXPECT_EQ(state_["steps"]["camera"]["values"]["exposure_us"], 5000);
  expect_ok("redo");
  expect_error("set", {{"key", "camera.exposure_us"}, {"value", -1}}, "exposure_us");
  expect_error("set", {{"key", "camera.speed"}, {"value", 1}}, "speed");
  expect_error("set", {{"key", "warp.speed"}, {"value", 1}}, "unknown");
  expect_error("set", {{"key", "camera.device"}, {"value", nlohmann::json::object()}}, "a value is");
  expect_ok("radio.set", {{"backend", "serial"}, {"device", "/dev/ttyUSB7"}});
  EXPECT_EQ(state_["steps"]["radio"]["values"]["device"], "/dev/ttyUSB7");
  EXPECT_EQ(state_["steps"]["radio"]["format"], "touchline");
  expect_ok("radio.set", {{"format", "gritsbot"}});
  EXPECT_EQ(state_["steps"]["radio"]["format"], "gritsbot");
  EXPECT_NE(std::string(state_["steps"]["radio"]["sample"]).find("a packet for each robot"), std::string::npos);
  expect_ok("robots.set", {{"own", {{"color", "yellow"}, {"robots", {{{"id", 3}, {"colors", {"red"}}}}}}}});
  EXPECT_EQ(state_["steps"]["robots"]["own"]["robots"].size(), 1u);
  // Both teams are yellow now.
  EXPECT_FALSE(state_["steps"]["robots"]["problems"].empty());
  EXPECT_FALSE(state_["steps"]["robots"]["done"]);
  expect_error("confirm", {{"step", "robots"}}, "yellow");
  expect_ok("undo");
  EXPECT_EQ(state_["steps"]["robots"]["problems"], nlohmann::json::array());
  expect_ok("confirm", {{"step", "camera"}});
  EXPECT_TRUE(state_["steps"]["camera"]["done"]);
}

// The page sends ids and colors only; a robot keeps what else the file says of it.
TEST_F(ScriptedFirmware, RobotsKeepKeysThatThePageDoesNotShow) {
  start_program();
  expect_ok("begin");
  const nlohmann::json robots = {{{"id", 0}, {"colors", {"red"}}}, {{"id", 1}, {"colors", {"green"}}}};
  expect_ok("robots.set", {{"own", {{"robots", robots}}}});
  expect_ok("set", {{"key", "own.robot[1].address"}, {"value", "192.168.1.11"}});
  expect_ok("set", {{"key", "own.robot[1].wheel_gain"}, {"value", {1.02, 0.97}}});
  const nlohmann::json exchanged = {{{"id", 1}, {"colors", {"blue"}}}, {{"id", 4}, {"colors", {"green"}}}};
  expect_ok("robots.set", {{"own", {{"robots", exchanged}}}});
  const nlohmann::json differences = expect_ok("differences");
  const std::string team = differences["files"][0]["diff"];
  EXPECT_NE(team.find("192.168.1.11"), std::string::npos) << team;
  EXPECT_NE(team.find("    wheel_gain = [ 1.02"), std::string::npos) << team;
  EXPECT_EQ(team.find("address"), team.rfind("address")) << "robot 4 is a new one: " << team;
}

TEST_F(ScriptedFirmware, WritesALayoutAndTheBallBeforeTheColors) {
  start_program();
  expect_ok("begin");
  const auto patch = [](const char* role, double x_m, double y_m) -> nlohmann::json {
    return {{"role", role}, {"outline", "circle"}, {"x_m", x_m}, {"y_m", y_m}, {"length_m", 0.04}, {"width_m", 0.04}};
  };
  nlohmann::json layout = {{"name", "ours"}, {"robot_side_m", 0.08}, {"height_m", 0.061}};
  layout["patches"] = {patch("team", 0, 0.01), patch("identification", -0.02, 0),
                       patch("identification", 0.02, 0.0125)};
  expect_ok("robots.set", {{"layout", layout},
                           {"ball", {{"color", "tennis green"}, {"radius_m", 0.033}}},
                           {"own", {{"layout", "ours"}, {"robots", {{{"id", 3}, {"colors", {"our paint", "red"}}}}}}}});
  const nlohmann::json robots = state_["steps"]["robots"];
  EXPECT_EQ(robots["problems"], nlohmann::json::array());
  const nlohmann::json& written = robots["layouts"][0];
  EXPECT_EQ(written["name"], "ours");
  EXPECT_EQ(written["own"], true);
  EXPECT_NEAR(written["height_m"].get<double>(), 0.061, 1e-6);
  EXPECT_EQ(written["patches"][2]["y_m"], 0.0125);
  EXPECT_EQ(robots["ball"], "tennis green");
  EXPECT_EQ(robots["ball_radius_m"], 0.033);
  EXPECT_EQ(state_["undo"].size(), 1u) << "one step of undo";
  // Only these colors are asked for.
  const std::vector<std::string> needed = state_["steps"]["colors"]["needed"];
  EXPECT_EQ(std::count(needed.begin(), needed.end(), "our paint"), 1);
  EXPECT_EQ(std::count(needed.begin(), needed.end(), "tennis green"), 1);
  EXPECT_EQ(std::count(needed.begin(), needed.end(), "green"), 0) << "of a robot that does not play any more";
  // A second layout of the same name replaces the first one.
  layout["height_m"] = 0.07;
  expect_ok("robots.set", {{"layout", layout}});
  EXPECT_NEAR(state_["steps"]["robots"]["layouts"][0]["height_m"].get<double>(), 0.07, 1e-6);
  EXPECT_NE(state_["steps"]["robots"]["layouts"][1]["name"], "ours");
  expect_ok("confirm", {{"step", "robots"}});
  EXPECT_EQ(state_["steps"]["robots"]["quality"]["level"], "ok") << state_["steps"]["robots"]["quality"];
  expect_error("robots.set", {{"layout", {{"name", "none"}, {"robot_side_m", 0.08}, {"height_m", 0}}}},
               "needs patches");
}

// A camera and its mode belong together, because between two separate steps the camera would not work.
TEST_F(ScriptedFirmware, ChoosesACameraAsOneStepOfUndo) {
  start_program();
  expect_ok("begin");
  expect_ok("confirm", {{"step", "camera"}});
  const nlohmann::json before = state_["steps"]["camera"]["values"];
  const nlohmann::json chosen{{"backend", "v4l2"}, {"device", "/dev/v4l/by-id/usb-A"},
                              {"format", "yuyv"},  {"width_px", 320},
                              {"height_px", 240},  {"rate_hz", 30}};
  expect_ok("set", {{"key", "radio.backend"}, {"value", "none"}});
  const std::size_t steps = state_["undo"].size();
  expect_ok("camera.set", chosen);
  EXPECT_EQ(state_["undo"].size(), steps + 1);
  const nlohmann::json values = state_["steps"]["camera"]["values"];
  for (const auto& [key, value] : chosen.items()) EXPECT_EQ(values[key], value) << key;
  EXPECT_FALSE(state_["steps"]["camera"]["done"]) << "another camera was confirmed";
  expect_ok("undo");
  EXPECT_EQ(state_["steps"]["camera"]["values"], before);
  EXPECT_TRUE(state_["steps"]["camera"]["done"]);
  expect_error("camera.set", {{"format", "jpeg"}}, "format");
}

TEST_F(ScriptedFirmware, AnotherModeOfTheCameraNeedsAnotherCalibration) {
  copy("venue.toml");
  copy("venue-light.png");
  copy("venue-field.png");
  start_program();
  expect_ok("begin");
  EXPECT_TRUE(state_["steps"]["field"]["done"]);
  EXPECT_TRUE(state_["steps"]["colors"]["done"]);
  // The mock board's files are for RGB pictures of 640 x 480.
  expect_ok("camera.set", {{"format", "yuyv"}, {"width_px", 320}, {"height_px", 240}});
  const nlohmann::json& steps = state_["steps"];
  EXPECT_FALSE(steps["field"]["done"]);
  EXPECT_EQ(steps["field"]["quality"]["text"],
            "found for pictures of 640 x 480 pixels, but the camera is set to 320 x 240; find the field again");
  EXPECT_FALSE(steps["colors"]["done"]);
  EXPECT_EQ(steps["colors"]["quality"]["text"], "found in rgb, but the camera is set to yuv; find the colors again");
  expect_ok("undo");
  EXPECT_TRUE(state_["steps"]["field"]["done"]);
  EXPECT_TRUE(state_["steps"]["colors"]["done"]);
  // Files for other pictures are calibrated again with pictures of the present camera.
  expect_ok("set", {{"key", "picture.width_px"}, {"value", 320}});
  EXPECT_FALSE(state_["steps"]["field"]["done"]);
  camera_ = {arena_picture(hal::mock::Floor::kField, 1)};
  expect_ok("field.find", {{"preset", "mirosot-middle"}, {"camera_height_m", 0}, {"ignore_lines", false}});
  EXPECT_TRUE(state_["steps"]["field"]["done"]) << state_["steps"]["field"]["quality"];
}

TEST_F(ScriptedFirmware, KeepsCommentsAndWritesShortNumbers) {
  write("etc/team.toml", read("etc/team.toml") + "\n[control.drive] # ours\nmax_speed_mps = 1.5 # not more\n");
  start_program();
  expect_ok("begin");
  expect_ok("set", {{"key", "control.drive.max_speed_mps"}, {"value", 2.2000000476837158}});
  EXPECT_NE(read("state/draft/team.toml").find("[control.drive] # ours\nmax_speed_mps = 2.2 # not more\n"),
            std::string::npos)
      << read("state/draft/team.toml");
  expect_ok("set", {{"key", "radio.delay_s"}, {"value", 0.0123}});
  EXPECT_EQ(state_["steps"]["radio"]["values"]["delay_s"].dump(), "0.0123");
}

TEST_F(ScriptedFirmware, RefusesBadInputAndLives) {
  copy("venue.toml");
  copy("venue-light.png");
  copy("venue-field.png");
  start_program();
  expect_error("undo", {}, "begin first");
  expect_error("warp", {}, "unknown");
  expect_ok("begin");
  camera_ = {hal::Picture{640, 480, std::vector<std::uint8_t>(std::size_t{3} * 640 * 480, 0), {}}};
  expect_error("field.find", {{"preset", 5}}, "\"preset\" must be a text");
  expect_error("field.find", {{"preset", "chess"}}, "chess is unknown");
  expect_error("field.corners", {{"corners_px", {{1, 2}, {3, 4}}}}, "4 pixels");
  expect_error("field.corners", {{"corners_px", {{1, 2}, {3, 4}, {5, 1e9}, {7, 8}}}}, "4 pixels");
  expect_error("import", {{"part", 1}, {"parts", 2}, {"text", ""}}, "in order");
  expect_error("import", {{"part", 0}, {"parts", 1}, {"text", "{}"}}, "no exported setup");
  const std::string evil =
      R"({"format":"touchline-setup","version":1,"board":"board.toml","files":{"../x.toml":{"text":""}}})";
  expect_error("import", {{"part", 0}, {"parts", 1}, {"text", evil}}, "forbidden name");
  expect_error("picture", {{"id", 99}}, "no picture");
  camera_error_ = "the camera is gone";
  expect_error("light.measure", {{"surface", "grey"}}, "the camera is gone");
  camera_error_.clear();
  expect_error("field.find", kMiroSot, "border");
  expect_error("light.measure", {{"surface", "moon"}}, "moon is unknown");
  EXPECT_EQ(state_["undo"], nlohmann::json::array());
  // Not a message at all: the connection ends, the program and its draft stay.
  for (const std::string& bytes : {std::string("GET / HTTP/1.1\r\n\r\n"), std::string(8, '\xff'),
                                   std::string("\x02\0\0\0\0\0\0\0[]", 10), std::string("\x02\0\0\0\0\0\0\0{]", 10)}) {
    send_bytes(bytes);
    connect();
    EXPECT_TRUE(run("state").value("ok", false));
    EXPECT_TRUE(state_["open"]);
  }
}

// Starting a session cancels a running try: a "Try it" right after a change must not be forgotten.
TEST_F(SetupOfACalibratedBoard, TriesTheDraftWhenItsFilesAreLoaded) {
  start_program();
  expect_ok("begin");
  loads_ = false;
  expect_ok("confirm", {{"step", "robots"}});
  expect_ok("use", {{"source", "draft"}});
  serve_until([&] { return used_.size() == 2; });
  expect_ok("use", {{"source", "draft"}});  // is stale before it was loaded
  expect_ok("try", {{"on", true}});
  EXPECT_TRUE(state_["trying"]);
  EXPECT_TRUE(tries_.empty()) << "the firmware would end it with the next session";
  answer_use();
  serve_until([&] { return used_.size() == 3; });
  expect_ok("differences");
  EXPECT_TRUE(tries_.empty()) << "the newest files are still being loaded";
  answer_use();
  serve_until([&] { return !tries_.empty(); });
  EXPECT_EQ(tries_.back()["on"], true);
  send_bytes(framed({{"type", "tried"}, {"to", tries_.back()["request"]}, {"ok", true}}));
  expect_ok("differences");
  EXPECT_TRUE(state_["trying"]);
  send_bytes(framed({{"type", "tried"}, {"to", 0}, {"ok", false}, {"error", "the files have changed"}}));
  serve_until([&] { return state_["trying"] == false; });
}

TEST_F(SetupOfACalibratedBoard, DoesNotTryFilesThatCannotBeLoaded) {
  start_program();
  expect_ok("begin");
  loads_ = false;
  expect_ok("use", {{"source", "draft"}});
  expect_ok("try", {{"on", true}});
  answer_use("venue.toml: colors: is missing");
  serve_until([&] { return state_["trying"] == false; });
  EXPECT_TRUE(tries_.empty());
}

// A tick means that a person has compared and driven, not that the colors of the files differ.
TEST_F(SetupOfACalibratedBoard, TicksRobotsAndRadioOnlyWhenAPersonHasConfirmedThem) {
  const auto level = [&](const char* step) { return state_["steps"][step]["quality"]["level"]; };
  start_program();
  expect_ok("begin");
  EXPECT_EQ(level("robots"), "none") << state_["steps"]["robots"]["quality"];
  EXPECT_EQ(level("radio"), "none");
  EXPECT_FALSE(state_["steps"]["robots"]["done"]);
  EXPECT_FALSE(state_["steps"]["radio"]["done"]);
  expect_ok("confirm", {{"step", "robots"}});
  expect_ok("confirm", {{"step", "radio"}});
  EXPECT_EQ(level("robots"), "ok");
  EXPECT_EQ(level("radio"), "ok");
  // A later change was not confirmed; the other step stays confirmed.
  expect_ok("set", {{"key", "radio.baud"}, {"value", 38400}});
  EXPECT_EQ(level("radio"), "none");
  EXPECT_EQ(level("robots"), "ok");
  expect_ok("robots.set", {{"own", {{"robots", {{{"id", 3}, {"colors", {"red"}}}}}}}});
  EXPECT_EQ(level("robots"), "none");
  expect_ok("undo");
  EXPECT_EQ(level("robots"), "ok") << "undone with the change";
}

TEST_F(ScriptedFirmware, CancelsWork) {
  start_program();
  expect_ok("begin");
  delivers_ = false;
  const int request = send("light.measure", {{"surface", "moving"}});
  serve_until([&] { return state_["busy"].is_object(); });
  expect_error("field.find", kMiroSot, "still running");
  expect_ok("cancel");
  EXPECT_EQ(answer_to(request)["ok"], false);
  EXPECT_TRUE(state_["busy"].is_null());
}

TEST_F(ScriptedFirmware, ContinuesADraftAfterARestart) {
  start_program();
  expect_ok("begin");
  expect_ok("set", {{"key", "camera.exposure_us"}, {"value", 2000}});
  stop_program(SIGKILL);
  start_program();
  expect_ok("begin");
  EXPECT_EQ(state_["steps"]["camera"]["values"]["exposure_us"], 2000);
  EXPECT_EQ(state_["changed_files"], nlohmann::json({"board.toml", "venue.toml"}));
  expect_ok("discard");
  EXPECT_EQ(read("etc/board.toml").find("2000"), std::string::npos);
}

TEST_F(ScriptedFirmware, SavesAllFilesOrNone) {
  start_program();
  expect_ok("begin");
  expect_ok("set", {{"key", "camera.exposure_us"}, {"value", 2000}});
  expect_ok("set", {{"key", "ball.radius_m"}, {"value", 0.022}});
  const std::string board = read("etc/board.toml"), team = read("etc/team.toml");
  // A folder in the place of a backup: the save fails after the files were prepared.
  fs::create_directories(saved("team.toml.bak/x"));
  expect_error("save", {}, "nothing was saved");
  EXPECT_EQ(read("etc/board.toml"), board);
  EXPECT_EQ(read("etc/team.toml"), team);
  EXPECT_TRUE(state_["open"]);
  fs::remove_all(saved("team.toml.bak"));
  // Somebody edits a file meanwhile.
  write("etc/team.toml", team + "# by hand\n");
  expect_error("save", {}, "team.toml");
  expect_ok("save", {{"overwrite", true}});
  EXPECT_NE(read("etc/board.toml").find("2000"), std::string::npos);
  EXPECT_EQ(read("etc/board.toml.bak"), board);
  EXPECT_EQ(read("etc/team.toml.bak"), team + "# by hand\n");
}

}  // namespace
}  // namespace touchline::setup
