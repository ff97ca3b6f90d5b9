// A recording with the JPEG files of a camera is replayed from them; without some of them, from the recorded sightings.
#include <unistd.h>

#include <filesystem>

#include "firmware/console/jpeg_encoder.h"
#include "firmware/recording/recording_writer.h"
#include "hal/mock/mock_devices.h"
#include "tools/programs/replay/recording_source.h"

namespace touchline::testing {
namespace {

using namespace recording;

/// Plays frames of the arena that were compressed by a camera, and records them.
class JpegRecording : public ::testing::Test {
 protected:
  static constexpr int kFrames = 25;

  JpegRecording() : path_((std::filesystem::temp_directory_path() / ("jpeg-" + std::to_string(::getpid()) + ".mcap"))) {
    const std::string folder = TOUCHLINE_MOCK_FOLDER;
    const Result<void> loaded = config::load(
        {folder + "/board.toml", folder + "/venue-mjpg.toml", folder + "/team.toml", {"camera.format=mjpg"}},
        *configuration_);
    EXPECT_TRUE(loaded.ok()) << loaded.text();
    EXPECT_TRUE(writer_.create(path_.string(), "test").ok());
  }
  ~JpegRecording() override { std::filesystem::remove(path_); }

  /// Records sessions with every `every`-th picture. `lost`: number of a step that the recorder does not get in the
  /// first session.
  void record(std::uint32_t every, int lost = -1, std::uint32_t sessions = 1) {
    ByteRing ring(std::size_t{16} << 20);
    StepTap tap(ring, every);
    for (std::uint32_t session = 1; session <= sessions; ++session) {
      ConfigurationText text = text_of(*configuration_);
      text.session = session;
      EXPECT_FALSE(text.light_reference.empty()) << "the example has pictures beside its venue file";
      ASSERT_TRUE(writer_.add(text).ok());
      ASSERT_TRUE(pipeline_->configure(configuration_->pipeline).ok());
      tap.begin_session(false);
      record_session(ring, tap, session == 1 ? lost : -1);
    }
    ASSERT_TRUE(writer_.close().ok());
    EXPECT_GT(robots_, 50U) << "the pictures show robots";
  }

  void record_session(ByteRing& ring, StepTap& tap, int lost) {
    const config::BoardFile& board = configuration_->board;
    const auto arena = std::make_unique<hal::mock::Arena>(board.arena, board.camera, board.radio, 1);
    hal::mock::ArenaClock clock(*arena);
    hal::mock::MockCamera camera(*arena, clock);
    ASSERT_TRUE(camera.open().ok());
    ASSERT_TRUE(camera.start().ok());
    hal::MjpgDecoder decoder;
    decoder.open(camera.info().width_px, camera.info().height_px);
    std::vector<std::uint8_t> decoded(decoder.layout().bytes);
    std::vector<std::byte> jpeg(std::size_t{1} << 20);
    console::JpegEncoder encoder;
    const auto snapshot = std::make_unique<Snapshot>();
    for (int i = 0; i < kFrames; ++i) {
      const Result<hal::FrameLease> rendered = camera.wait(clock.now() + std::chrono::seconds(1));
      ASSERT_TRUE(rendered.ok()) << rendered.text();
      Frame frame = rendered.value().frame();
      const Result<std::size_t> size = encoder.encode(frame, 1, 80, jpeg);
      ASSERT_TRUE(size.ok()) << size.text();
      hal::FrameLease lease;
      lease.set_jpeg({reinterpret_cast<const std::uint8_t*>(jpeg.data()), size.value()});
      ASSERT_TRUE(decoder.decode(lease.jpeg(), decoded.data()).ok());
      for (std::size_t plane = 0; plane < info_of(frame.format).planes; ++plane) {
        frame.plane[plane] = decoded.data() + decoder.layout().offset_bytes[plane];
      }
      frame.stride_bytes = decoder.layout().stride_bytes;
      StepInputs inputs;
      inputs.now = frame.capture_time + std::chrono::milliseconds(20);
      inputs.action_delay = std::chrono::milliseconds(45);
      const StepTrace& trace = pipeline_->step(frame, inputs);
      robots_ += trace.tracks.robots.size();
      copy_trace(trace, *snapshot);
      snapshot->number = static_cast<std::uint64_t>(i);
      tap.add(trace, *snapshot, lease);
      pipeline_->adapt();
      if (i != lost) {
        ASSERT_TRUE(writer_.add_step(ring.front()).ok());
      }
      ring.pop();
    }
  }

