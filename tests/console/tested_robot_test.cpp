// A robot that the setup program drives to test or measure it.
#include "firmware/console/tested_robot.h"

#include <gtest/gtest.h>

#include "tests/console/setup_relay_fixture.h"

namespace touchline::console {
namespace {

class TestedRobot : public SetupRelayTest {
 protected:
  /// A driver, and a calibrated draft in use.
  void start_with_draft() {
    use_files = [this](const config::FilePaths& files, std::uint64_t order) -> Result<FilesUse> {
      begin_session_later(!files.board.empty(), true, {}, order);
      return FilesUse::kInNextSession;
    };
    start_both();
    driver_ = std::make_unique<SocketPage>(port());
    wait_for_program(*driver_, true);
    become_driver(*driver_);
    peer->send(R"({"type":"use","request":4,"source":"draft","board":"/draft/board.toml"})");
    EXPECT_EQ(peer->read_type("used").text["ok"], true);
  }
  json tested(const std::string& robot) {
    peer->send(R"({"type":"test","request":5,"robot":)" + robot + "}");
    return peer->read_type("tested").text;
  }
  void drive() { peer->send(R"({"type":"wheels","left_mps":0.3,"right_mps":-0.2})"); }
  [[nodiscard]] bool stands() const {
    const ConsoleInput now = input();
    return now.setup == SetupWish::kStand && now.tested == kUnknownId;
  }

  std::unique_ptr<SocketPage> driver_;
};

TEST_F(TestedRobot, MovesWhileTheOthersStand) {
  start_with_draft();
  EXPECT_EQ(tested("1")["ok"], true);
  const json step = peer->read_type("step").text;
  for (const char* member : {"captured_ns", "sent_ns", "stop", "halt", "wheels_mps", "sighting", "robots", "ball",
                             "packet_bytes", "sent", "received"}) {
    EXPECT_TRUE(step.contains(member)) << member;
  }
  EXPECT_EQ(std::uint64_t(peer->read_type("step").text["number"]), std::uint64_t(step["number"]) + 1) << "every frame";
  EXPECT_EQ(input().tested, 1);
  EXPECT_EQ(input().setup, SetupWish::kStand) << "nothing was commanded yet";
  drive();
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kPermit; }));
  const ConsoleInput driven = input();
  EXPECT_EQ(driven.commands.size(), 5U);
  for (const ExternalCommand& command : driven.commands) {
    EXPECT_EQ(command.twist.v_mps, 0.0f);
    EXPECT_EQ(command.wheels.left_mps, command.id == 1 ? 0.3f : 0.0f);
    EXPECT_EQ(command.wheels.right_mps, command.id == 1 ? -0.2f : 0.0f);
  }
  EXPECT_EQ(ask(*driver_, "drive", R"("id":2,"speed_mps":0.5,"turn_radps":0)", 9)["ok"], false);
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kStand; })) << "no speeds for 0.3 s";
  drive();
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kPermit; }));
  EXPECT_EQ(tested("null")["ok"], true);
  EXPECT_TRUE(eventually([&] { return stands(); }));
  drive();
  EXPECT_EQ(tested("null")["ok"], true);  // an answer after the speeds were read
  EXPECT_TRUE(stands()) << "speeds count during a test only";
}

TEST_F(TestedRobot, StandsAfterAStopAndDoesNotGoOnAfterAStart) {
  start_with_draft();
  EXPECT_EQ(tested("1")["ok"], true);
  drive();
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kPermit; }));
  EXPECT_EQ(ask(*driver_, "stop", {}, 6)["ok"], true);
  const json ended = peer->read_type("tested").text;
  EXPECT_EQ(ended["ok"], false);
  EXPECT_EQ(ended["error"], "robots were stopped");
  EXPECT_TRUE(eventually([&] { return stands() && input().stop; }));
  EXPECT_EQ(tested("1")["error"], "robots are stopped: press Start first");
  EXPECT_EQ(ask(*driver_, "start", stop_in_force(), 7)["ok"], true);
  drive();
  EXPECT_EQ(tested("null")["ok"], true);
  EXPECT_TRUE(stands());
}

TEST_F(TestedRobot, StandsWhenTheDriverOrTheProgramLeaves) {
  start_with_draft();
  EXPECT_EQ(tested("1")["ok"], true);
  drive();
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kPermit; }));
  {
    SocketPage other(port());
    become_driver(other);
    EXPECT_EQ(peer->read_type("tested").text["error"], "whoever had control has left");
    EXPECT_TRUE(eventually([&] { return stands(); }));
    EXPECT_EQ(tested("1")["ok"], true);
    drive();
    EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kPermit; }));
    peer->hang_up();
    EXPECT_TRUE(eventually([&] { return stands(); }));
  }
}

TEST_F(TestedRobot, NeedsADraft) {
  start_both();
  SocketPage page(port());
  wait_for_program(page, true);
  EXPECT_EQ(tested("1")["error"], "no calibrated draft is in use");
}

TEST_F(TestedRobot, MustBeInTheTeam) {
  start_with_draft();
  EXPECT_EQ(tested("99")["error"], "the team file has no such robot");
  EXPECT_EQ(ask(*driver_, "release", {}, 6)["ok"], true);
  EXPECT_EQ(tested("1")["error"], "nobody has control");
}

}  // namespace
}  // namespace touchline::console
