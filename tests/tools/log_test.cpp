// touchline-log on game logs and on files of any content; tests/recording/recorded_games has its work on recordings.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "hal/recording/mcap_writer.h"
#include "hal/recording/ssl_log.h"
#include "tests/results.h"
#include "tools/programs/log/convert.h"
#include "tools/programs/log/cut.h"
#include "tools/programs/log/join.h"
#include "tools/programs/log/listing.h"

namespace touchline::log {
namespace {

constexpr std::int64_t kBegin_ns = 1'800'000'000'000'000'000, kPeriod_ns = 10'000'000;

class LogTool : public ::testing::Test {
 protected:
  LogTool() : folder_(std::filesystem::temp_directory_path() / ("touchline-log-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~LogTool() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::string bytes_of(const std::string& name) const {
    std::ifstream file(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void write_bytes(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
  }

  /// A log with messages of all types, some of them unknown, and an index, as ssl-go-tools write it. Their bytes are
  /// random, so that no packet can be read.
  void write_log(const std::string& name, int count) const {
    hal::SslLogWriter writer;
    ASSERT_OK(writer.open(path(name)));
    std::mt19937 random(7);
    const auto add = [&](std::int64_t time_ns, std::int32_t type, std::size_t bytes) {
      std::string data(bytes, '\0');
      for (char& c : data) c = static_cast<char>(random());
      ASSERT_OK(writer.add({time_ns, type, std::as_bytes(std::span(data))}));
    };
    for (int i = 0; i < count; ++i) {
      add(kBegin_ns + i * kPeriod_ns, static_cast<std::int32_t>(random() % 6), random() % 300);
    }
    add(kBegin_ns, 1234, 5);
    add(-1, -7, 5);
    add(5, hal::kSslIndex, 8);
    add(0, hal::kSslIndex, 800);
    ASSERT_OK(writer.commit());
  }

  std::filesystem::path folder_;
};

TEST_F(LogTool, AGameLogBecomesMcapAndBackByteForByte) {
  write_log("a.log", 3000);
  ASSERT_OK(convert(path("a.log"), path("a.mcap")));
  ASSERT_OK_AND_ASSIGN(const Conversion back, convert(path("a.mcap"), path("back.log")));
  EXPECT_EQ(back.written, 3004U);
  EXPECT_EQ(bytes_of("back.log"), bytes_of("a.log"));
  // Packed, and through a packed file.
  ASSERT_OK(convert(path("a.log"), path("a.log.gz")));
  EXPECT_LT(bytes_of("a.log.gz").size(), bytes_of("a.log").size());
  ASSERT_OK(convert(path("a.log.gz"), path("b.mcap")));
  ASSERT_OK(convert(path("b.mcap"), path("back.log")));
  EXPECT_EQ(bytes_of("back.log"), bytes_of("a.log"));
  // An empty log, too.
  write_bytes("empty.log", bytes_of("a.log").substr(0, 16));
  ASSERT_OK(convert(path("empty.log"), path("empty.log.gz")));
  ASSERT_OK(convert(path("empty.log.gz"), path("empty2.log")));
  EXPECT_EQ(bytes_of("empty2.log"), bytes_of("empty.log"));
}

TEST_F(LogTool, TypesHaveTopicsThatTellThem) {
  for (const std::int32_t type : {0, 1, 2, 3, 4, 5, 6, 7, -1, 2147483647}) {
    EXPECT_EQ(type_of(topic_of(type, 0)), type);
    EXPECT_EQ(type_of(topic_of(type, 1)), type);
  }
  EXPECT_NE(topic_of(6, 0), topic_of(6, 1)) << "only an index without a time gets none back";
  EXPECT_FALSE(type_of("/ssl/type/"));
  EXPECT_FALSE(type_of("/ssl/type/12x"));
  EXPECT_FALSE(type_of("/touchline/steps"));
}

TEST_F(LogTool, CutAndJoinedGameLogsHaveTheirMessages) {
  write_log("a.log", 1000);
  EXPECT_EQ(cut(path("a.log"), {0.0, 4.995}, path("1.log")).text(), "");
  EXPECT_EQ(cut(path("a.log"), {4.995, 100.0}, path("2.log")).text(), "");
  EXPECT_OK(join({path("1.log"), path("2.log")}, path("both.log.gz")));
  ASSERT_OK_AND_ASSIGN(const Conversion parts, convert(path("1.log"), path("1.mcap")));
  // The first 500 messages and the one of type 1234, which has the first one's time.
  EXPECT_EQ(parts.written, 501U);
  ASSERT_OK_AND_ASSIGN(const std::string text, list(path("both.log.gz")));
  EXPECT_NE(text.find("9.990 s, 1001 messages"), std::string::npos) << text;
  EXPECT_EQ(text.find("/ssl/index"), std::string::npos) << text;
  EXPECT_EQ(cut(path("a.log"), {50.0, 60.0}, path("3.log")).text(),
            path("a.log") + ": nothing was recorded from 50 to 60 s; see touchline-log list");
  EXPECT_FALSE(std::filesystem::exists(path("3.log")));
}

TEST_F(LogTool, RefusesWhatItCannotDo) {
  write_log("a.log", 10);
  EXPECT_EQ(convert(path("a.log"), path("a.log")).text(), path("a.log") + ": would replace the input");
  EXPECT_EQ(convert(path("a.log"), path("a.txt")).text(),
            path("a.txt") + ": the name has to end in .mcap, .log, .log.gz or .csv");
  EXPECT_EQ(cut(path("a.log"), {0.0, 1.0}, path("a.mcap")).code(), ErrorCode::kUnsupported);
  ASSERT_OK(convert(path("a.log"), path("a.mcap")));
  EXPECT_EQ(convert(path("a.log"), path("a.mcap")).code(), ErrorCode::kInconsistent) << "a file is not replaced";
  EXPECT_EQ(join({path("a.log"), path("a.mcap")}, path("b.log")).code(), ErrorCode::kUnsupported);
  EXPECT_EQ(convert(path("a.mcap"), path("a.csv")).code(), ErrorCode::kUnsupported);
  EXPECT_EQ(list(path("missing.log")).text(), path("missing.log") + ": no such file");
  EXPECT_EQ(list(folder_.string()).text(), folder_.string() + ": is not a file");
  write_bytes("text.log", "no log");
  EXPECT_EQ(list(path("text.log")).text(),
            path("text.log") + ": byte 0: neither a recording (MCAP) nor a game log (SSL_LOG_FILE)");
}

TEST_F(LogTool, FilesThatAreCutOffAnywhereAreReadAndNamed) {
  write_log("a.log", 2000);
  ASSERT_OK(convert(path("a.log"), path("a.mcap")));
  std::mt19937 random(5);
  const std::string log = bytes_of("a.log"), mcap = bytes_of("a.mcap");
  for (int i = 0; i < 100; ++i) {
    write_bytes("cut.log", log.substr(0, 17 + random() % (log.size() - 18)));
    ASSERT_OK_AND_ASSIGN(const std::string text, list(path("cut.log")));
    ASSERT_OK_AND_ASSIGN(const Conversion done, convert(path("cut.log"), path("cut.csv")));
    EXPECT_EQ(done.notes.empty() || done.notes[0].find("packets") != std::string::npos,
              text.find(", complete\n") != std::string::npos)
        << text;
    write_bytes("cut.mcap", mcap.substr(0, 17 + random() % (mcap.size() - 18)));
    ASSERT_OK_AND_ASSIGN(const std::string cut_text, list(path("cut.mcap")));
    // Behind the end of the data, only the index is missing.
    const bool has_data = cut_text.find(", complete\n") != std::string::npos;
    EXPECT_NE(has_data, cut_text.find("cut off at byte ") != std::string::npos) << cut_text;
  }
}

TEST_F(LogTool, AStepThatCannotBeReadIsNamedWithItsByte) {
  hal::mcap::McapWriter writer;
  ASSERT_OK(writer.create(path("bad.mcap"), "test"));
  ASSERT_OK_AND_ASSIGN(const std::uint16_t channel, writer.add_channel(0, "/touchline/steps", "touchline"));
  const std::uint64_t chunk = writer.size();
  writer.add({channel, 1, 1, {}}, {hal::mcap::bytes_of("\1garbage")});
  ASSERT_OK(writer.close());
  const std::string expected =
      path("bad.mcap") + ": byte " + std::to_string(chunk) + ": the message of a step cannot be read";
  EXPECT_EQ(list(path("bad.mcap")).text(), expected);
  EXPECT_EQ(convert(path("bad.mcap"), path("bad.csv")).text(), expected);
  EXPECT_EQ(cut(path("bad.mcap"), {0.0, 1.0}, path("out.mcap")).text(), expected);
  EXPECT_EQ(join({path("bad.mcap")}, path("out.mcap")).text(), expected);
  EXPECT_FALSE(std::filesystem::exists(path("out.mcap"))) << "a file that was not finished is removed";
  EXPECT_FALSE(std::filesystem::exists(path("bad.csv")));
}

}  // namespace
}  // namespace touchline::log