  struct Replayed {
    int frames = 0, from_pictures = 0, different = 0, not_compared = 0;
    std::string notes, hash;
  };
  [[nodiscard]] Replayed replay_all() const {
    Replayed out;
    replay::RecordingSource source({});
    const Result<void> opened = source.open(path_.string());
    EXPECT_TRUE(opened.ok()) << opened.text();
    for (;;) {
      const auto step = source.next();
      EXPECT_TRUE(step.ok()) << step.text();
      for (const std::string& note : source.take_notes()) out.notes += note + "\n";
      if (!step.ok() || !step.value()) break;
      ++out.frames;
      out.from_pictures += step.value()->trace->frame.sightings == nullptr ? 1 : 0;
      out.not_compared += step.value()->is_compared ? 0 : 1;
      for (const bool differs : step.value()->differs) out.different += differs && step.value()->is_compared ? 1 : 0;
    }
    out.hash = source.hash().line();
    return out;
  }

  std::filesystem::path path_;
  std::unique_ptr<config::Configuration> configuration_ = std::make_unique<config::Configuration>();
  std::unique_ptr<Pipeline> pipeline_ = std::make_unique<Pipeline>();
  RecordingWriter writer_;
  std::size_t robots_ = 0;
};

TEST_F(JpegRecording, IsReplayedFromItsPictures) {
  record(1);
  const Replayed replayed = replay_all();
  EXPECT_EQ(replayed.frames, kFrames);
  EXPECT_EQ(replayed.from_pictures, kFrames);
  EXPECT_EQ(replayed.different, 0);
  EXPECT_EQ(replayed.hash, writer_.hash().line());
  EXPECT_EQ(writer_.counts().pictures, static_cast<std::uint64_t>(kFrames));
}

TEST_F(JpegRecording, IsReplayedFromSightingsFromTheFirstMissingPictureOn) {
  record(2);
  const Replayed replayed = replay_all();
  EXPECT_EQ(replayed.frames, kFrames);
  EXPECT_EQ(replayed.from_pictures, 1);
  EXPECT_EQ(replayed.different, 0);
  EXPECT_EQ(replayed.hash, writer_.hash().line());
  EXPECT_NE(replayed.notes.find("frame 1: its picture was not recorded"), std::string::npos) << replayed.notes;
}

TEST_F(JpegRecording, ALostStepEndsTheHash) {
  record(1, 10);
  const Replayed replayed = replay_all();
  EXPECT_EQ(replayed.frames, kFrames - 1);
  EXPECT_EQ(replayed.not_compared, kFrames - 11);
  EXPECT_EQ(replayed.different, 0);
  EXPECT_EQ(replayed.hash, writer_.hash().line());
  EXPECT_EQ(writer_.hash().steps(), 10U);
  EXPECT_NE(replayed.notes.find("frame 11: 1 step before it not recorded"), std::string::npos) << replayed.notes;
}

TEST_F(JpegRecording, ASessionBeginsAnewAndHasAWholeStretchAgain) {
  record(1, 10, 2);
  const Replayed replayed = replay_all();
  EXPECT_EQ(replayed.frames, 2 * kFrames - 1);
  EXPECT_EQ(replayed.from_pictures, 2 * kFrames - 1);
  EXPECT_EQ(replayed.not_compared, kFrames - 11);
  EXPECT_EQ(replayed.different, 0);
  EXPECT_EQ(replayed.hash, writer_.hash().line());
  EXPECT_EQ(writer_.hash().steps(), 10U + kFrames);
  EXPECT_NE(replayed.notes.find("session 2"), std::string::npos) << replayed.notes;
}

}  // namespace
}  // namespace touchline::testing
