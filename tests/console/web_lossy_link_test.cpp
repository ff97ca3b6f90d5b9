#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/console/lossy_link.h"
#include "tests/console/server_fixture.h"

// A link of 1 Mbit/s and 200 ms there and back that loses 5 % of the packets, with the kernel's TCP on both sides.
namespace touchline::console {
namespace {

using namespace std::chrono_literals;

class WebLossyLink : public ConsoleServer {
 protected:
  WebLossyLink() {
    settings.address = LossyLink::kBoardAddress;
    settings.access.token = std::string(64, 'a');
    is_crowded = true;
  }
  ~WebLossyLink() override { end_link(); }

  /// Returns nothing if the link is open and the board's console is served, else the reason why there is no link.
  std::string open() {
    const Result<void> opened = link_.open({});
    if (!opened.ok()) return opened.text();
    is_open_ = true;
    link_.enter_board();
    start();
    return {};
  }
  void end_link() {
    end();
    if (std::exchange(is_open_, false)) link_.leave();
  }
  std::unique_ptr<SocketPage> connect(std::string_view subprotocol = "touchline.1") {
    const std::string cookie = "Cookie: touchline_token=" + settings.access.token + "\r\n";
    return std::make_unique<SocketPage>(ServerAddress(port(), LossyLink::kBoardAddress), cookie, "/ws", subprotocol);
  }

  LossyLink link_;

 private:
  bool is_open_ = false;
};

// Messages that arrive at a page, while another thread sends.
class Reader {
 public:
  explicit Reader(SocketPage& page) : page_(page), thread_([this] { run(); }) {}
  /// After the other side has closed the connection.
  void join() { thread_.join(); }
  [[nodiscard]] std::size_t pictures() const { return pictures_; }
  [[nodiscard]] std::size_t answers() const { return answers_; }
  /// Sizes of pictures in bytes.
  [[nodiscard]] std::size_t first() const { return first_; }
  [[nodiscard]] std::size_t last() const { return last_; }

 private:
  void run() {
    for (SocketMessage message = page_.read(); message.opcode != 0; message = page_.read()) {
      if (message.payload.starts_with(R"({"type":"answer")")) ++answers_;
      if (message.opcode != 2) continue;
      std::uint64_t number = 0;
      for (std::size_t i = 8; i > 0; --i) number = number << 8 | static_cast<unsigned char>(message.payload[15 + i]);
      page_.send_text(text_of("seen", "\"number\":" + std::to_string(number)));
      last_ = message.payload.size();
      if (pictures_++ == 0) first_ = last_.load();
    }
  }

  SocketPage& page_;
  std::atomic<std::size_t> pictures_{0}, answers_{0}, first_{0}, last_{0};
  std::thread thread_;
};

TEST_F(WebLossyLink, ThePictureShrinksAndStopsArriveInTime) {
  if (const std::string refusal = open(); !refusal.empty()) GTEST_SKIP() << "no link between namespaces: " << refusal;
  const auto driver = connect();  // person at the board, who starts the robots again
  link_.enter_laptop();
  // As the page does, Stop is sent on both connections.
  const auto page = connect(), line = connect("touchline.stop.1");
  ASSERT_EQ(page->status(), 101);
  ASSERT_EQ(line->status(), 101);
  page->send_text(text_of("watch", R"("state_hz":15,"picture":{"rate_hz":15})"));
  Reader reader(*page);
  constexpr std::size_t kBytesPerPeriod = 125000 / 15;
  EXPECT_TRUE(eventually([&] { return reader.pictures() > 0 && reader.last() < kBytesPerPeriod; }));
  EXPECT_GT(reader.first(), 4 * kBytesPerPeriod);

  const auto ask_driver = [&](const char* type) {
    driver->send_text(text_of(type, "\"request\":1," + stop_in_force()));
    return driver->read_type("answer").value_or("").find("\"ok\":true") != std::string::npos;
  };
  constexpr std::size_t kStops = 12;
  std::vector<double> times_s;
  for (std::size_t i = 0; i < kStops; ++i) {
    // The second copy of the last stop may reach the loop only now.
    EXPECT_TRUE(ask_driver("take") && eventually([&] { return ask_driver("start"); }) && ask_driver("release"));
    EXPECT_TRUE(eventually([&] { return !input().stop; }));
    // Each stop is sent at another phase of the pictures.
    std::this_thread::sleep_for(100ms + 37ms * (i % 5));
    const std::size_t answers = reader.answers();
    const Instant begin = hal::MonotonicClock::read();
    page->send_text(text_of("stop", "\"request\":1"));
    line->send_text(text_of("stop", "\"request\":1"));
    EXPECT_TRUE(eventually([&] { return input().stop; }));
    times_s.push_back(seconds(hal::MonotonicClock::read() - begin));
    // A late stop must not be mistaken for the next one.
    EXPECT_TRUE(line->read_type("answer") && eventually([&] { return reader.answers() > answers; }));
  }
  std::sort(times_s.begin(), times_s.end());
  // Over the page's connection alone the median is 0.27 s and every fifth stop is late. Over both connections one stop
  // of 100 is late, because both of its packets are lost.
  EXPECT_GT(times_s.front(), 0.1) << "the link's delay";
  EXPECT_LT(times_s[kStops / 2], 0.2);
  EXPECT_LT(times_s[kStops - 3], 0.5) << "latest " << times_s.back();
  EXPECT_LT(times_s.back(), 5.0);
  EXPECT_GT(link_.lost(), link_.packets() / 50);
  EXPECT_LT(link_.lost(), link_.packets() / 8);
  end_link();
  reader.join();
}

}  // namespace
}  // namespace touchline::console
