// Messages that are found without reading what lies between them, in whole, cut and damaged files.
#include "hal/recording/mcap_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "tests/recording/example_recording.h"
#include "tests/recording/file_folder.h"

namespace touchline::testing {
namespace {

using hal::mcap::ChunkPlace;
using hal::mcap::McapIndex;

constexpr std::size_t kManyChunks = 1000;

class McapIndexTest : public FileFolder {
 protected:
  /// Compares what the index finds of each channel with the messages of the first chunks.
  static void expect_messages(const McapIndex& index, const std::vector<std::vector<WrittenMessage>>& written) {
    for (std::size_t i = 0; i < index.chunks().size(); ++i) {
      const ChunkPlace& chunk = index.chunks()[i];
      const Result<std::string> records = index.load(chunk);
      ASSERT_TRUE(records.ok()) << records.text();
      std::size_t found = 0;
      for (const std::string& topic : {written[0][0].topic, written[0][1].topic}) {
        const std::uint16_t channel = index.channel_of(topic);
        ASSERT_NE(channel, 0U) << topic;
        const auto places = index.messages(chunk, channel);
        ASSERT_TRUE(places.ok()) << places.text();
        auto next = written[i].begin();
        for (const auto& place : places.value()) {
          next = std::find_if(next, written[i].end(), [&](const auto& message) { return message.topic == topic; });
          ASSERT_NE(next, written[i].end());
          const auto data = index.find(records.value(), place, channel);
          ASSERT_TRUE(data.ok()) << data.text();
          EXPECT_EQ(std::string(reinterpret_cast<const char*>(data.value().data()), data.value().size()), next->data);
          EXPECT_EQ(place.time_ns, next->time_ns);
          const auto alone = index.read(chunk, place, channel);
          ASSERT_TRUE(alone.ok()) << alone.text();
          EXPECT_EQ(alone.value(), next->data);
          ++next;
          ++found;
        }
      }
      EXPECT_EQ(found, written[i].size());
    }
  }
};

TEST_F(McapIndexTest, FindsTheMessagesOfAWholeFile) {
  const auto written = write_example(path(), 5);
  McapIndex index;
  ASSERT_TRUE(index.open(path(), kManyChunks).ok());
  EXPECT_TRUE(index.is_complete());
  ASSERT_EQ(index.chunks().size(), 5U);
  EXPECT_EQ(index.channel_of("/nothing"), 0U);
  expect_messages(index, written);
}

TEST_F(McapIndexTest, FindsWhatACutFileHas) {
  const auto written = write_example(path(), 20);
  const std::string bytes = bytes_of(path());
  std::mt19937 random(4);
  std::size_t most = 0;
  for (int i = 0; i < 100; ++i) {
    write(path("cut.mcap"), bytes.substr(0, 1000 + random() % (bytes.size() - 1001)));
    McapIndex index;
    ASSERT_TRUE(index.open(path("cut.mcap"), kManyChunks).ok());
    EXPECT_FALSE(index.is_complete());
    most = std::max(most, index.chunks().size());
    // A chunk whose index is cut off has fewer messages; those before it have all.
    std::size_t whole = index.chunks().size();
    if (whole > 0 && index.chunks().back().indices.size() < 2) --whole;
    for (std::size_t chunk = 0; chunk < whole; ++chunk) {
      std::size_t found = 0;
      for (const auto& [channel, offset] : index.chunks()[chunk].indices) {
        const auto places = index.messages(index.chunks()[chunk], channel);
        ASSERT_TRUE(places.ok()) << places.text();
        found += places.value().size();
      }
      EXPECT_EQ(found, written[chunk].size());
    }
  }
  EXPECT_GT(most, 10U);
}

TEST_F(McapIndexTest, FindsDamage) {
  const auto written = write_example(path(), 5);
  const std::string bytes = bytes_of(path());
  McapIndex whole;
  ASSERT_TRUE(whole.open(path(), kManyChunks).ok());
  const ChunkPlace chunk = whole.chunks()[2];
  std::string damaged = bytes;
  damaged[static_cast<std::size_t>(chunk.offset + chunk.length) - 5] ^= 1;
  write(path("damaged.mcap"), damaged);
  McapIndex index;
  ASSERT_TRUE(index.open(path("damaged.mcap"), kManyChunks).ok());
  EXPECT_EQ(index.load(index.chunks()[2]).code(), ErrorCode::kCorruptFrame);
  EXPECT_TRUE(index.load(index.chunks()[3]).ok());
  // Any byte: an error or other data, but no crash and no endless loop.
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) {
    damaged = bytes;
    damaged[random() % damaged.size()] ^= static_cast<char>(1 + random() % 255);
    write(path("damaged.mcap"), damaged);
    McapIndex any;
    if (!any.open(path("damaged.mcap"), kManyChunks).ok()) continue;
    for (const ChunkPlace& place : any.chunks()) {
      static_cast<void>(any.load(place));
      for (const auto& [channel, offset] : place.indices) {
        const auto places = any.messages(place, channel);
        if (!places.ok()) continue;
        for (const auto& message : places.value()) static_cast<void>(any.read(place, message, channel));
      }
    }
  }
}

TEST_F(McapIndexTest, RefusesWhatIsNoRecording) {
  McapIndex missing, text, link, large;
  EXPECT_EQ(missing.open(path("missing.mcap"), kManyChunks).code(), ErrorCode::kNotFound);
  write(path("text.mcap"), "name,score\n");
  EXPECT_EQ(text.open(path("text.mcap"), kManyChunks).code(), ErrorCode::kCorruptFrame);
  static_cast<void>(write_example(path(), 5));
  std::filesystem::create_symlink(path(), path("link.mcap"));
  EXPECT_FALSE(link.open(path("link.mcap"), kManyChunks).ok());
  EXPECT_EQ(large.open(path(), 4).code(), ErrorCode::kFull);
}

}  // namespace
}  // namespace touchline::testing
