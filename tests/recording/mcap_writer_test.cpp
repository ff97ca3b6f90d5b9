// Recordings are read as they were written, also if they were cut off or damaged.
#include "hal/recording/mcap_writer.h"

#include <sys/resource.h>

#include <csignal>
#include <filesystem>

#include "tests/recording/example_recording.h"
#include "tests/recording/file_folder.h"

namespace touchline::testing {
namespace {

class McapWriter : public FileFolder {};

std::vector<WrittenMessage> joined(const std::vector<std::vector<WrittenMessage>>& chunks, std::size_t count) {
  std::vector<WrittenMessage> out;
  for (std::size_t i = 0; i < count; ++i) out.insert(out.end(), chunks[i].begin(), chunks[i].end());
  return out;
}

TEST_F(McapWriter, AFileIsReadAsItWasWritten) {
  const auto written = write_example(path(), 5);
  const ReadMessages read = read_all(path());
  EXPECT_TRUE(read.is_complete);
  EXPECT_EQ(read.rest, 0U);
  EXPECT_EQ(read.messages, joined(written, 5));
}

TEST_F(McapWriter, ACutFileIsReadUpToItsLastWholeChunk) {
  constexpr std::size_t kChunks = 20;
  const auto written = write_example(path(), kChunks);
  const std::string bytes = bytes_of(path());
  std::mt19937 random(3);
  std::size_t counts_seen = 0, last_count = kChunks + 1;
  for (int i = 0; i < 200; ++i) {
    const std::size_t size = 64 + random() % (bytes.size() - 64);
    write(path("cut.mcap"), bytes.substr(0, size));
    const ReadMessages read = read_all(path("cut.mcap"));
    const std::size_t chunks = read.messages.size() / written[0].size();
    EXPECT_EQ(read.messages, joined(written, chunks)) << "cut at " << size;
    // The summary after the last chunk has a fifth of the file.
    const double share = static_cast<double>(chunks) / kChunks;
    EXPECT_GE(share, static_cast<double>(size) / static_cast<double>(bytes.size()) - 0.1) << "cut at " << size;
    EXPECT_FALSE(read.is_damaged);
    counts_seen += chunks != last_count ? 1U : 0U;
    last_count = chunks;
  }
  EXPECT_GT(counts_seen, 50U) << "the cuts are at different chunks";
}

TEST_F(McapWriter, ADamagedChunkEndsTheFile) {
  const auto written = write_example(path(), 5);
  std::string bytes = bytes_of(path());
  const std::size_t third = bytes.find(written[2][3].data);
  ASSERT_NE(third, std::string::npos);
  bytes[third] = static_cast<char>(bytes[third] ^ 1);
  write(path("damaged.mcap"), bytes);
  const ReadMessages read = read_all(path("damaged.mcap"));
  EXPECT_TRUE(read.is_damaged);
  EXPECT_FALSE(read.is_complete);
  EXPECT_EQ(read.messages, joined(written, 2));
}

TEST_F(McapWriter, AFileThatExistsIsNotTouched) {
  write(path(), "precious");
  hal::mcap::McapWriter writer;
  EXPECT_EQ(writer.create(path(), "").code(), ErrorCode::kInconsistent);
  EXPECT_EQ(bytes_of(path()), "precious");
}

TEST_F(McapWriter, AnotherFileIsNoRecording) {
  write(path(), "version = 1\nname = \"board\"\n");
  hal::mcap::McapReader reader;
  const Result<void> opened = reader.open(path());
  EXPECT_EQ(opened.code(), ErrorCode::kCorruptFrame);
  EXPECT_NE(opened.text().find(path()), std::string::npos);
}

// A limit of the file's size stands for a full disk.
TEST_F(McapWriter, AFullDiskKeepsTheWholeChunks) {
  rlimit former{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &former), 0);
  const auto former_handler = std::signal(SIGXFSZ, SIG_IGN);
  hal::mcap::McapWriter writer;
  ASSERT_TRUE(writer.create(path(), "").ok());
  const std::uint16_t schema = writer.add_schema("a", "", "").value();
  const std::uint16_t channel = writer.add_channel(schema, "/a", "").value();
  const rlimit limit{100'000, former.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  const std::string data(30'000, 'x');
  Result<void> result;
  std::size_t chunks = 0;
  for (; result.ok() && chunks < 10; ++chunks) {
    writer.add({channel, 0, 1, {}}, {hal::mcap::bytes_of(data)});
    result = writer.flush();
  }
  EXPECT_EQ(result.code(), ErrorCode::kFull);
  EXPECT_TRUE(writer.close().ok()) << "the summary fits";
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &former), 0);
  std::signal(SIGXFSZ, former_handler);
  const ReadMessages read = read_all(path());
  EXPECT_TRUE(read.is_complete);
  EXPECT_EQ(read.messages.size(), chunks - 1);
  EXPECT_EQ(read.messages.size(), 3U);
}

}  // namespace
}  // namespace touchline::testing
