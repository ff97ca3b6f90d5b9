#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "firmware/console/findings_message.h"
#include "tests/console/server_fixture.h"

namespace touchline::console {
namespace {

std::uint64_t number_at(std::string_view bytes, std::size_t begin, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = size; i > 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[begin + i - 1]);
  return value;
}

std::vector<int> expanded(std::string_view runs) {
  std::vector<int> values;
  for (std::size_t i = 0; i + 3 <= runs.size(); i += 3) {
    values.insert(values.end(), number_at(runs, i, 2), static_cast<unsigned char>(runs[i + 2]));
  }
  return values;
}

class WebFindings : public ConsoleServer {
 protected:
  WebFindings() { is_examined = true; }

  static nlohmann::json ask(SocketPage& page, std::string_view type, const std::string& members) {
    static int number = 0;
    page.send_text(text_of(type, "\"request\":" + std::to_string(++number) + (members.empty() ? "" : "," + members)));
    for (;;) {
      const std::optional<std::string> text = page.read_type("answer");
      if (!text) return {};
      nlohmann::json answer = nlohmann::json::parse(*text);
      if (answer["to"] == number) return answer;
    }
  }
};

TEST(RunLengths, AreExpandedToTheSameValues) {
  std::vector<std::byte> out;
  RunLengthWriter writer(out);
  std::vector<int> values(70000, 3);
  values.insert(values.end(), {0, 255, 255, 0});
  for (const int value : values) writer.add(static_cast<std::uint8_t>(value));
  writer.end();
  EXPECT_EQ(out.size(), 5U * 3) << "a run of 65535, then 4465";
  EXPECT_EQ(expanded({reinterpret_cast<const char*>(out.data()), out.size()}), values);
}

TEST_F(WebFindings, BelongToThePictureThatFollows) {
  start();
  SocketPage page(port());
  page.send_text(text_of("watch", R"("state_hz":30,"picture":{"rate_hz":30,"max_width_px":160},)"
                                  R"("findings":["classes","regions","light"])"));
  std::uint64_t state = 0, regions = 0, classes = 0, light = 0;
  for (int pictures = 0; pictures < 5;) {
    const SocketMessage message = page.read();
    ASSERT_TRUE(message.opcode == 1 || message.opcode == 2);
    if (message.opcode == 1) {
      const nlohmann::json object = nlohmann::json::parse(message.payload);
      if (object["type"] == "state") state = object["number"];
      if (object["type"] != "regions") continue;
      regions = object["number"];
      EXPECT_EQ(regions, state);
      ASSERT_EQ(object["regions"].size(), 1U) << object;
      const nlohmann::json& region = object["regions"][0];
      EXPECT_EQ(region[0], int{kPatch.left});
      EXPECT_EQ(region[1], int{kPatch.top});
      EXPECT_EQ(region[2], int{kPatch.right});
      EXPECT_EQ(region[3], int{kPatch.bottom});
      EXPECT_EQ(region[4], int{patch_color()});
      EXPECT_EQ(region[5], 16 * 16);
      EXPECT_EQ(object["left_out"], 0);
      continue;
    }
    const std::string_view bytes = message.payload;
    ASSERT_GT(bytes.size(), 32U);
    const std::uint64_t number = number_at(bytes, 16, 8);
    EXPECT_EQ(number, state);
    switch (bytes[5]) {
      case kClassesKind: {
        classes = number;
        EXPECT_EQ(number_at(bytes, 6, 2), 160U);
        EXPECT_EQ(number_at(bytes, 8, 2), 120U);
        EXPECT_EQ(number_at(bytes, 10, 2), 320U);
        const std::vector<int> values = expanded(bytes.substr(32));
        ASSERT_EQ(values.size(), 160U * 120);
        EXPECT_EQ(values[0], kOutsideClass) << "outside the region of interest";
        EXPECT_EQ(values[50 * 160 + 99], 0);
        EXPECT_EQ(values[50 * 160 + 100], int{patch_color()});
        EXPECT_EQ(values[57 * 160 + 107], int{patch_color()});
        EXPECT_EQ(values[58 * 160 + 107], 0);
        break;
      }
      case kLightKind:
        light = number;
        EXPECT_EQ(number_at(bytes, 6, 2), 1U) << "there is no light map";
        EXPECT_EQ(number_at(bytes, 12, 2), 320U);
        EXPECT_EQ(number_at(bytes, 14, 2), 240U);
        EXPECT_EQ(expanded(bytes.substr(32)), std::vector<int>{kNeutralLevel});
        break;
      default:
        ASSERT_EQ(bytes[5], kCameraKind);
        if (pictures > 0) {  // the first picture may have been requested before
          EXPECT_EQ(regions, number);
          EXPECT_EQ(classes, number);
          EXPECT_EQ(light, number);
        }
        page.send_text(text_of("seen", "\"number\":" + std::to_string(number)));
        ++pictures;
    }
  }
}

TEST_F(WebFindings, AProbeTellsTheCamerasOwnValues) {
  start();
  SocketPage page(port());
  page.send_text(text_of("watch", R"("state_hz":0,"picture":null)"));
  const std::uint64_t before = frames;
  nlohmann::json answer = ask(page, "probe", R"("u_px":207.4,"v_px":104.6)");
  ASSERT_EQ(answer["ok"], true) << answer;
  nlohmann::json result = answer["result"];
  EXPECT_GE(result["number"], before) << "a picture that was taken after the question";
  EXPECT_EQ(result["u_px"], 207);
  EXPECT_EQ(result["v_px"], 105);
  EXPECT_EQ(result["space"], "rgb");
  const std::array<std::uint8_t, 3> value = patch_value();
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(result["value"][c], int{value[c]});
    EXPECT_EQ(result["rgb"][c], int{value[c]});
  }
  EXPECT_EQ(result["class"], int{patch_color()});
  EXPECT_EQ(result["region"]["area_px"], 256);
  EXPECT_TRUE(result["floor"]["x_m"].is_number());
  result = ask(page, "probe", R"("u_px":100,"v_px":104)")["result"];
  EXPECT_EQ(result["class"], 0);
  EXPECT_EQ(result["value"], (nlohmann::json::array({0, 0, 0})));
  EXPECT_TRUE(result["region"].is_null());
  EXPECT_EQ(ask(page, "probe", R"("u_px":3,"v_px":104)")["result"]["class"], int{kOutsideClass});
  EXPECT_EQ(ask(page, "probe", R"("u_px":319.4,"v_px":239.4)")["ok"], true);
}

