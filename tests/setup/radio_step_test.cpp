// The step Radio: one robot is tried and measured. The test takes the place of firmware, camera and robot.
#include "tools/programs/setup/radio_step.h"

#include <array>
#include <cmath>
#include <deque>
#include <random>
#include <utility>

#include "tests/setup/scripted_firmware.h"

namespace touchline::setup {
namespace {

constexpr std::int64_t kFrame_ns = 16666667;

class RadioStep : public ScriptedFirmware {
 protected:
  void begin() {
    for (const char* name : {"venue.toml", "venue-light.png", "venue-field.png"}) copy(name);
    start_program();
    expect_ok("begin");
  }
  /// Sends a frame 60 times a second of the test's own time, until the robot is no longer driven. `look` fills in what
  /// is seen, and gets the speeds that were answered.
  void serve_robot(const std::function<void(nlohmann::json& step)>& look) {
    serve_until([&] { return !tests_.empty(); });
    ASSERT_FALSE(HasFailure());
    EXPECT_EQ(tests_[0]["robot"], 1);
    answer_test("");
    while (tests_.size() == 1 && !HasFailure()) {
      now_ns_ += kFrame_ns;
      nlohmann::json step{{"type", "step"},      {"number", ++number_},     {"captured_ns", now_ns_ - 8000000},
                          {"sent_ns", now_ns_},  {"stop", wheels_.empty()}, {"halt", nlohmann::json::array()},
                          {"wheels_mps", last_}, {"sighting", nullptr},     {"robots", nlohmann::json::array()},
                          {"ball", nullptr},     {"packet_bytes", 33},      {"sent", ""},
                          {"received", ""}};
      look(step);
      const std::size_t before = wheels_.size();
      send_bytes(framed(step));
      serve_until([&] { return wheels_.size() > before || tests_.size() > 1; });
      if (wheels_.size() > before) last_ = {wheels_.back()["left_mps"], wheels_.back()["right_mps"]};
    }
    EXPECT_TRUE(tests_.back()["robot"].is_null()) << "the robot must stand at the end";
  }
  void answer_test(const std::string& error) { answer_test(tests_.back()["request"], error); }
  /// `to`: number of the request; 0: the firmware ends the test by itself.
  void answer_test(int to, const std::string& error) {
    send_bytes(framed({{"type", "tested"}, {"to", to}, {"ok", error.empty()}, {"error", error}}));
  }

