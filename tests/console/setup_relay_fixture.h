#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "tests/console/server_fixture.h"
#include "tests/console/setup_peer.h"

namespace touchline::console {

/// A console, and a setup program that sends what the test tells it.
class SetupRelayTest : public ConsoleServer {
 protected:
  using json = nlohmann::json;

  SetupRelayTest() {
    std::string pattern = std::filesystem::temp_directory_path() / "touchline-setup-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
    setup_socket = folder_ + "/setup.sock";
  }
  ~SetupRelayTest() override {
    end();
    std::filesystem::remove_all(folder_);
  }
  /// A server, and a setup program that has sent its state.
  void start_both() {
    peer = std::make_unique<SetupPeer>(setup_socket);
    start();
    ASSERT_TRUE(peer->accept());
    EXPECT_EQ(peer->read().text["type"], "hello");
    peer->send(R"({"type":"setup","state":{"open":false}})");
  }
  static json read_json(SocketPage& page, std::string_view type) {
    const std::optional<std::string> text = page.read_type(type);
    EXPECT_TRUE(text.has_value()) << "the connection ended before " << type;
    return text ? json::parse(*text) : json();
  }
  static json read_answer(SocketPage& page, int request) {
    for (;;) {
      json answer = read_json(page, "answer");
      if (answer.is_null() || answer["to"] == request) return answer;
    }
  }
  static json ask(SocketPage& page, std::string_view type, std::string_view members, int request) {
    page.send_text(text_of(type, "\"request\":" + std::to_string(request) +
                                     (members.empty() ? std::string() : "," + std::string(members))));
    return read_answer(page, request);
  }
  /// Waits until the page knows it, from its first message or later.
  static void wait_for_program(SocketPage& page, bool is_running) {
    for (;;) {
      const SocketMessage message = page.read();
      ASSERT_NE(message.opcode, 0) << "the connection ended";
      if (message.opcode != 1) continue;
      const json told = json::parse(message.payload);
      if (told["type"] == "hello" && told["setup"] == is_running) return;
      if (told["type"] == "setup_program" && told["running"] == is_running) return;
    }
  }
  static void become_driver(SocketPage& page) { EXPECT_EQ(ask(page, "take", {}, 1)["ok"], true); }
  static void watch_setup(SocketPage& page) {
    EXPECT_EQ(ask(page, "watch", R"("state_hz":0,"setup":true)", 2)["ok"], true);
  }
  [[nodiscard]] bool is_in_log(std::string_view part) const {
    for (std::optional<Event> event = reports.events.after(0); event; event = reports.events.after(event->number)) {
      if (event->text.find(part) != std::string::npos) return true;
    }
    return false;
  }

  std::unique_ptr<SetupPeer> peer;

 private:
  std::string folder_;
};

}  // namespace touchline::console
