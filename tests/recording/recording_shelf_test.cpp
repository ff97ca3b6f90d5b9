// Recordings as the console shows them: what is in a file, whole or damaged, and no file outside the folder.
#include "firmware/recording/recording_shelf.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "firmware/recording/recording_writer.h"

namespace touchline::testing {
namespace {

using namespace recording;
using Json = nlohmann::json;

class RecordingShelfTest : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kWidth = 32, kHeight = 24;

  RecordingShelfTest()
      : folder_(std::filesystem::temp_directory_path() / ("touchline-shelf-" + std::to_string(::getpid()))),
        inside_(folder_ / "recordings") {
    std::filesystem::create_directories(inside_);
  }
  ~RecordingShelfTest() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const { return (inside_ / name).string(); }

  /// Begins a recording of a field without robots.
  void begin(RecordingWriter& writer, const std::string& name) {
    ASSERT_TRUE(writer.create(path(name), "test").ok());
    hal::CameraInfo camera;
    camera.width_px = kWidth;
    camera.height_px = kHeight;
    writer.begin_session(std::make_shared<const console::Scene>(
        console::scene_of(std::make_shared<config::Configuration>(), camera, "test")));
  }
  /// Adds a frame of one gray value; every second one has its picture.
  void add_frame(RecordingWriter& writer, std::uint64_t number, std::uint32_t halt) {
    const auto parts = std::make_unique<StepParts>();
    const auto snapshot = std::make_unique<Snapshot>();
    const Instant now{std::chrono::milliseconds(1000 + 20 * number)};
    parts->header.session = 1;
    parts->header.number = number;
    parts->header.width_px = kWidth;
    parts->header.height_px = kHeight;
    parts->inputs.now = now;
    snapshot->number = number;
    snapshot->captured = snapshot->sent = snapshot->machine_sent = now;
    snapshot->halt = halt;
    std::string pixels;
    if (number % 2 == 0) {
      parts->header.picture = PictureKind::kRaw;
      pixels.assign(std::size_t{kWidth} * kHeight * 3, static_cast<char>(100 + number));
    }
    std::string record(sizeof(StepParts) + sizeof(Snapshot), '\0');
    std::memcpy(record.data(), parts.get(), sizeof(StepParts));
    std::memcpy(record.data() + sizeof(StepParts), snapshot.get(), sizeof(Snapshot));
    record += pixels;
    ASSERT_TRUE(writer.add_step(hal::mcap::bytes_of(record)).ok());
    if (number % 5 == 4) {  // a chunk
      ASSERT_TRUE(writer.save().ok());
    }
  }
  /// Robots are stopped from frame 6 to frame 8.
  void write_recording(const std::string& name, std::uint64_t frames = 20) {
    RecordingWriter writer;
    begin(writer, name);
    for (std::uint64_t i = 0; i < frames; ++i) add_frame(writer, i, i >= 6 && i < 9 ? kHaltConsole : kHaltNone);
    ASSERT_TRUE(writer.close().ok());
  }

  struct ReadFrame {
    std::uint32_t number = 0, tenths_ms = 0;
    std::string state, picture;
  };
  static std::vector<ReadFrame> parse(const std::string& bytes) {
    std::vector<ReadFrame> frames;
    hal::mcap::RecordReader reader(hal::mcap::bytes_of(bytes));
    while (reader.ok() && !reader.rest().empty()) {
      ReadFrame frame;
      frame.number = reader.number<std::uint32_t>();
      frame.tenths_ms = reader.number<std::uint32_t>();
      const auto state = reader.number<std::uint32_t>(), picture = reader.number<std::uint32_t>();
      const auto text = [&](std::uint32_t size) {
        const auto part = reader.take(size);
        return std::string(reinterpret_cast<const char*>(part.data()), part.size());
      };
      frame.state = text(state);
      frame.picture = text(picture);
      frames.push_back(std::move(frame));
    }
    EXPECT_TRUE(reader.ok());
    return frames;
  }