  std::array<float, 2> last_{};
  std::int64_t now_ns_ = 5000000000, number_ = 0;
};

TEST_F(RadioStep, RollsTheWheelsOfOneRobotForALimitedTime) {
  begin();
  const int request =
      send("radio.pattern", {{"robot", 1}, {"pattern", "turn"}, {"speed_mps", 0.25}, {"duration_s", 0.5}});
  const auto begin_ns = now_ns_;
  serve_robot([](nlohmann::json& step) {
    step["sent"] = "544c01002a010006ff5efa005e7c";  // not a valid packet
    step["received"] =
        "54520103"
        "11f41c624a8c";  // the telemetry of docs/radio.md
  });
  const nlohmann::json answer = answer_to(request);
  ASSERT_TRUE(answer["ok"]) << answer.dump();
  EXPECT_NEAR(static_cast<double>(now_ns_ - begin_ns) * 1e-9, 0.5, 0.06);
  for (std::size_t i = 1; i + 1 < wheels_.size(); ++i) {
    EXPECT_EQ(wheels_[i]["left_mps"], -0.25) << i;
    EXPECT_EQ(wheels_[i]["right_mps"], 0.25) << i;
  }
  EXPECT_EQ(wheels_[0]["left_mps"], 0) << "robots still stand in the first frame";
  const nlohmann::json& exchange = answer["result"];
  EXPECT_GE(exchange["packets"], 30);
  EXPECT_EQ(exchange["received_bytes"], 10 * int(exchange["packets"]));
  EXPECT_NE(std::string(exchange["received"]).find("battery: 7412 = 7.412 V"), std::string::npos) << exchange.dump();
  EXPECT_NE(std::string(exchange["sent"]).find("unknown: 54 4C"), std::string::npos) << exchange.dump();
  EXPECT_TRUE(state_["undo"].empty()) << "the draft does not change";
  expect_error("radio.pattern", {{"robot", 1}, {"pattern", "sideways"}}, "sideways");
  expect_error("radio.pattern", {{"robot", 1}, {"pattern", "turn"}, {"duration_s", 60}}, "duration_s");
}

TEST_F(RadioStep, SaysWhyARobotStands) {
  begin();
  int request = send("radio.pattern", {{"robot", 1}, {"pattern", "forward"}});
  serve_until([&] { return !tests_.empty(); });
  answer_test("robots are stopped: press Start first");
  EXPECT_EQ(answer_to(request)["error"], "robot 1 stands: robots are stopped: press Start first");
  tests_.clear();
  request = send("radio.pattern", {{"robot", 1}, {"pattern", "forward"}});
  serve_robot([](nlohmann::json& step) {
    step["stop"] = true;
    step["halt"] = {"emergency", "button"};
  });
  EXPECT_EQ(answer_to(request)["error"], "robots stand: emergency, button");
}

TEST_F(RadioStep, AnswersToEarlierRequestsDoNotEndALaterOne) {
  begin();
  int request = send("radio.pattern", {{"robot", 1}, {"pattern", "forward"}, {"duration_s", 9}});
  serve_until([&] { return !tests_.empty(); });
  const int earlier = tests_[0]["request"];
  const int cancel = send("cancel");
  EXPECT_TRUE(answer_to(cancel)["ok"]);
  EXPECT_FALSE(answer_to(request)["ok"]);
  serve_until([&] { return tests_.size() == 2; });  // the order to end the test
  tests_.clear();
  request = send("radio.pattern", {{"robot", 1}, {"pattern", "forward"}, {"duration_s", 0.2}});
  serve_until([&] { return !tests_.empty(); });
  // The refusal and the end of the first test arrive late.
  answer_test(earlier, "the firmware was busy");
  answer_test(0, "the robots were stopped");
  serve_robot([](nlohmann::json&) {});
  const nlohmann::json answer = answer_to(request);
  EXPECT_TRUE(answer["ok"]) << answer.dump();
}

TEST_F(RadioStep, AnEndByTheFirmwareEndsTheTest) {
  begin();
  const int request = send("radio.pattern", {{"robot", 1}, {"pattern", "forward"}, {"duration_s", 9}});
  serve_robot([&](nlohmann::json&) {
    if (number_ == 20) answer_test(0, "the robots were stopped");
  });
  EXPECT_EQ(answer_to(request)["error"], "robot 1 stands: the robots were stopped");
}

TEST_F(RadioStep, CancelLetsTheRobotStand) {
  begin();
  const int request = send("radio.pattern", {{"robot", 1}, {"pattern", "forward"}, {"duration_s", 9}});
  int cancel = 0;
  serve_robot([&](nlohmann::json&) {
    if (number_ == 20) cancel = send("cancel");
  });
  EXPECT_TRUE(answer_to(cancel)["ok"]);
  EXPECT_EQ(answer_to(request)["error"], "radio.pattern was cancelled");
  EXPECT_LT(number_, 30);
}

// A robot without slip, whose left wheel drives faster than it is told.
class SimulatedRobot {
 public:
  static constexpr double kDelay_s = 0.05, kLag_s = 0.08, kBase_m = 0.07;
  static constexpr std::array<double, 2> kGain{1.08, 0.97};

  void command(const std::array<float, 2>& wheels) { commands_.push_back({time_s_ + kDelay_s, wheels}); }
  void advance(double until_s) {
    for (constexpr double kStep_s = 0.001; time_s_ < until_s; time_s_ += kStep_s) {
      while (!commands_.empty() && commands_.front().first <= time_s_) {
        told_ = commands_.front().second;
        commands_.pop_front();
      }
      for (std::size_t i = 0; i < 2; ++i) {
        rim_[i] += (kGain[i] * static_cast<double>(told_[i]) - rim_[i]) * (1.0 - std::exp(-kStep_s / kLag_s));
      }
      theta_ += kStep_s * (rim_[1] - rim_[0]) / kBase_m;
      x_ += kStep_s * 0.5 * (rim_[0] + rim_[1]) * std::cos(theta_);
      y_ += kStep_s * 0.5 * (rim_[0] + rim_[1]) * std::sin(theta_);
    }
  }
  /// With the noise of a camera, 0.1 mm and 0.1 degrees.
  nlohmann::json pose() {
    std::normal_distribution<double> noise;
    return {x_ + 1e-4 * noise(random_), y_ + 1e-4 * noise(random_), theta_ + 2e-3 * noise(random_)};
  }

