// Names of recordings count up, and the oldest ones are deleted first.
#include "firmware/recording/recording_files.h"

#include <unistd.h>

#include <filesystem>

#include "hal/recording/mcap_writer.h"

namespace touchline::testing {
namespace {

using namespace recording;

class RecordingFiles : public ::testing::Test {
 protected:
  RecordingFiles()
      : folder_(std::filesystem::temp_directory_path() / ("touchline-recordings-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~RecordingFiles() override { std::filesystem::remove_all(folder_); }
  void write(const std::string& name, std::size_t bytes) const {
    std::ofstream(folder_ / name) << std::string(bytes, 'x');
  }

  std::filesystem::path folder_;
};

TEST_F(RecordingFiles, TheFirstOneHasNumberOne) {
  EXPECT_TRUE(next_name(recordings_in(folder_.string())).starts_with("touchline-0001"));
  EXPECT_TRUE(next_name({}).ends_with(".mcap"));
}

TEST_F(RecordingFiles, NumbersGoOnWhateverTheDateSays) {
  write("touchline-0009-20300101-000000.mcap", 1);
  write("touchline-0010.mcap", 1);
  write("touchline-0008-20260101-000000.mcap", 1);
  // Not ours.
  write("touchline-0099.txt", 1);
  write("touchline-x.mcap", 1);
  write("touchline-.mcap", 1);
  write("touchline-0077x.mcap", 1);
  write("touchline-0077-final.mcap", 1);
  write("touchline-0077.old.mcap", 1);
  write("touchline-0077-20300101-0000000.mcap", 1);
  write("touchline-0077-20300101_000000.mcap", 1);
  write("touchline-0077-2030010a-000000.mcap", 1);
  write("touchline-077.mcap", 1);
  write("touchline-1234567890123456789.mcap", 1);
  write("touchline-0077.mcap.mcap", 1);
  write("game-0099.mcap", 1);
  const std::vector<RecordingFile> files = recordings_in(folder_.string());
  ASSERT_EQ(files.size(), 3U);
  EXPECT_EQ(files[0].number, 8U);
  EXPECT_EQ(files[2].name, "touchline-0010.mcap");
  EXPECT_TRUE(next_name(files).starts_with("touchline-0011"));
}

TEST_F(RecordingFiles, NumbersOfMoreThanFourDigitsComeLast) {
  write("touchline-10000.mcap", 1);
  write("touchline-9999.mcap", 1);
  EXPECT_TRUE(next_name(recordings_in(folder_.string())).starts_with("touchline-10001"));
}

TEST_F(RecordingFiles, TheQuotaDeletesTheOldestButNeverTheCurrentOne) {
  for (int i = 1; i <= 4; ++i) write("touchline-000" + std::to_string(i) + ".mcap", 100);
  write("other.mcap", 10'000);
  EXPECT_TRUE(keep_quota(folder_.string(), "touchline-0004.mcap", 400).deleted.empty());
  const QuotaRemovals removals = keep_quota(folder_.string(), "touchline-0001.mcap", 250);
  EXPECT_EQ(removals.deleted, (std::vector<std::string>{"touchline-0002.mcap", "touchline-0003.mcap"}));
  EXPECT_EQ(removals.failure, "");
  EXPECT_EQ(recordings_in(folder_.string()).size(), 2U);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "other.mcap"));
  EXPECT_EQ(keep_quota(folder_.string(), "touchline-0001.mcap", 0).deleted.size(), 1U);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "touchline-0001.mcap"));
}

TEST_F(RecordingFiles, TheQuotaSparesAFileThatIsBeingWritten) {
  hal::mcap::McapWriter writer;
  ASSERT_TRUE(writer.create((folder_ / "touchline-0001.mcap").string(), "test").ok());
  write("touchline-0002.mcap", 100);
  EXPECT_EQ(keep_quota(folder_.string(), "", 0).deleted, std::vector<std::string>{"touchline-0002.mcap"});
  EXPECT_TRUE(std::filesystem::exists(folder_ / "touchline-0001.mcap"));
  ASSERT_TRUE(writer.close().ok());
  EXPECT_EQ(keep_quota(folder_.string(), "", 0).deleted, std::vector<std::string>{"touchline-0001.mcap"});
}

TEST_F(RecordingFiles, ADiscardedFileIsGone) {
  hal::mcap::McapWriter writer;
  const std::filesystem::path path = folder_ / "touchline-0001.mcap";
  ASSERT_TRUE(writer.create(path.string(), "test").ok());
  ASSERT_TRUE(std::filesystem::exists(path));
  writer.discard();
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace touchline::testing
