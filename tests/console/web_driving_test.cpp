#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/console/server_fixture.h"

namespace touchline::console {
namespace {

using namespace std::chrono_literals;

class WebDriving : public ConsoleServer {
 protected:
  static nlohmann::json read_json(SocketPage& page, std::string_view type) {
    const std::optional<std::string> text = page.read_type(type);
    EXPECT_TRUE(text.has_value()) << "the connection ended before " << type;
    return text ? nlohmann::json::parse(*text) : nlohmann::json();
  }
  /// Sends the message and returns the answer to it.
  static nlohmann::json ask(SocketPage& page, std::string_view type, std::string_view members = {}) {
    static int number = 100;
    const std::string request = "\"request\":" + std::to_string(++number);
    page.send_text(text_of(type, members.empty() ? request : request + "," + std::string(members)));
    for (;;) {
      nlohmann::json answer = read_json(page, "answer");
      if (answer.is_null() || answer["to"] == number) return answer;
    }
  }
};

TEST_F(WebDriving, TheFirstMessageDescribesTheScene) {
  start();
  SocketPage page(port());
  const SocketMessage first = page.read();
  const nlohmann::json hello = nlohmann::json::parse(first.payload);
  EXPECT_EQ(hello["type"], "hello");
  EXPECT_EQ(hello["protocol"], 1);
  EXPECT_EQ(hello["version"], "1.2.3");
  EXPECT_EQ(hello["you"], 1);
  EXPECT_EQ(hello["field"]["length_m"], 2.2);
  EXPECT_EQ(hello["camera"]["width_px"], 320);
  EXPECT_EQ(hello["robots"].size(), 10U);
  EXPECT_EQ(hello["robots"][0]["patches"].size(), 2U);
  EXPECT_GT(hello["classes"].size(), 5U);
  const nlohmann::json& grid = hello["projection"];
  const std::size_t points = grid["columns"].get<std::size_t>() * grid["rows"].get<std::size_t>();
  ASSERT_EQ(grid["planes"].size(), 2U) << "floor and markers";
  EXPECT_EQ(grid["planes"][0]["uv_px"].size(), 2 * points);
  EXPECT_EQ(nlohmann::json::parse(SocketPage(port()).read().payload)["you"], 2);
}

TEST_F(WebDriving, AStopOfAnyClientReachesTheNextFrame) {
  start();
  SocketPage driver(port()), watcher(port());
  EXPECT_EQ(ask(driver, "take")["ok"], true);
  const std::uint64_t before = frames;
  EXPECT_EQ(ask(watcher, "stop")["ok"], true);
  // The answer is sent only after the input was passed on, so a frame that begins after it must not move robots.
  const std::uint64_t answered = frames;
  EXPECT_TRUE(eventually([&] { return frames > answered + 1; }));
  EXPECT_TRUE(input().stop) << "frame " << before << " to " << frames;
  nlohmann::json state;
  do state = read_json(watcher, "state");
  while (state["number"].get<std::uint64_t>() <= answered + 1);
  EXPECT_EQ(state["halt"], nlohmann::json::array({"console"}));
  EXPECT_EQ(state["stop_number"], 1);
  EXPECT_EQ(state["waits_for_start"], true);
  const nlohmann::json refused = ask(watcher, "start", stop_in_force());
  EXPECT_EQ(refused["ok"], false);
  EXPECT_NE(refused["error"].get<std::string>().find("take over"), std::string::npos);
  EXPECT_TRUE(input().stop);
  EXPECT_EQ(ask(driver, "start", stop_in_force())["ok"], true);
  EXPECT_TRUE(eventually([&] { return !input().stop; }));
}

// Six people at the field: one presses Start while another presses Stop.
TEST_F(WebDriving, AStartEndsOnlyTheStopThatItsPageHasShown) {
  start();
  SocketPage driver(port());
  std::vector<std::unique_ptr<SocketPage>> others;
  for (int i = 0; i < 5; ++i) others.push_back(std::make_unique<SocketPage>(port()));
  EXPECT_EQ(ask(driver, "take")["ok"], true);
  for (std::size_t round = 1; round <= 60; ++round) {
    EXPECT_EQ(ask(driver, "stop")["ok"], true);
    ASSERT_TRUE(eventually([&] { return stop_in_force() == "\"stop_number\":" + std::to_string(2 * round - 1); }))
        << stop_in_force() << " " << halt();
    const std::string shown = stop_in_force();
    EXPECT_EQ(ask(*others[round % others.size()], "stop")["ok"], true);
    const nlohmann::json answer = ask(driver, "start", shown);
    EXPECT_EQ(answer["ok"], false) << "round " << round;
    EXPECT_NE(answer["error"].get<std::string>().find("has come since"), std::string::npos) << answer;
  }
  const std::uint64_t answered = frames;
  EXPECT_TRUE(eventually([&] { return frames > answered + 1; }));
  EXPECT_TRUE(input().stop);
  const nlohmann::json without = ask(driver, "start");
  EXPECT_EQ(without["ok"], false);
  EXPECT_NE(without["error"].get<std::string>().find("must name the stop"), std::string::npos) << without;
  EXPECT_EQ(ask(driver, "start", stop_in_force())["ok"], true);
  EXPECT_TRUE(eventually([&] { return halt() == kHaltNone; }));
}

TEST_F(WebDriving, AStartFromBeforeASilenceDoesNotEndIt) {
  start();
  SocketPage driver(port());
  EXPECT_EQ(ask(driver, "take")["ok"], true);
  const std::string before = stop_in_force();
  EXPECT_TRUE(eventually([&] { return halt() == kHaltDriver; }));
  EXPECT_EQ(ask(driver, "start", before)["ok"], false);
  EXPECT_EQ(halt(), kHaltDriver);
  EXPECT_EQ(ask(driver, "start", stop_in_force())["ok"], true);
  EXPECT_TRUE(eventually([&] { return halt() == kHaltNone; }));
}

// The second connection carries no states and pictures behind which a Stop would wait.
TEST_F(WebDriving, AStopLineStopsAndDoesNothingElse) {
  start();
  SocketPage driver(port()), line(port(), {}, "/ws", "touchline.stop.1");
  ASSERT_EQ(line.status(), 101);
  EXPECT_EQ(ask(driver, "take")["ok"], true);
  EXPECT_EQ(ask(driver, "stop")["ok"], true);
  for (const auto& [type, members] :
       std::vector<std::pair<const char*, const char*>>{{"start", R"("stop_number":1)"},
                                                        {"take", ""},
                                                        {"watch", R"("state_hz":60)"},
                                                        {"setup", R"("command":"begin")"}}) {
    const nlohmann::json answer = ask(line, type, members);
    EXPECT_EQ(answer["ok"], false) << type;
    EXPECT_NE(answer["error"].get<std::string>().find("\"stop\" and \"ping\" only"), std::string::npos) << answer;
  }
  EXPECT_TRUE(eventually([&] { return input().stop; }));
  EXPECT_EQ(ask(driver, "start", stop_in_force())["ok"], true);
  EXPECT_TRUE(eventually([&] { return !input().stop; }));
  // It gets only answers.
  for (int number = 0; number < 3; ++number) {
    line.send_text(text_of("ping", "\"request\":" + std::to_string(number)));
    const nlohmann::json answer = nlohmann::json::parse(line.read().payload);
    EXPECT_EQ(answer["type"], "answer") << answer;
    EXPECT_EQ(answer["to"], number);
  }
  EXPECT_FALSE(input().stop);
  EXPECT_EQ(ask(line, "stop")["ok"], true);
  EXPECT_TRUE(eventually([&] { return input().stop; }));
}

TEST_F(WebDriving, TheLockIsTakenOverAndEverybodyIsTold) {
  start();
  SocketPage first(port()), second(port());
  EXPECT_EQ(read_json(first, "driver")["driver"], nullptr);
  EXPECT_EQ(ask(first, "take")["ok"], true);
  EXPECT_EQ(ask(first, "drive", R"("id":1,"speed_mps":0.5,"turn_radps":0)")["ok"], true);
  EXPECT_TRUE(eventually([&] { return input().commands.size() == 1; }));
  EXPECT_EQ(ask(second, "drive", R"("id":1,"speed_mps":0.5,"turn_radps":0)")["ok"], false);
  EXPECT_EQ(ask(second, "take")["ok"], true);
  nlohmann::json driver;
  do driver = read_json(first, "driver");
  while (driver["driver"] != 2);
  EXPECT_EQ(driver["you"], false);
  EXPECT_EQ(ask(first, "drive", R"("id":1,"speed_mps":0.5,"turn_radps":0)")["ok"], false);
  EXPECT_EQ(ask(second, "drive", R"("id":1,"speed_mps":-0.25,"turn_radps":0)")["ok"], true);
  EXPECT_TRUE(eventually([&] { return input().commands[0].twist.v_mps == -0.25f; }));
  EXPECT_FALSE(input().stop);
}

TEST_F(WebDriving, ASilentDriverStopsTheRobotsAndAnotherClientDoesNotKeepThemMoving) {
  start();
  SocketPage driver(port()), watcher(port());
  EXPECT_EQ(ask(driver, "take")["ok"], true);
  const Instant taken = hal::MonotonicClock::read();
  int turn = 0;
  EXPECT_TRUE(eventually([&] {
    if (++turn % 20 == 0) watcher.send_text(text_of("ping"));
    return halt() == kHaltDriver;
  }));
  EXPECT_GE(hal::MonotonicClock::read() - taken, 950ms);
  nlohmann::json event;
  do event = read_json(watcher, "event");
  while (event["text"].get<std::string>().find("was silent") == std::string::npos);
}

TEST_F(WebDriving, ADriverWhoseConnectionEndsStopsTheRobots) {
  start();
  auto driver = std::make_unique<SocketPage>(port());
  SocketPage watcher(port());
  EXPECT_EQ(ask(*driver, "take")["ok"], true);
  EXPECT_FALSE(input().stop);
  driver.reset();
  EXPECT_TRUE(eventually([&] { return input().stop; }));
  nlohmann::json told;
  do told = read_json(watcher, "driver");
  while (!told["driver"].is_null());
}

TEST_F(WebDriving, TheAdaptationIsTheDriversToo) {
  start();
  SocketPage page(port());
  EXPECT_EQ(ask(page, "adaptation", R"("action":"freeze")")["ok"], false);
  EXPECT_EQ(adaptation.freeze, 0U);
  EXPECT_EQ(ask(page, "take")["ok"], true);
  EXPECT_EQ(ask(page, "adaptation", R"("action":"freeze")")["ok"], true);
  EXPECT_EQ(adaptation.freeze, 1U);
}

TEST_F(WebDriving, WhoComesLaterGetsTheLastEvents) {
  for (int i = 1; i <= 150; ++i) reports.events.add("info", "line " + std::to_string(i));
  start();
  SocketPage page(port());
  EXPECT_EQ(read_json(page, "event")["text"], "line 51") << "the last hundred";
  EXPECT_EQ(read_json(page, "event")["text"], "line 52");
}

TEST_F(WebDriving, TheStatusHasHistograms) {
  start();
  SocketPage page(port());
  nlohmann::json status;
  do status = read_json(page, "status");
  while (!status.is_null() && status["latency"]["start"]["count"] < 20);
  EXPECT_EQ(status["latency"]["start"]["max_ms"], 5.0);
  EXPECT_EQ(status["latency"]["minute"]["p50_ms"], 5.0);
  EXPECT_EQ(status["frames_lost"], 0);
  EXPECT_EQ(status["clients"], 1);
  EXPECT_GT(status["memory_mb"], 1.0);
}

}  // namespace
}  // namespace touchline::console