 private:
  std::deque<std::pair<double, std::array<float, 2>>> commands_;
  std::array<float, 2> told_{};
  std::array<double, 2> rim_{};
  double time_s_ = 0.0, x_ = 0.0, y_ = 0.0, theta_ = 0.0;
  std::mt19937 random_{1};
};

TEST_F(RadioStep, MeasuresARobotAndWritesItsValuesIntoTheDraft) {
  begin();
  const int request = send("radio.measure", {{"robot", 1}});
  SimulatedRobot robot;
  const double start_s = static_cast<double>(now_ns_) * 1e-9;
  serve_robot([&](nlohmann::json& step) {
    // The commands of this frame reach the robot when it is sent; the picture was taken before.
    robot.advance(static_cast<double>(now_ns_ - 8000000) * 1e-9 - start_s);
    const nlohmann::json pose = robot.pose();
    step["sighting"] = pose;
    step["robots"] = {{{"own", true}, {"id", 1}, {"seen", true}, {"pose", pose}}};
    robot.advance(static_cast<double>(now_ns_) * 1e-9 - start_s);
    robot.command(last_);
  });
  const nlohmann::json answer = answer_to(request);
  ASSERT_TRUE(answer["ok"]) << answer.dump();
  const nlohmann::json& drive = state_["steps"]["radio"]["drive"];
  EXPECT_EQ(drive["robot"], 1);
  EXPECT_EQ(drive["wiring_ok"], true) << drive.dump();
  const auto value_of = [&](const std::string& name) {
    for (const nlohmann::json& one : drive["values"]) {
      if (one["name"] == name) return double(one["value"]);
    }
    return -1.0;
  };
  // 33 bytes at the mock board's 115200 baud.
  EXPECT_NEAR(value_of("delay"), 1e3 * SimulatedRobot::kDelay_s - 2.9, 3.0);
  EXPECT_NEAR(value_of("lag"), 1e3 * SimulatedRobot::kLag_s, 5.0);
  EXPECT_NEAR(value_of("gain of the left wheel"), SimulatedRobot::kGain[0], 0.01);
  EXPECT_NEAR(value_of("gain of the right wheel"), SimulatedRobot::kGain[1], 0.01);

  const std::string key = "own.robot[1].wheel_gain";
  expect_error("radio.write", {{"key", "radio.baud"}}, "was not measured");
  expect_ok("radio.write", {{"key", key}});
  const auto entry = [&] {
    for (const nlohmann::json& one : state_["steps"]["radio"]["drive"]["keys"]) {
      if (one["key"] == key) return one;
    }
    return nlohmann::json();
  };
  EXPECT_EQ(entry()["written"], true);
  const std::string wanted = "+wheel_gain = " + std::string(entry()["measured"]);
  const nlohmann::json differences = expect_ok("differences");
  EXPECT_NE(std::string(differences["files"][0]["diff"]).find(wanted), std::string::npos) << differences.dump();
  EXPECT_EQ(differences["problems"], "");
  expect_ok("undo");
  EXPECT_EQ(entry()["written"], false);
  // The list of robots may change meanwhile.
  const nlohmann::json others = {{{"id", 4}, {"colors", {"red"}}}, {{"id", 5}, {"colors", {"green"}}}};
  expect_ok("robots.set", {{"own", {{"robots", others}}}});
  expect_error("radio.write", {{"key", key}}, "measure again");
}

TEST_F(RadioStep, DoesNotMeasureARobotThatIsNotSeen) {
  begin();
  const int request = send("radio.measure", {{"robot", 1}});
  serve_robot([](nlohmann::json&) {});
  EXPECT_NE(std::string(answer_to(request)["error"]).find("does not see the robot"), std::string::npos);
  for (const nlohmann::json& wheels : wheels_) EXPECT_EQ(wheels["left_mps"], 0);
}

}  // namespace
}  // namespace touchline::setup