  std::filesystem::path folder_, inside_;
};

TEST_F(RecordingShelfTest, ShowsFramesWithTheirPictures) {
  write_recording("touchline-0001.mcap");
  RecordingShelf shelf(inside_.string(), nullptr);
  const Result<std::string> description = shelf.describe("touchline-0001.mcap");
  ASSERT_TRUE(description.ok()) << description.text();
  const Json about = Json::parse(description.value());
  EXPECT_EQ(about["frames"], 20);
  EXPECT_EQ(about["complete"], true);
  EXPECT_NEAR(about["duration_s"].get<double>(), 0.38, 1e-6);
  ASSERT_EQ(about["scenes"].size(), 1U);
  EXPECT_EQ(about["scenes"][0]["hello"]["camera"]["width_px"], kWidth);
  std::vector<std::pair<std::string, int>> events;
  for (const Json& event : about["events"]) events.emplace_back(event["kind"], event["frame"]);
  EXPECT_EQ(events, (std::vector<std::pair<std::string, int>>{{"stop", 6}, {"start", 9}}));

  const Result<std::string> bytes = shelf.frames("touchline-0001.mcap", {3, 4, 5});
  ASSERT_TRUE(bytes.ok()) << bytes.text();
  const std::vector<ReadFrame> frames = parse(bytes.value());
  ASSERT_EQ(frames.size(), 4U) << "3, 8, 13 and 18";
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].number, 3 + 5 * i);
    EXPECT_EQ(frames[i].tenths_ms, 200 * frames[i].number);
    EXPECT_EQ(Json::parse(frames[i].state)["number"], frames[i].number);
    EXPECT_EQ(frames[i].picture.empty(), frames[i].number % 2 != 0);
    EXPECT_TRUE(frames[i].picture.empty() || frames[i].picture.starts_with("\xFF\xD8")) << "a JPEG";
  }
  EXPECT_EQ(parse(shelf.frames("touchline-0001.mcap", {18, 100, 1}).value()).size(), 2U);
  EXPECT_EQ(shelf.frames("touchline-0001.mcap", {20, 1, 1}).code(), ErrorCode::kOutOfRange);
}

TEST_F(RecordingShelfTest, ListsTheNewestFirst) {
  write_recording("touchline-0002-20261128-173005.mcap");
  write_recording("touchline-0010.mcap");
  write_recording("final.mcap", 10);
  std::ofstream(path("touchline-0003.mcap")) << "no recording";
  std::ofstream(path("notes.txt")) << "not listed";
  RecordingShelf shelf(inside_.string(), nullptr);
  for (int i = 0; i < 2; ++i) {  // the second time from memory
    const Json list = Json::parse(shelf.list().value())["recordings"];
    ASSERT_EQ(list.size(), 4U);
    EXPECT_EQ(list[0]["name"], "touchline-0010.mcap");
    EXPECT_EQ(list[0]["frames"], 20);
    EXPECT_EQ(list[0]["stops"], 1);
    EXPECT_EQ(list[0]["date"], "");
    EXPECT_EQ(list[1]["name"], "touchline-0003.mcap");
    EXPECT_NE(list[1]["problem"], "");
    EXPECT_EQ(list[2]["date"], "2026-11-28 17:30:05");
    EXPECT_EQ(list[3]["name"], "final.mcap");
    EXPECT_EQ(list[3]["frames"], 10);
  }
}

