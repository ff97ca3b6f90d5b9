#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "firmware/console/foxglove_messages.h"
#include "tests/console/server_fixture.h"

namespace touchline::console {
namespace {

// Channels as they are advertised.
constexpr int kState = 1, kScene = 2, kAnnotations = 3, kPicture = 4;

class WebFoxglove : public ConsoleServer {
 protected:
  [[nodiscard]] SocketPage connect(std::string_view headers = {}, std::string_view path = "/foxglove") const {
    return SocketPage(port(), headers, path, kFoxgloveSubprotocols[0]);
  }
  static nlohmann::json read_operation(SocketPage& page, std::string_view operation) {
    for (;;) {
      const SocketMessage message = page.read();
      if (message.opcode == 0 || message.opcode == 8) return {};
      if (message.opcode != 1) continue;
      nlohmann::json json = nlohmann::json::parse(message.payload);
      if (json["op"] == operation) return json;
    }
  }
  static std::string subscribe_text(int id, int channel) {
    return R"({"op":"subscribe","subscriptions":[{"id":)" + std::to_string(id) +
           ",\"channelId\":" + std::to_string(channel) + "}]}";
  }
  struct Data {
    std::uint32_t subscription = 0;
    std::uint64_t time_ns = 0;
    nlohmann::json json;
  };
  static Data read_data(SocketPage& page) {
    for (;;) {
      const SocketMessage message = page.read();
      if (message.opcode == 0 || message.opcode == 8) return {};
      if (message.opcode != 2) continue;
      EXPECT_EQ(message.payload[0], 1);
      Data data;
      for (std::size_t i = 4; i > 0; --i) {
        data.subscription = data.subscription << 8 | static_cast<unsigned char>(message.payload[i]);
      }
      for (std::size_t i = 12; i > 4; --i) {
        data.time_ns = data.time_ns << 8 | static_cast<unsigned char>(message.payload[i]);
      }
      data.json = nlohmann::json::parse(message.payload.substr(13));
      return data;
    }
  }
};

TEST_F(WebFoxglove, ChannelsAreOfferedWithTheirSchemas) {
  start();
  for (const char* const subprotocol : {"foxglove.websocket.v1", "foxglove.sdk.v1", "foxglove.new, foxglove.sdk.v1"}) {
    SocketPage page(port(), {}, "/foxglove", subprotocol);
    ASSERT_EQ(page.status(), 101) << subprotocol;
    const nlohmann::json info = read_operation(page, "serverInfo");
    EXPECT_TRUE(info["capabilities"].empty()) << "it only looks";
    const nlohmann::json channels = read_operation(page, "advertise")["channels"];
    ASSERT_EQ(channels.size(), 4U);
    EXPECT_EQ(channels[kScene - 1]["schemaName"], "foxglove.SceneUpdate");
    EXPECT_EQ(channels[kAnnotations - 1]["schemaName"], "foxglove.ImageAnnotations");
    EXPECT_EQ(channels[kPicture - 1]["schemaName"], "foxglove.CompressedImage");
    for (const nlohmann::json& channel : channels) {
      EXPECT_EQ(nlohmann::json::parse(channel["schema"].get<std::string>())["title"], channel["schemaName"]);
    }
  }
}

TEST_F(WebFoxglove, WhatNobodySubscribesToCostsNothing) {
  start();
  SocketPage page = connect();
  page.send_text(subscribe_text(7, kState));
  for (int i = 0; i < 10; ++i) EXPECT_EQ(read_data(page).subscription, 7U);
  EXPECT_EQ(pictures_copied, 0U);
  page.send_text(R"({"op":"unsubscribe","subscriptionIds":[7]})");
  page.send_text(subscribe_text(8, kScene));
  Data data = read_data(page);
  while (data.subscription == 7) data = read_data(page);
  EXPECT_EQ(data.json["entities"][0]["id"], "lines") << "the field comes first";
  EXPECT_EQ(data.json["entities"][1]["id"], "game");
  EXPECT_EQ(read_data(page).json["entities"].size(), 1U) << "and only once";
  EXPECT_EQ(pictures_copied, 0U);
}

TEST_F(WebFoxglove, AnnotationsComeWithTheirPicture) {
  start();
  SocketPage page = connect();
  page.send_text(subscribe_text(1, kPicture));
  page.send_text(subscribe_text(2, kAnnotations));
  int pictures = 0;
  std::uint64_t annotated = 0;
  while (pictures < 5) {
    const Data data = read_data(page);
    ASSERT_FALSE(data.json.is_null());
    if (data.subscription == 2) {
      annotated = data.time_ns;
      continue;
    }
    EXPECT_EQ(data.json["format"], "jpeg");
    EXPECT_TRUE(data.json["data"].get<std::string>().starts_with("/9j/")) << "the first bytes of a JPEG";
    const std::uint64_t stamp_ns = data.json["timestamp"]["sec"].get<std::uint64_t>() * 1'000'000'000U +
                                   data.json["timestamp"]["nsec"].get<std::uint64_t>();
    EXPECT_NEAR(static_cast<double>(stamp_ns), static_cast<double>(data.time_ns), 2e3) << "doubles of Unix time";
    if (annotated != 0) {
      EXPECT_EQ(annotated, data.time_ns);
      ++pictures;
    }
  }
}

TEST_F(WebFoxglove, NothingCanBeChanged) {
  start();
  SocketPage page = connect();
  for (const char* const text :
       {R"({"type":"stop"})", R"({"op":"stop"})", R"({"op":"setParameters","parameters":[]})",
        R"({"op":"advertise","channels":[]})", "x", "[]", R"({"op":1})", R"({"op":"subscribe"})",
        R"({"op":"subscribe","subscriptions":[1]})", R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":5}]})",
        R"({"op":"unsubscribe","subscriptionIds":["1"]})"}) {
    page.send_text(text);
    EXPECT_EQ(read_operation(page, "status")["level"], 2) << text;
  }
  EXPECT_FALSE(input().stop);
  page.send_text(subscribe_text(1, kState));
  page.send_text(subscribe_text(2, kState));
  EXPECT_NE(read_operation(page, "status")["message"].get<std::string>().find("already"), std::string::npos);
  page.send_frame(2, std::string("\x01\x01\x00\x00\x00{}", 7));
  SocketMessage message;
  do message = page.read();
  while (message.opcode == 1 || message.opcode == 2);
  EXPECT_EQ(message.close_code(), 1003);
}

TEST_F(WebFoxglove, OtherPagesNeedPermissionAndOtherPathsAreRefused) {
  settings.access.origins = {"https://app.foxglove.dev", "file://"};
  start();
  EXPECT_EQ(connect("Origin: https://app.foxglove.dev\r\n").status(), 101);
  EXPECT_EQ(connect("Origin: file://\r\n").status(), 101);
  EXPECT_NE(connect("Origin: https://evil.example\r\n").status(), 101);
  EXPECT_NE(connect("Host: evil.example\r\n").status(), 101);
  EXPECT_NE(connect("", "/ws").status(), 101);
  EXPECT_NE(connect("", "/").status(), 101);
  // Permission to look is none to drive.
  EXPECT_NE(SocketPage(port(), "Origin: file://\r\n").status(), 101);
  EXPECT_NE(SocketPage(port(), "", "/foxglove").status(), 101);
  EXPECT_EQ(get(port(), "/snapshot.jpg", "Origin: file://\r\n").status, 403);
}

TEST_F(WebFoxglove, ItsClientsCountAsTheOthers) {
  start();
  std::vector<std::unique_ptr<SocketPage>> pages;
  for (std::size_t i = 0; i < kMaxClients; ++i) {
    pages.push_back(std::make_unique<SocketPage>(port(), "", "/foxglove", kFoxgloveSubprotocols[0]));
    ASSERT_EQ(pages.back()->read().opcode, 1) << i;
  }
  SocketPage surplus = connect();
  const SocketMessage message = surplus.read();
  EXPECT_EQ(message.close_code(), 1013);
  SocketPage page(port());
  EXPECT_EQ(page.read().close_code(), 1013);
}

TEST_F(WebFoxglove, AClientThatNeverReadsGetsTwoPictures) {
  start();
  SocketPage silent = connect();
  silent.socket().shrink_window();
  silent.send_text(subscribe_text(1, kPicture));
  EXPECT_TRUE(eventually([&] { return pictures_copied > 0; }));
  const std::uint64_t before = frames;
  SocketPage reader = connect();
  reader.send_text(subscribe_text(1, kState));
  while (frames < before + 300) ASSERT_FALSE(read_data(reader).json.is_null());
}

}  // namespace
}  // namespace touchline::console
