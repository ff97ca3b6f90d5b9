#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/console/server_fixture.h"
#include "tests/console/slow_link.h"

// Bad conditions: too many clients, clients that do not read or have disappeared, slow links, a camera without
// pictures.
namespace touchline::console {
namespace {

using namespace std::chrono_literals;

class WebConditions : public ConsoleServer {
 protected:
  using Pages = std::vector<std::unique_ptr<SocketPage>>;

  /// Returns whether the server answers a new client.
  [[nodiscard]] bool accepts() const { return SocketPage(port()).read().opcode == 1; }
  /// Returns the number of clients that a client is told.
  static std::uint64_t count_clients(SocketPage& page) {
    const std::optional<std::string> status = page.read_type("status");
    return status ? nlohmann::json::parse(*status)["clients"].get<std::uint64_t>() : 0;
  }
  /// Sends a request and returns its answer; null: the connection has ended.
  static nlohmann::json ask_with(SocketPage& page, int request, std::string_view type, std::string_view members = {}) {
    const std::string number = "\"request\":" + std::to_string(request);
    page.send_text(text_of(type, members.empty() ? number : number + "," + std::string(members)));
    for (;;) {
      const std::optional<std::string> answer = page.read_type("answer");
      if (!answer) return {};
      nlohmann::json json = nlohmann::json::parse(*answer);
      if (json["to"] == request) return json;
    }
  }
};

TEST_F(WebConditions, OfFiftyClientsSixteenAreServedAndTheOthersAreToldWhyNot) {
  start();
  SocketPage driver(port());
  EXPECT_EQ(ask_with(driver, 1, "take")["ok"], true);
  Pages pages;
  int served = 1, refused = 0;
  for (int i = 1; i < 50; ++i) {
    pages.push_back(std::make_unique<SocketPage>(port()));
    // In the meantime the driver drives as before.
    EXPECT_EQ(ask_with(driver, 100 + i, "drive", R"("id":1,"speed_mps":0.2,"turn_radps":0)")["ok"], true);
    const SocketMessage first = pages.back()->read();
    served += first.opcode == 1 ? 1 : 0;
    if (first.opcode != 8) continue;
    EXPECT_EQ(first.close_code(), 1013);
    EXPECT_EQ(first.payload.substr(2), "too many clients");
    ++refused;
  }
  EXPECT_EQ(served, static_cast<int>(kMaxClients));
  EXPECT_EQ(refused, 50 - static_cast<int>(kMaxClients));
  EXPECT_FALSE(input().stop);
  EXPECT_EQ(ask_with(*pages.front(), 2, "stop")["ok"], true);
  EXPECT_TRUE(eventually([&] { return input().stop; }));
  EXPECT_EQ(get(port(), "/metrics").status, 200) << "requests are served, too";
}

TEST_F(WebConditions, ConnectionsThatSayNothingDoNotKeepOthersOutForLong) {
  start();
  SocketPage page(port());
  std::vector<std::unique_ptr<SocketClient>> silent;
  // This is more than the server allows.
  for (int i = 0; i < 80; ++i) silent.push_back(std::make_unique<SocketClient>(port()));
  EXPECT_TRUE(page.read_type("state").has_value()) << "who is there already notices nothing";
  EXPECT_TRUE(eventually([&] { return get(port(), "/metrics").status == 200; }));
  EXPECT_TRUE(accepts());
}

TEST_F(WebConditions, AClientThatClosesItsWindowIsDropped) {
  settings.patience.unread = 500ms;
  is_crowded = true;
  start();
  SocketPage stuck(port());
  stuck.socket().shrink_window();
  stuck.send_text(text_of("watch", R"("state_hz":60,"picture":{"rate_hz":60})"));
  SocketPage watcher(port());
  watcher.send_text(text_of("watch", R"("state_hz":0)"));
  EXPECT_EQ(count_clients(watcher), 2U);
  EXPECT_TRUE(eventually([&] { return count_clients(watcher) == 1; }));
}

TEST_F(WebConditions, AConnectionWhoseOtherSideIsGoneIsClosed) {
  settings.patience.ask_after_s = 1;
  settings.patience.close_after_s = 4;
  start();
  SlowLink link(port(), 1e6, 0ms);
  SocketPage gone(link.port());
  EXPECT_EQ(ask_with(gone, 1, "take")["ok"], true);
  EXPECT_EQ(ask_with(gone, 2, "watch", R"("state_hz":0)")["ok"], true);
  SocketPage watcher(port());
  EXPECT_TRUE(eventually([&] { return count_clients(watcher) == 2; }));
  // Neither side learns of the broken link. The driver's silence stops the robots before the connection is given up.
  link.freeze();
  EXPECT_TRUE(eventually([&] { return count_clients(watcher) > 0 && halt() == kHaltDriver; }));
  EXPECT_TRUE(eventually([&] { return count_clients(watcher) == 1; }));
}

TEST_F(WebConditions, ADriverThatWasLostDoesNotDriveOnWhenItIsBack) {
  start();
  const char* const forward = R"("id":1,"speed_mps":0.4,"turn_radps":0)";
  SlowLink link(port(), 1e6, 5ms);
  SocketPage driver(link.port());
  EXPECT_EQ(ask_with(driver, 1, "take")["ok"], true);
  EXPECT_EQ(ask_with(driver, 2, "drive", forward)["ok"], true);
  link.freeze();
  for (int i = 0; i < 60; ++i)
    driver.send_text(text_of("drive", forward));  // the page does not notice for three seconds
  EXPECT_TRUE(eventually([&] { return halt() == kHaltDriver; }));
  // When the link works again, everything sent in between arrives at once, and must not move robots.
  link.thaw();
  EXPECT_EQ(ask_with(driver, 3, "ping")["ok"], true) << "the connection has survived";
  EXPECT_EQ(halt(), kHaltDriver);
  // A page that has to connect anew is another client, and has to take control and start.
  SocketPage again(port());
  EXPECT_EQ(ask_with(again, 4, "drive", forward)["ok"], false);
  EXPECT_EQ(ask_with(again, 5, "start", stop_in_force())["ok"], false);
  EXPECT_EQ(ask_with(again, 6, "take")["ok"], true);
  EXPECT_EQ(halt(), kHaltDriver);
  EXPECT_EQ(ask_with(again, 7, "start", stop_in_force())["ok"], true);
  EXPECT_TRUE(eventually([&] { return halt() == kHaltNone; }));
}

TEST_F(WebConditions, OverASlowLinkThePictureShrinksAndAStopIsConfirmedInTime) {
  is_crowded = true;
  start();
  // 1 Mbit/s, and 200 ms there and back.
  constexpr double kBytesPerS = 125e3;
  SlowLink link(port(), kBytesPerS, 100ms);
  SocketPage page(link.port());
  // The states alone are more than the link can carry.
  page.send_text(text_of("watch", R"("state_hz":60,"picture":{"rate_hz":15})"));
  std::size_t first = 0, last = 0;
  for (int pictures = 0; pictures < 30;) {
    const SocketMessage message = page.read();
    ASSERT_TRUE(message.opcode == 1 || message.opcode == 2);
    if (message.opcode != 2) continue;
    std::uint64_t number = 0;
    for (std::size_t i = 8; i > 0; --i) number = number << 8 | static_cast<unsigned char>(message.payload[15 + i]);
    page.send_text(text_of("seen", "\"number\":" + std::to_string(number)));
    last = message.payload.size();
    if (pictures++ == 0) first = last;
  }
  EXPECT_GT(first, 40000U) << "the link needs five periods for one";
  EXPECT_LT(last, kBytesPerS / 15);
  // Measured in the link's time, because this computer may be busy: the link always carries bytes, so their number
  // between a stop and its answer gives the time.
  const std::uint64_t before = link.passed();
  EXPECT_EQ(ask_with(page, 1, "stop")["ok"], true);
  const double answered_s = static_cast<double>(link.passed() - before) / kBytesPerS;
  EXPECT_GT(answered_s, 0.15) << "there and back";
  EXPECT_LT(answered_s, 0.5);
  EXPECT_TRUE(input().stop);
}

TEST_F(WebConditions, WithoutCameraThePageIsStillTold) {
  start();
  SocketPage page(port());
  page.send_text(text_of("watch", R"("state_hz":60,"picture":{"rate_hz":60})"));
  ASSERT_TRUE(page.read_type("state").has_value());
  camera_delivers = false;
  nlohmann::json status;
  do status = nlohmann::json::parse(page.read_type("status").value_or("null"));
  while (!status.is_null() && status["rate_hz"] != 0.0);
  ASSERT_FALSE(status.is_null());
  EXPECT_EQ(get(port(), "/snapshot.jpg").status, 503);
  EXPECT_EQ(ask_with(page, 1, "stop")["ok"], true);
  camera_delivers = true;
  EXPECT_TRUE(page.read_type("state").has_value());
  EXPECT_EQ(get(port(), "/snapshot.jpg").status, 200);
}

TEST_F(WebConditions, WithoutFramesTheStatusTellsWhyRobotsAreStopped) {
  camera_delivers = false;
  start();
  SocketPage page(port());
  StatusReport report;
  const auto halt_of_next_status = [&] {
    const std::optional<std::string> status = page.read_type("status");
    return status ? nlohmann::json::parse(*status)["halt"] : nlohmann::json("no status");
  };
  EXPECT_EQ(halt_of_next_status(), nullptr) << "the loop has said nothing yet";
  report.halt = kHaltNoFrames | kHaltConsole;
  reports.set(report);
  while (halt_of_next_status() == nullptr) reports.set(report);
  reports.set_halt({0.0, kHaltNoFrames, kHaltNone, 1});
  nlohmann::json halt = halt_of_next_status();
  // A status that was on its way may be the former one.
  for (int i = 0; i < 3 && halt != nlohmann::json{"no_frames"}; ++i, halt = halt_of_next_status()) {
    reports.set_halt({0.0, kHaltNoFrames, kHaltNone, 1});
  }
  EXPECT_EQ(halt, nlohmann::json{"no_frames"});
  EXPECT_TRUE(eventually([&] { return halt_of_next_status() == nullptr; })) << "the loop hangs: nothing is known";
}

}  // namespace
}  // namespace touchline::console
