// Game logs of the Small Size League: the bytes of the published format, packed files, and files that were cut off.
#include "hal/recording/ssl_log.h"

#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "tests/results.h"

namespace touchline::testing {
namespace {

struct LogMessage {
  std::int64_t time_ns = 0;
  std::int32_t type = 0;
  std::string data;

  friend bool operator==(const LogMessage&, const LogMessage&) = default;
};

class SslLog : public ::testing::Test {
 protected:
  SslLog() : folder_(std::filesystem::temp_directory_path() / ("touchline-ssl-log-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~SslLog() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static std::string bytes_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  static void write_bytes(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
  }
  static void write(const std::string& path, const std::vector<LogMessage>& messages) {
    hal::SslLogWriter writer;
    ASSERT_OK(writer.open(path));
    for (const LogMessage& message : messages) {
      ASSERT_OK(writer.add({message.time_ns, message.type, std::as_bytes(std::span(message.data))}));
    }
    ASSERT_OK(writer.commit());
  }
  struct ReadLog {
    std::vector<LogMessage> messages;
    Result<void> result;
    bool is_complete = false;
    std::uint64_t position = 0;
  };
  static ReadLog read(const std::string& path) {
    ReadLog out;
    hal::SslLogReader reader;
    out.result = reader.open(path);
    while (out.result.ok()) {
      const Result<std::optional<hal::SslLogMessage>> next = reader.next();
      if (!next.ok()) {
        out.result = next.error();
        break;
      }
      if (!next.value()) break;
      const hal::SslLogMessage& message = *next.value();
      out.messages.push_back(
          {message.time_ns, message.type, {reinterpret_cast<const char*>(message.data.data()), message.data.size()}});
    }
    out.is_complete = reader.is_complete();
    out.position = reader.position();
    return out;
  }
  static std::vector<LogMessage> example(std::size_t count) {
    std::vector<LogMessage> messages;
    std::mt19937 random(1);
    for (std::size_t i = 0; i < count; ++i) {
      LogMessage message{1'800'000'000'000'000'000 + static_cast<std::int64_t>(i) * 16'666'667,
                         static_cast<std::int32_t>(random() % 7), std::string(random() % 400, 'a')};
      for (char& c : message.data) c = static_cast<char>(random());
      messages.push_back(message);
    }
    return messages;
  }

  std::filesystem::path folder_;
};

// The bytes follow from RoboCup-SSL/ssl-go-tools, pkg/persistence/writer.go: they were not made by our writer.
TEST_F(SslLog, HasTheBytesOfThePublishedFormat) {
  const std::string expected(
      "SSL_LOG_FILE\0\0\0\1"
      "\x11\x22\x33\x44\x55\x66\x77\x01\0\0\0\4\0\0\0\3abc"
      "\0\0\0\0\0\0\0\0\0\0\0\6\0\0\0\0",
      16 + 16 + 3 + 16);
  write(path("a.log"), {{0x1122334455667701, hal::kSslVision, "abc"}, {0, hal::kSslIndex, ""}});
  EXPECT_EQ(bytes_of(path("a.log")), expected);
  const ReadLog read_back = read(path("a.log"));
  EXPECT_OK(read_back.result);
  EXPECT_TRUE(read_back.is_complete);
  ASSERT_EQ(read_back.messages.size(), 2U);
  EXPECT_EQ(read_back.messages[0], (LogMessage{0x1122334455667701, 4, "abc"}));
}

TEST_F(SslLog, APackedFileIsAGzipFileWithTheSameContent) {
  const std::vector<LogMessage> messages = example(500);
  write(path("a.log"), messages);
  write(path("a.log.gz"), messages);
  EXPECT_EQ(read(path("a.log.gz")).messages, messages);
  EXPECT_TRUE(read(path("a.log.gz")).is_complete);
  ASSERT_EQ(std::system(("gzip -dc " + path("a.log.gz") + " | cmp - " + path("a.log")).c_str()), 0);
  EXPECT_TRUE(hal::is_ssl_log(bytes_of(path("a.log.gz")).substr(0, 12)));
  EXPECT_TRUE(hal::is_ssl_log(bytes_of(path("a.log")).substr(0, 12)));
  EXPECT_FALSE(hal::is_ssl_log("SSL_LOG_FIL"));
}

TEST_F(SslLog, ACutFileIsReadUpToItsLastWholeMessage) {
  const std::vector<LogMessage> messages = example(100);
  write(path("a.log"), messages);
  write(path("a.log.gz"), messages);
  std::mt19937 random(3);
  for (const std::string name : {"a.log", "a.log.gz"}) {
    const std::string bytes = bytes_of(path(name));
    std::size_t counts_seen = 0, last_count = messages.size() + 1;
    for (int i = 0; i < 200; ++i) {
      const std::size_t size = 100 + random() % (bytes.size() - 101);
      write_bytes(path("cut-" + name), bytes.substr(0, size));
      const ReadLog cut = read(path("cut-" + name));
      // A packed file begins with a block of some kilobytes, without which its header cannot be read.
      if (!cut.result.ok()) {
        EXPECT_EQ(name, "a.log.gz");
        EXPECT_NE(cut.result.text().find(path("cut-" + name) + ": byte 0: "), std::string::npos) << cut.result.text();
        continue;
      }
      ASSERT_LE(cut.messages.size(), messages.size());
      EXPECT_EQ(cut.messages,
                std::vector<LogMessage>(messages.begin(), messages.begin() + static_cast<long>(cut.messages.size())));
      std::uint64_t position = 16;
      for (const LogMessage& message : cut.messages) position += 16 + message.data.size();
      EXPECT_EQ(cut.position, position);
      EXPECT_EQ(cut.is_complete, name == "a.log" && position == size);
      counts_seen += cut.messages.size() != last_count ? 1U : 0U;
      last_count = cut.messages.size();
    }
    EXPECT_GT(counts_seen, name == "a.log" ? 50U : 10U) << name << ": the cuts are at different messages";
  }
}

TEST_F(SslLog, DamageIsReportedWithItsByte) {
  const auto check = [&](const std::string& bytes, ErrorCode code, const std::string& text) {
    write_bytes(path("bad.log"), bytes);
    const ReadLog bad = read(path("bad.log"));
    EXPECT_EQ(bad.result.code(), code);
    EXPECT_EQ(bad.result.text(), path("bad.log") + ": " + text);
  };
  const std::string header("SSL_LOG_FILE\0\0\0\1", 16), good("\0\0\0\0\0\0\0\1\0\0\0\4\0\0\0\2xy", 18);
  const std::string type("\0\0\0\0\0\0\0\1\0\0\0\4", 12);
  check(header + good + type + std::string("\xff\xff\xff\xfb", 4), ErrorCode::kCorruptFrame,
        "byte 34: a message of -5 bytes; the file is damaged");
  check(header + type + std::string("\x7f\xff\xff\xff", 4), ErrorCode::kCorruptFrame,
        "byte 16: a message of 2147483647 bytes; the file is damaged");
  check(std::string("SSL_LOG_FILE\0\0\0\2", 16), ErrorCode::kUnsupported,
        "byte 0: the game log has version 2 instead of 1");
  check("SSL_LOG_FIL", ErrorCode::kCorruptFrame, "byte 0: is not a game log (SSL_LOG_FILE)");
  check("", ErrorCode::kCorruptFrame, "byte 0: is not a game log (SSL_LOG_FILE)");

  write(path("a.log.gz"), example(100));
  std::string packed = bytes_of(path("a.log.gz"));
  packed[packed.size() - 6] = static_cast<char>(packed[packed.size() - 6] ^ 1);  // of the checksum
  write_bytes(path("bad.log.gz"), packed);
  EXPECT_EQ(read(path("bad.log.gz")).result.code(), ErrorCode::kCorruptFrame);
  EXPECT_EQ(read(folder_.string()).result.code(), ErrorCode::kUnsupported);
  EXPECT_EQ(read(path("missing.log")).result.code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace touchline::testing
