#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <future>
#include <nlohmann/json.hpp>

#include "firmware/console/file_thread.h"
#include "tests/console/server_fixture.h"

// If a disk blocks, the console's thread continues, and passes on every stop.
namespace touchline::console {
namespace {

class WebDisk : public ConsoleServer {
 protected:
  ~WebDisk() override {
    disk_answers.set_value();
    end();
    std::filesystem::remove_all(folder);
  }
  static bool ask(SocketPage& page, std::string_view type) {
    page.send_text(text_of(type, R"("request":7)"));
    for (;;) {
      const std::optional<std::string> answer = page.read_type("answer");
      if (!answer) return false;
      const nlohmann::json json = nlohmann::json::parse(*answer);
      if (json["to"] == 7) return json["ok"];
    }
  }

  // Files are not loaded before disk_answers.
  void block_the_disk() {
    use_files = [this, answered = disk](const config::FilePaths& /*files*/) -> Result<FilesUse> {
      is_blocked = true;
      answered.wait();
      return FilesUse::kAtOnce;
    };
  }

  std::atomic<bool> is_blocked{false};
  std::promise<void> disk_answers;
  std::shared_future<void> disk = disk_answers.get_future().share();
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("disk-" + std::to_string(::getpid()));
};

TEST_F(WebDisk, AStopIsAnsweredWhileFilesAreBeingLoaded) {
  block_the_disk();
  start();
  begin_session_later(true, true);  // a draft is in use
  SocketPage driver(port()), other(port());
  EXPECT_TRUE(ask(driver, "take"));
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kStand; }));
  driver.send_text(text_of("use_saved"));
  EXPECT_TRUE(eventually([&] { return is_blocked.load(); }));
  EXPECT_TRUE(ask(other, "stop"));
  EXPECT_TRUE(eventually([&] { return input().stop; }));
  SocketPage late(port());
  EXPECT_TRUE(late.read_type("state").has_value()) << "a new page, too";
  EXPECT_EQ(get(port(), "/metrics").status, 200);
}

TEST_F(WebDisk, ADriverThatLeavesStopsRobotsWhileTheDiskBlocks) {
  block_the_disk();
  start();
  begin_session_later(true, true);
  auto driver = std::make_unique<SocketPage>(port());
  EXPECT_TRUE(ask(*driver, "take"));
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kStand; }));
  driver->send_text(text_of("use_saved"));
  EXPECT_TRUE(eventually([&] { return is_blocked.load(); }));
  EXPECT_FALSE(input().stop);
  driver.reset();
  EXPECT_TRUE(eventually([&] { return input().stop; }));
}

TEST_F(WebDisk, APageFileIsReadAtTheStartAndNotForARequest) {
  std::filesystem::create_directories(folder / "assets");
  std::ofstream(folder / "index.html") << "page";
  const std::string code(300000, 'c');
  std::ofstream(folder / "assets/main.js") << code;
  settings.page_folder = folder.string();
  start();
  // Opening this file would block forever.
  std::filesystem::remove(folder / "assets/main.js");
  ASSERT_EQ(::mkfifo((folder / "assets/main.js").c_str(), 0600), 0);
  const HttpAnswer answer = get(port(), "/assets/main.js");
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, code);
  EXPECT_NE(answer.head.find("immutable"), std::string::npos) << answer.head;
  EXPECT_EQ(get(port(), "/").body, "page");
  SocketPage page(port());
  EXPECT_TRUE(ask(page, "stop"));
}

TEST_F(WebDisk, APageThatIsBuiltLaterIsFound) {
  std::filesystem::create_directories(folder);
  settings.page_folder = folder.string();
  start();
  EXPECT_NE(get(port(), "/").body.find("The page is not built"), std::string::npos);
  std::ofstream(folder / "index.html") << "page";
  EXPECT_TRUE(eventually([&] { return get(port(), "/").body == "page"; }));
}

TEST_F(WebDisk, AJobThatIsBlockedDoesNotHoldUpTheEnd) {
  std::promise<void> has_begun;
  std::atomic<bool> is_finished{false};
  {
    FileThread thread;
    thread.run([disk = disk, &has_begun, &is_finished]() -> FileThread::Finish {
      has_begun.set_value();
      disk.wait();
      return [&is_finished] { is_finished = true; };
    });
    has_begun.get_future().wait();
    thread.finish();
  }
  EXPECT_FALSE(is_finished);
}

TEST_F(WebDisk, ResultsComeToTheThreadThatAsksForThem) {
  FileThread thread;
  std::vector<int> results;
  for (int i = 0; i < 3; ++i) {
    thread.run([&results, i]() -> FileThread::Finish {
      const std::thread::id worker = std::this_thread::get_id();
      return [&results, i, worker] {
        EXPECT_NE(std::this_thread::get_id(), worker);
        results.push_back(i);
      };
    });
  }
  EXPECT_TRUE(eventually([&] {
    thread.finish();
    return results.size() == 3;
  }));
  EXPECT_EQ(results, (std::vector<int>{0, 1, 2}));
}

}  // namespace
}  // namespace touchline::console
