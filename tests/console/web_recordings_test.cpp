// Recordings over HTTP, and their control: a disk that blocks holds up nothing else, and only the driver may change
// anything.
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <nlohmann/json.hpp>
#include <vector>

#include "tests/console/server_fixture.h"

namespace touchline::console {
namespace {

using Json = nlohmann::json;

/// One recording, a.mcap, on a disk that answers when it may.
class FakeRecordings final : public Recordings {
 public:
  [[nodiscard]] std::optional<RecordingStatus> status() const override {
    RecordingStatus status;
    status.is_on = is_on;
    status.file = "a.mcap";
    return status;
  }
  Result<void> set_on(bool on, const std::string& /*who*/) override {
    is_on = on;
    return {};
  }
  Result<std::string> list() override {
    wait();
    return std::string("{\"recordings\":[]}");
  }
  Result<std::string> describe(const std::string& name) override {
    TOUCHLINE_TRY(check(name));
    return std::string("{\"frames\":3}");
  }
  Result<std::string> frames(const std::string& name, const FrameRange& range) override {
    TOUCHLINE_TRY(check(name));
    if (range.from >= 3) return failure(ErrorCode::kOutOfRange, "a.mcap: has 3 frames");
    return std::to_string(range.from) + " " + std::to_string(range.count) + " " + std::to_string(range.step);
  }
  Result<std::uint64_t> size(const std::string& name) override {
    TOUCHLINE_TRY(check(name));
    return content.size();
  }
  Result<std::string> read(const std::string& /*name*/, std::uint64_t offset, std::uint64_t bytes) override {
    largest = std::max(largest.load(), bytes);
    return content.substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(bytes));
  }
  Result<void> remove(const std::string& name) override {
    TOUCHLINE_TRY(check(name));
    is_removed = true;
    return {};
  }

  void wait() {
    ++waiting;
    if (blocks) answers.wait();
  }
  static Result<void> check(const std::string& name) {
    if (name == "a.mcap") return {};
    return failure(ErrorCode::kNotFound, "there is no recording of this name");
  }

  std::atomic<bool> is_on{false}, is_removed{false}, blocks{false};
  std::atomic<int> waiting{0};
  std::atomic<std::uint64_t> largest{0};
  std::promise<void> disk;
  std::shared_future<void> answers = disk.get_future().share();
  std::string content;
};

class WebRecordings : public ConsoleServer {
 protected:
  WebRecordings() { recordings = fake; }
  /// Returns the error of the answer; "": it was done.
  static std::string ask(SocketPage& page, std::string_view type, const std::string& members = {}) {
    page.send_text(text_of(type, R"("request":7)" + members));
    for (;;) {
      const std::optional<std::string> answer = page.read_type("answer");
      if (!answer) return "no answer";
      const Json json = Json::parse(*answer);
      if (json["to"] == 7) return json.value("error", "");
    }
  }

  const std::shared_ptr<FakeRecordings> fake = std::make_shared<FakeRecordings>();
};

TEST_F(WebRecordings, AreReadOverHttp) {
  for (int i = 0; i < 200'000; ++i) fake->content += std::to_string(i);  // about a megabyte: several parts
  start();
  EXPECT_EQ(get(port(), "/recordings").body, "{\"recordings\":[]}");
  EXPECT_EQ(get(port(), "/recordings/a.mcap").body, "{\"frames\":3}");
  EXPECT_EQ(get(port(), "/recordings/a.mcap/frames?from=2&count=5&step=4").body, "2 5 4");
  EXPECT_EQ(get(port(), "/recordings/a.mcap/frames").body, "0 1 1");
  EXPECT_EQ(get(port(), "/recordings/a.mcap/frames?from=3").status, 400);
  EXPECT_EQ(get(port(), "/recordings/b.mcap").status, 404);
  EXPECT_EQ(get(port(), "/recordings/a.mcap/other").status, 404);
  const HttpAnswer file = get(port(), "/recordings/a.mcap/file");
  EXPECT_EQ(file.status, 200);
  EXPECT_TRUE(file.body == fake->content) << file.body.size() << " bytes instead of " << fake->content.size();
  EXPECT_NE(file.head.find("filename=\"a.mcap\""), std::string::npos) << file.head;
  EXPECT_LE(fake->largest, 1U << 20) << "the memory is bounded";
}

TEST_F(WebRecordings, WithoutAFolderThereIsAnEmptyList) {
  recordings = nullptr;
  start();
  const HttpAnswer list = get(port(), "/recordings");
  EXPECT_EQ(list.status, 200);
  EXPECT_TRUE(Json::parse(list.body)["folder"].is_null());
  EXPECT_EQ(get(port(), "/recordings/a.mcap").status, 404);
  SocketPage page(port());
  EXPECT_EQ(ask(page, "take"), "");
  EXPECT_NE(ask(page, "recording", R"(,"action":"start")").find("recording.folder"), std::string::npos);
}

TEST_F(WebRecordings, OnlyTheDriverChangesThem) {
  start();
  SocketPage driver(port()), other(port());
  EXPECT_EQ(ask(driver, "take"), "");
  EXPECT_NE(ask(other, "recording", R"(,"action":"start")"), "");
  EXPECT_NE(ask(other, "recording", R"(,"action":"delete","name":"a.mcap")"), "");
  EXPECT_FALSE(fake->is_on || fake->is_removed);
  EXPECT_EQ(ask(driver, "recording", R"(,"action":"start")"), "");
  EXPECT_TRUE(fake->is_on);
  for (;;) {  // the status tells everybody
    const std::optional<std::string> status = other.read_type("status");
    ASSERT_TRUE(status.has_value());
    if (Json::parse(*status)["recording"]["on"] == true) break;
  }
  EXPECT_EQ(ask(driver, "recording", R"(,"action":"delete","name":"b.mcap")"), "there is no recording of this name");
  EXPECT_EQ(ask(driver, "recording", R"(,"action":"delete","name":"a.mcap")"), "");
  EXPECT_TRUE(fake->is_removed);
}

TEST_F(WebRecordings, ADiskThatBlocksHoldsUpNothingElse) {
  fake->blocks = true;
  start();
  std::vector<std::unique_ptr<SocketClient>> waiting;
  for (int i = 0; i < 6; ++i) {
    waiting.push_back(std::make_unique<SocketClient>(port()));
    waiting.back()->send("GET /recordings HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
  }
  EXPECT_TRUE(eventually([&] { return fake->waiting == 1; }));
  EXPECT_TRUE(eventually([&] { return get(port(), "/recordings").status == 503; }));
  SocketPage page(port());
  EXPECT_EQ(ask(page, "stop"), "");
  EXPECT_TRUE(eventually([&] { return input().stop; }));
  waiting.pop_back();  // it does not wait any longer
  fake->disk.set_value();
  for (const auto& client : waiting) {
    EXPECT_NE(client->read_until("{\"recordings\":[]}").find("200"), std::string::npos);
  }
}

}  // namespace
}  // namespace touchline::console