TEST_F(WebFindings, AProbeThatCannotBeAnsweredIsAnError) {
  camera_delivers = false;
  start();
  SocketPage page(port());
  page.send_text(text_of("watch", R"("state_hz":0,"picture":null)"));
  EXPECT_EQ(ask(page, "probe", R"("u_px":320,"v_px":0)")["error"], "the pixel is outside the camera's picture");
  EXPECT_EQ(ask(page, "probe", R"("u_px":1,"v_px":0)")["error"], "there is no picture that was examined");
  for (int i = 0; i < 5; ++i) page.send_text(text_of("probe", R"("request":99,"u_px":1,"v_px":1)"));
  EXPECT_EQ(nlohmann::json::parse(*page.read_type("answer"))["error"],
            "too many pixels are asked for at a time; wait for the answers");
  EXPECT_EQ(nlohmann::json::parse(*page.read_type("answer"))["error"], "there is no picture that was examined");
}

TEST_F(WebFindings, AScoreIsToldByTheDriverOnly) {
  start();
  SocketPage page(port());
  EXPECT_TRUE(nlohmann::json::parse(*page.read_type("state"))["score"].is_null());
  EXPECT_EQ(ask(page, "score", R"("own":1,"opponent":2)")["ok"], false);
  EXPECT_EQ(ask(page, "take", "")["ok"], true);
  EXPECT_EQ(ask(page, "score", R"("own":1,"opponent":2)")["ok"], true);
  static_cast<void>(page.read_type("state"));
  const nlohmann::json score = nlohmann::json::parse(*page.read_type("state"))["score"];
  EXPECT_EQ(score["own"], 1);
  EXPECT_EQ(score["opponent"], 2);
  EXPECT_EQ(score["source"], "console");
}

}  // namespace
}  // namespace touchline::console
