#include <gtest/gtest.h>
#include <zlib.h>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "hal/replay/picture.h"
#include "tests/console/server_fixture.h"

namespace touchline::console {
namespace {

std::string uncompressed(const std::string& gzip) {
  z_stream stream{};
  if (inflateInit2(&stream, 15 + 16) != Z_OK) return {};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(gzip.data()));
  stream.avail_in = static_cast<uInt>(gzip.size());
  std::string bytes;
  int result = Z_OK;
  while (result == Z_OK) {
    std::string part(std::size_t{1} << 16, '\0');
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = static_cast<uInt>(part.size());
    result = inflate(&stream, Z_NO_FLUSH);
    bytes.append(part, 0, part.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  return result == Z_STREAM_END && stream.avail_in == 0 ? bytes : std::string();
}

// Returns the contents by name, without the folder, which all share.
std::map<std::string, std::string> files_of(const std::string& archive) {
  constexpr std::size_t kBlock = 512;
  std::map<std::string, std::string> files;
  const std::string bytes = uncompressed(archive);
  EXPECT_EQ(bytes.size() % kBlock, 0U);
  std::string folder;
  for (std::size_t at = 0; at + kBlock <= bytes.size() && bytes[at] != '\0';) {
    EXPECT_EQ(bytes.substr(at + 257, 5), "ustar");
    unsigned sum = 0;
    for (std::size_t i = 0; i < kBlock; ++i) {
      sum += i >= 148 && i < 156 ? unsigned{' '} : static_cast<unsigned char>(bytes[at + i]);
    }
    EXPECT_EQ(std::stoul(bytes.substr(at + 148, 8), nullptr, 8), sum);
    const std::string name = bytes.c_str() + at;
    const std::size_t size = std::stoul(bytes.substr(at + 124, 11), nullptr, 8);
    if (folder.empty()) folder = name.substr(0, name.find('/') + 1);
    EXPECT_TRUE(name.starts_with(folder)) << name;
    files[name.substr(folder.size())] = bytes.substr(at + kBlock, size);
    at += kBlock + (size + kBlock - 1) / kBlock * kBlock;
  }
  return files;
}

std::vector<nlohmann::json> lines_of(const std::string& text) {
  std::vector<nlohmann::json> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(nlohmann::json::parse(line));
  return lines;
}

std::string text_of_file(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

class WebBugReport : public ConsoleServer {
 protected:
  const std::filesystem::path board_ = std::filesystem::path(TOUCHLINE_SOURCE_DIR) / "boards/mock";
  const std::filesystem::file_time_type files_before_ = std::filesystem::last_write_time(board_);
};

TEST_F(WebBugReport, ContainsPictureFilesVersionsAndResults) {
  start();
  ASSERT_TRUE(eventually([&] { return frames > 50; }));
  const HttpAnswer answer = get(port(), "/bug-report");
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_NE(answer.head.find("content-disposition: attachment; filename=\"touchline-bug-report-2"), std::string::npos)
      << answer.head;
  EXPECT_NE(answer.head.find("content-type: application/gzip"), std::string::npos) << answer.head;
  std::map<std::string, std::string> files = files_of(answer.body);
  EXPECT_EQ(files["README.txt"].find("Missing"), std::string::npos) << files["README.txt"];

  const std::vector<nlohmann::json> results = lines_of(files["results.jsonl"]);
  ASSERT_GT(results.size(), 50U);
  for (std::size_t i = 1; i < results.size(); ++i)
    EXPECT_EQ(results[i]["number"], results[i - 1]["number"].get<int>() + 1);
  EXPECT_EQ(results.back()["type"], "state");
  EXPECT_GT(nlohmann::json::parse(files["status.json"])["latency"]["start"]["count"], 50);
  EXPECT_EQ(nlohmann::json::parse(files["hello.json"])["type"], "hello");
  EXPECT_NE(files["versions.txt"].find("touchline: 1.2.3\n"), std::string::npos) << files["versions.txt"];
  for (const char* const what : {"\nkernel: Linux ", "\nlibwebsockets: ", "\nprocessor: ", "\nFFmpeg: "}) {
    EXPECT_NE(files["versions.txt"].find(what), std::string::npos) << what << files["versions.txt"];
  }
  EXPECT_NE(files["configuration.toml"].find("picture_rate_hz"), std::string::npos);
  for (const char* const name : {"board.toml", "venue.toml", "team.toml"}) {
    EXPECT_EQ(files["files/" + std::string(name)], text_of_file(board_ / name)) << name;
  }

  const std::filesystem::path picture = std::filesystem::path(::testing::TempDir()) / "bug-report-picture.png";
  std::ofstream(picture) << files["picture.png"];
  const Result<hal::Picture> read = hal::read_picture(picture.string());
  std::filesystem::remove(picture);
  ASSERT_TRUE(read.ok()) << read.text();
  EXPECT_EQ(read.value().width_px, 320U);
  ASSERT_GT(read.value().rgb8.size(), 5000U);
  // The pixels are as the fixture's camera delivers them, because the file is lossless.
  for (std::size_t i = 0; i < 5000; ++i) ASSERT_EQ(read.value().rgb8[i], static_cast<std::uint8_t>(i / 7));
}

TEST_F(WebBugReport, HasTheLastTenSecondsAndNoMore) {
  start();
  // The fixture's camera has a hundred frames a second at most.
  ASSERT_TRUE(eventually([&] { return frames > 1100; }));
  const std::vector<nlohmann::json> results = lines_of(files_of(get(port(), "/bug-report").body)["results.jsonl"]);
  ASSERT_FALSE(results.empty());
  const double time_s = results.back()["sent_s"].get<double>() - results.front()["sent_s"].get<double>();
  EXPECT_LE(time_s, 10.0);
  EXPECT_GT(time_s, 9.0);
}

TEST_F(WebBugReport, ContainsNoSecretAndChangesNoFile) {
  settings.access.token = std::string(32, '7') + std::string(32, 'e');
  reports.events.add("info", "opened /login?token=" + settings.access.token);
  start();
  ASSERT_TRUE(eventually([&] { return frames > 5; }));
  std::map<std::string, std::string> files = files_of(get(port(), "/bug-report").body);
  EXPECT_NE(files["events.jsonl"].find("opened /login?token=(removed)"), std::string::npos) << files["events.jsonl"];
  for (const auto& [name, text] : files) EXPECT_EQ(text.find(settings.access.token), std::string::npos) << name;
  EXPECT_EQ(std::filesystem::last_write_time(board_), files_before_) << "a file was made beside the board's";
}

TEST_F(WebBugReport, IsRefusedAsEverythingElseIs) {
  settings.access.token = std::string(64, 'a');
  start();
  EXPECT_EQ(get(port(), "/bug-report", "Host: evil.example\r\n").status, 403);
  EXPECT_EQ(get(port(), "/bug-report", "Origin: http://evil.example\r\n").status, 403);
  EXPECT_EQ(get(port(), "/bug-report", "Sec-Fetch-Site: cross-site\r\n").status, 403);
  EXPECT_EQ(get(port(), "/bug-report", "Content-Length: 0\r\n", "POST").status, 405);
  const HttpAnswer head = get(port(), "/bug-report", "", "HEAD");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.body, "");
}

TEST_F(WebBugReport, OneIsMadeAtATimeAndAnAbandonedOneBlocksNobody) {
  start();
  ASSERT_TRUE(eventually([&] { return frames > 5; }));
  HttpAnswer second;
  // A busy machine may have made the first report before the second report is requested.
  EXPECT_TRUE(eventually([&] {
    const SocketClient first(port());
    first.send("GET /bug-report HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
    second = get(port(), "/bug-report");
    return second.status == 503;
  }));
  EXPECT_NE(second.body.find("Another bug report"), std::string::npos);
  EXPECT_TRUE(eventually([&] { return get(port(), "/bug-report").status == 200; }));
}

TEST_F(WebBugReport, WithoutCameraItSaysWhatIsMissing) {
  camera_delivers = false;
  start();
  std::map<std::string, std::string> files = files_of(get(port(), "/bug-report").body);
  EXPECT_EQ(files.count("picture.png"), 0U);
  EXPECT_EQ(files["results.jsonl"], "");
  EXPECT_NE(files["README.txt"].find("Missing: picture.png: the camera delivered none."), std::string::npos);
  EXPECT_NE(files["files/board.toml"], "");
}

}  // namespace
}  // namespace touchline::console