TEST_F(RecordingShelfTest, NeverLeavesTheFolder) {
  write_recording("touchline-0001.mcap");
  std::filesystem::copy(path("touchline-0001.mcap"), folder_ / "secret.mcap");
  std::filesystem::create_symlink(folder_ / "secret.mcap", path("link.mcap"));
  std::filesystem::create_directory(path("folder.mcap"));
  std::filesystem::copy(path("touchline-0001.mcap"), path("folder.mcap") + "/x.mcap");
  std::ofstream(path("token")) << "secret";
  RecordingShelf shelf(inside_.string(), nullptr);
  for (const std::string& name :
       {std::string("../secret.mcap"), (folder_ / "secret.mcap").string(), std::string("link.mcap"),
        std::string("folder.mcap"), std::string("folder.mcap/x.mcap"), std::string("./touchline-0001.mcap"),
        std::string("token"), std::string(".."), std::string(), std::string(".mcap"),
        std::string("touchline-0001.mcap\0/../../secret.mcap", 35)}) {
    EXPECT_EQ(shelf.describe(name).code(), ErrorCode::kNotFound) << name;
    EXPECT_EQ(shelf.frames(name, {}).code(), ErrorCode::kNotFound) << name;
    EXPECT_EQ(shelf.size(name).code(), ErrorCode::kNotFound) << name;
    EXPECT_EQ(shelf.read(name, 0, 10).code(), ErrorCode::kNotFound) << name;
    EXPECT_EQ(shelf.remove(name).code(), ErrorCode::kNotFound) << name;
  }
  EXPECT_TRUE(shelf.describe("touchline-0001.mcap").ok());
  EXPECT_TRUE(std::filesystem::exists(folder_ / "secret.mcap"));
  EXPECT_EQ(Json::parse(shelf.list().value())["recordings"].size(), 1U) << "neither link nor folder";
}

TEST_F(RecordingShelfTest, AGrowingFileIsShownAndNotDeleted) {
  RecordingShelf shelf(inside_.string(), nullptr);
  const std::string name = "touchline-0001.mcap";
  RecordingWriter writer;
  begin(writer, name);
  for (std::uint64_t i = 0; i < 5; ++i) add_frame(writer, i, kHaltNone);
  Json list = Json::parse(shelf.list().value())["recordings"];
  EXPECT_EQ(list[0]["growing"], true);
  EXPECT_EQ(list[0]["frames"], 5);
  EXPECT_EQ(Json::parse(shelf.describe(name).value())["frames"], 5);
  EXPECT_EQ(shelf.remove(name).code(), ErrorCode::kBusy);
  for (std::uint64_t i = 5; i < 10; ++i) add_frame(writer, i, kHaltNone);
  EXPECT_EQ(Json::parse(shelf.describe(name).value())["frames"], 10);
  ASSERT_TRUE(writer.close().ok());
  list = Json::parse(shelf.list().value())["recordings"];
  EXPECT_EQ(list[0]["growing"], false);
  EXPECT_EQ(list[0]["complete"], true);
  EXPECT_TRUE(shelf.remove(name).ok());
  EXPECT_FALSE(std::filesystem::exists(path(name)));
  EXPECT_EQ(shelf.frames(name, {}).code(), ErrorCode::kNotFound);
}

TEST_F(RecordingShelfTest, ADamagedPartDoesNotHideTheRest) {
  const std::string name = "touchline-0001.mcap";
  write_recording(name);
  hal::mcap::McapIndex index;
  ASSERT_TRUE(index.open(path(name), 100).ok());
  ASSERT_EQ(index.chunks().size(), 4U);
  const auto& chunk = index.chunks()[1];
  std::fstream file(path(name), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(chunk.offset + chunk.length / 2));
  file.put('\x55').put('\x55');
  file.close();
  RecordingShelf shelf(inside_.string(), nullptr);
  const std::vector<ReadFrame> frames = parse(shelf.frames(name, {0, 20, 1}).value());
  ASSERT_EQ(frames.size(), 20U);
  for (const ReadFrame& frame : frames) {
    EXPECT_EQ(frame.state.empty(), frame.number >= 5 && frame.number < 10) << frame.number;
  }
}

TEST_F(RecordingShelfTest, AFileIsReadInParts) {
  write_recording("touchline-0001.mcap");
  RecordingShelf shelf(inside_.string(), nullptr);
  const std::uint64_t size = shelf.size("touchline-0001.mcap").value();
  EXPECT_EQ(size, std::filesystem::file_size(path("touchline-0001.mcap")));
  EXPECT_EQ(shelf.read("touchline-0001.mcap", 0, 8).value(), hal::mcap::kMagic);
  EXPECT_EQ(shelf.read("touchline-0001.mcap", size - 8, 1000).value(), hal::mcap::kMagic);
  EXPECT_EQ(shelf.set_on(true, "").code(), ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace touchline::testing
