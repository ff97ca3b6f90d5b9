#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/console/server_fixture.h"

namespace touchline::console {
namespace {

class WebLimits : public ConsoleServer {
 protected:
  /// Reads until the connection ends and returns the code of its close frame.
  static int close_code_of(SocketPage& page) {
    for (;;) {
      const SocketMessage message = page.read();
      if (message.opcode == 8 || message.opcode == 0) return message.close_code();
    }
  }
  [[nodiscard]] std::unique_ptr<SocketPage> open_line() const {
    return std::make_unique<SocketPage>(port(), "", "/ws", "touchline.stop.1");
  }
  static bool answers(SocketPage& line) {
    line.send_text(text_of("ping", R"("request":1)"));
    return line.read().opcode == 1;
  }
  static std::filesystem::path folder() {
    return std::filesystem::temp_directory_path() / ("limits-" + std::to_string(::getpid()));
  }
  /// Whether the server still serves.
  void expect_alive() {
    SocketPage page(port());
    EXPECT_EQ(page.status(), 101);
    EXPECT_TRUE(page.read_type("state").has_value());
  }
};

TEST_F(WebLimits, ALargeMessageEndsTheConnection) {
  start();
  SocketPage page(port());
  page.send_frame(1, std::string(4097, ' '));
  // If the server has not read everything, the connection is reset, and the reason may be lost.
  const int code_of_one = close_code_of(page);
  EXPECT_TRUE(code_of_one == 1009 || code_of_one == 0) << code_of_one;
  SocketPage huge(port());
  // The length alone decides, because the content is never sent.
  huge.socket().send(std::string("\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xff\x01\x02\x03\x04", 14) +
                     std::string(8192, 'x'));
  close_code_of(huge);
  SocketPage pieces(port());
  pieces.send_frame(1, std::string(2000, ' '), false);
  pieces.send_frame(0, std::string(2000, ' '), false);
  pieces.send_frame(0, std::string(2000, ' '), true);
  const int code = close_code_of(pieces);
  EXPECT_TRUE(code == 1009 || code == 0) << code;
  expect_alive();
}

TEST_F(WebLimits, AMessageInPiecesIsUnderstood) {
  start();
  SocketPage page(port());
  page.send_frame(1, R"({"type":"st)", false);
  page.send_frame(0, R"(op"})", true);
  EXPECT_TRUE(eventually([&] { return input().stop; }));
}

TEST_F(WebLimits, MalformedMessagesGetAnErrorAndChangeNothing) {
  start();
  SocketPage page(port());
  for (const char* const text : {"", "x", "{\"type\":\"stop\"", "[]", "{\"type\":\"fly\"}"}) {
    page.send_text(text);
    const std::optional<std::string> answer = page.read_type("answer");
    ASSERT_TRUE(answer.has_value());
    EXPECT_NE(answer->find("\"ok\":false"), std::string::npos) << text;
  }
  EXPECT_FALSE(input().stop);
  page.send_frame(2, "binary");
  EXPECT_EQ(close_code_of(page), 1003);
  expect_alive();
}

TEST_F(WebLimits, AFloodOfMessagesEndsTheConnection) {
  start();
  SocketPage page(port());
  for (int i = 0; i < 2000; ++i) page.send_text(text_of("ping"));
  const int code = close_code_of(page);
  // The server may close before it has read all, which resets the connection.
  EXPECT_TRUE(code == 1008 || code == 0) << code;
  expect_alive();
}

TEST_F(WebLimits, ThereAreSixteenClients) {
  start();
  std::vector<std::unique_ptr<SocketPage>> pages;
  for (std::size_t i = 0; i < kMaxClients; ++i) {
    pages.push_back(std::make_unique<SocketPage>(port()));
    ASSERT_EQ(pages.back()->read().opcode, 1) << i;
  }
  SocketPage surplus(port());
  EXPECT_EQ(close_code_of(surplus), 1013);
  pages.pop_back();
  EXPECT_TRUE(eventually([&] { return SocketPage(port()).read().opcode == 1; })) << "a place is free again";
}

TEST_F(WebLimits, StopLinesTakeNoPlacesOfClientsAndAreAsMany) {
  start();
  std::vector<std::unique_ptr<SocketPage>> sockets;
  for (std::size_t i = 0; i < kMaxClients; ++i) {
    sockets.push_back(open_line());
    EXPECT_TRUE(answers(*sockets.back())) << i;
  }
  for (std::size_t i = 0; i < kMaxClients; ++i) {
    sockets.push_back(std::make_unique<SocketPage>(port()));
    ASSERT_EQ(sockets.back()->read().opcode, 1) << i;
  }
  const std::optional<std::string> status = sockets.back()->read_type("status");
  ASSERT_TRUE(status.has_value());
  EXPECT_EQ(nlohmann::json::parse(*status)["clients"], kMaxClients);
}

TEST_F(WebLimits, AnotherStopLineTakesThePlaceOfTheOneThatWasSilentLongest) {
  start();
  std::vector<std::unique_ptr<SocketPage>> lines;
  for (std::size_t i = 0; i < kMaxClients; ++i) {
    // The kernel reports the arrival of a message in ticks of its clock, of at most 10 ms.
    if (i == 2) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    lines.push_back(open_line());
    EXPECT_TRUE(answers(*lines.back()));
  }
  EXPECT_TRUE(answers(*lines[0])) << "a page asks every second";
  const std::unique_ptr<SocketPage> another = open_line();
  another->send_text(text_of("stop", R"("request":1)"));
  EXPECT_EQ(another->read().opcode, 1);
  EXPECT_TRUE(eventually([&] { return input().stop; }));
  EXPECT_TRUE(answers(*lines[0]));
  EXPECT_TRUE(eventually([&] { return !lines[1]->socket().is_open(); }));
  for (std::size_t i = 2; i < kMaxClients; ++i) EXPECT_TRUE(answers(*lines[i])) << i;
}

TEST_F(WebLimits, IdleConnectionsKeepNeitherANewPageNorAStopOut) {
  settings.patience.request_s = 600;  // none of them is closed because of its age
  std::filesystem::create_directories(folder());
  std::ofstream(folder() / "index.html") << "page";
  settings.page_folder = folder().string();
  start();
  std::vector<std::unique_ptr<SocketClient>> idle;
  const auto connect_idle = [&] {
    for (int i = 0; i < 150; ++i) idle.push_back(std::make_unique<SocketClient>(port()));
  };
  connect_idle();
  EXPECT_EQ(get(port(), "/").body, "page");
  SocketPage page(port());
  EXPECT_EQ(page.read().opcode, 1);
  connect_idle();
  const std::unique_ptr<SocketPage> line = open_line();
  line->send_text(text_of("stop", R"("request":1)"));
  EXPECT_EQ(line->read().opcode, 1);
  EXPECT_TRUE(eventually([&] { return input().stop; }));
  EXPECT_TRUE(idle.back()->is_open()) << "only as many are closed as necessary, the oldest first";
  EXPECT_FALSE(idle.front()->is_open());
  std::filesystem::remove_all(folder());
}

TEST_F(WebLimits, TheAddressWithTheMostConnectionsLosesThem) {
  settings.patience.request_s = 600;
  start();
  const SocketClient other({port(), "127.0.0.1", "127.0.0.2"});
  std::vector<std::unique_ptr<SocketClient>> idle;
  for (int i = 0; i < 150; ++i) idle.push_back(std::make_unique<SocketClient>(port()));
  EXPECT_EQ(get(port(), "/metrics").status, 200) << "all before it were accepted";
  EXPECT_TRUE(eventually([&] { return !idle.front()->is_open(); }));
  EXPECT_TRUE(other.is_open()) << "although it is the oldest";
}

TEST_F(WebLimits, WhoeverHasTheTokenFindsAPlaceWhenOthersHaveTakenAll) {
  settings.access.token = std::string(64, 'a');
  start();
  std::vector<std::unique_ptr<SocketPage>> pages;
  for (std::size_t i = 0; i < kMaxClients; ++i) {
    pages.push_back(std::make_unique<SocketPage>(port()));
    ASSERT_EQ(pages.back()->read().opcode, 1) << i;
  }
  const std::string cookie = "Cookie: touchline_token=" + settings.access.token + "\r\n";
  for (std::size_t i = 0; i < kPlacesForToken; ++i) {
    pages.push_back(std::make_unique<SocketPage>(port(), cookie));
    ASSERT_EQ(pages.back()->read().opcode, 1) << i;
  }
  SocketPage surplus(port(), cookie);
  EXPECT_EQ(close_code_of(surplus), 1013);
}

TEST_F(WebLimits, AClientThatNeverReadsIsDroppedAndOthersNoticeNothing) {
  start();
  SocketPage silent(port());
  silent.send_text(text_of("watch", R"("state_hz":60,"picture":{"rate_hz":60})"));
  // Without acknowledgments, at most two pictures are in flight, and states fill the socket's buffer.
  SocketPage reader(port());
  const std::uint64_t before = frames;
  while (frames < before + 300) ASSERT_TRUE(reader.read_type("state").has_value());
  EXPECT_LE(pictures_copied, 4U) << "pictures that nobody can take are not even copied";
}

TEST_F(WebLimits, DamagedRequestsEndTheirConnectionOnly) {
  start();
  for (const std::string& bytes : {std::string("\r\n\r\n"), std::string("GET\r\n\r\n"), std::string(8192, 'a'),
                                   "GET / HTTP/1.1\r\nHost: " + std::string(8192, 'a') + "\r\n\r\n",
                                   std::string("\0\xff\x16\x03\x01", 5), std::string("GET / HTTP/9.9\r\n\r\n")}) {
    SocketClient client(port());
    client.send(bytes);
  }
  // Half a request that is never completed.
  const SocketClient half(port());
  half.send("GET / HTTP/1.1\r\nHos");
  expect_alive();
}

}  // namespace
}  // namespace touchline::console
