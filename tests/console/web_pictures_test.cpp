#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/console/server_fixture.h"

namespace touchline::console {
namespace {

std::uint64_t little_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[i - 1]);
  return value;
}

bool is_jpeg(std::string_view bytes) { return bytes.starts_with("\xff\xd8") && bytes.ends_with("\xff\xd9"); }

using WebPictures = ConsoleServer;

TEST_F(WebPictures, EachPictureFollowsTheStateOfItsFrame) {
  start();
  SocketPage page(port());
  page.send_text(text_of("watch", R"("state_hz":30,"picture":{"rate_hz":30,"max_width_px":160})"));
  std::uint64_t state = 0, last = 0;
  double captured_s = 0.0;
  for (int pictures = 0; pictures < 20;) {
    const SocketMessage message = page.read();
    ASSERT_TRUE(message.opcode == 1 || message.opcode == 2);
    if (message.opcode == 1) {
      const nlohmann::json json = nlohmann::json::parse(message.payload);
      if (json["type"] != "state") continue;
      EXPECT_TRUE(state == 0 || json["number"] > state) << "states never go back";
      state = json["number"];
      captured_s = json["captured_s"];
      continue;
    }
    const std::string_view bytes = message.payload;
    ASSERT_GT(bytes.size(), 32U);
    EXPECT_EQ(little_endian(bytes.substr(0, 4)), 0x43504C54U);
    EXPECT_EQ(bytes[4], 1);
    EXPECT_EQ(bytes[5], 1);
    EXPECT_EQ(little_endian(bytes.substr(6, 2)), 160U);
    EXPECT_EQ(little_endian(bytes.substr(8, 2)), 120U);
    EXPECT_EQ(little_endian(bytes.substr(10, 2)), 320U);
    const std::uint64_t number = little_endian(bytes.substr(16, 8));
    EXPECT_EQ(number, state);
    EXPECT_TRUE(pictures == 0 || number > last);
    EXPECT_NEAR(static_cast<double>(little_endian(bytes.substr(24, 8))) / 1e6, captured_s, 1e-3);
    EXPECT_TRUE(is_jpeg(bytes.substr(32)));
    last = number;
    page.send_text(text_of("seen", "\"number\":" + std::to_string(number)));
    ++pictures;
  }
}

TEST_F(WebPictures, TheFirstPictureWaitsForNoPeriod) {
  start();
  SocketPage page(port());
  page.send_text(text_of("watch", R"("state_hz":60,"picture":{"rate_hz":0.05})"));
  // The picture is copied with the next frame after the request. A period would last hundreds of states.
  int states = 0;
  for (SocketMessage message = page.read(); message.opcode != 2; message = page.read()) {
    ASSERT_EQ(message.opcode, 1);
    states += message.payload.starts_with(R"({"type":"state")") ? 1 : 0;
    ASSERT_LE(states, 20);
  }
}

TEST_F(WebPictures, NoMoreThanTwoPicturesAreSentWithoutAnAnswer) {
  start();
  SocketPage page(port());
  page.send_text(text_of("watch", R"("state_hz":10,"picture":{"rate_hz":60})"));
  int pictures = 0;
  for (int states = 0; states < 10;) {
    const SocketMessage message = page.read();
    ASSERT_NE(message.opcode, 0);
    pictures += message.opcode == 2 ? 1 : 0;
    states += message.opcode == 1 && message.payload.starts_with(R"({"type":"state")") ? 1 : 0;
  }
  EXPECT_EQ(pictures, 2);
}

TEST_F(WebPictures, NobodyWatchesAndNothingIsCopied) {
  start();
  SocketPage page(port());
  page.send_text(text_of("watch", R"("state_hz":30,"picture":null)"));
  const std::uint64_t before = frames;
  while (frames < before + 50) ASSERT_TRUE(page.read_type("state").has_value());
  EXPECT_EQ(pictures_copied, 0U);
}

TEST_F(WebPictures, ASnapshotIsTheNextPicture) {
  start();
  const HttpAnswer answer = get(port(), "/snapshot.jpg");
  EXPECT_EQ(answer.status, 200);
  EXPECT_NE(answer.head.find("content-type: image/jpeg"), std::string::npos);
  EXPECT_TRUE(is_jpeg(answer.body));
}

TEST_F(WebPictures, WithoutFramesASnapshotIsAnError) {
  camera_delivers = false;
  start();
  EXPECT_EQ(get(port(), "/snapshot.jpg").status, 503);
}

TEST_F(WebPictures, AStreamHasAllPictures) {
  start();
  SocketClient client(port());
  client.send("GET /stream.mjpg HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
  EXPECT_NE(client.read_until("\r\n\r\n").find("multipart/x-mixed-replace; boundary=frame"), std::string::npos);
  for (int i = 0; i < 5; ++i) {
    const std::string head = client.read_until("\r\n\r\n");
    const std::size_t length = head.find("content-length: ");
    ASSERT_TRUE(head.starts_with("--frame\r\n") && length != std::string::npos) << head;
    const std::string jpeg = client.read(std::stoul(head.substr(length + 16)));
    EXPECT_TRUE(is_jpeg(jpeg)) << i;
  }
}

TEST_F(WebPictures, MetricsAreInTheFormatOfPrometheus) {
  start();
  EXPECT_TRUE(eventually([&] { return frames > 20; }));
  const std::string text = get(port(), "/metrics").body;
  EXPECT_NE(text.find("# TYPE touchline_latency_seconds histogram\n"), std::string::npos) << text;
  EXPECT_NE(text.find("touchline_latency_seconds_bucket{le=\"+Inf\"} "), std::string::npos);
  EXPECT_NE(text.find("\n# TYPE touchline_frames_total counter\ntouchline_frames_total "), std::string::npos);
  EXPECT_NE(text.find("\ntouchline_halt 0\n"), std::string::npos);
}

}  // namespace
}  // namespace touchline::console
