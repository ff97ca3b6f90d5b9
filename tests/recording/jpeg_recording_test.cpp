// A recording with the JPEG files of a camera is replayed from them; without some of them, from the recorded sightings.
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <random>
#include <utility>

#include "firmware/config/light_map_file.h"
#include "firmware/config/reload.h"
#include "firmware/console/jpeg_encoder.h"
#include "firmware/recording/recording_writer.h"
#include "hal/files/output_file.h"
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

  /// Leaves no room in the ring.
  static void fill(ByteRing& ring) {
    for (std::size_t size = ring.free(); size > 0; size /= 2) {
      while (!ring.reserve(size).empty()) ring.commit();
    }
  }
  static void drain(ByteRing& ring) {
    while (!ring.front().empty()) ring.pop();
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
      std::vector<std::uint8_t> noise(picture_layout(frame.format, frame.width_px, frame.height_px).bytes);
      if (i >= noise_from_ && i < noise_to_) {
        for (std::uint8_t& value : noise) value = static_cast<std::uint8_t>(random_());
        for (std::size_t plane = 0; plane < info_of(frame.format).planes; ++plane) frame.plane[plane] = noise.data();
      }
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
      inputs.picture_check.unusable_frames = 2;
      if (i == reload_at_ && tap.session() == 1) reload(inputs);
      const StepTrace& trace = pipeline_->step(frame, inputs);
      robots_ += trace.tracks.robots.size();
      copy_trace(trace, *snapshot);
      snapshot->number = static_cast<std::uint64_t>(i);
      if (i == begins_at_) tap.begin(1);
      if (i < begins_at_) tap.end();
      if (i == full_at_) fill(ring);
      tap.add(*pipeline_, trace, *snapshot, lease);
      if (i == full_at_) drain(ring);
      pipeline_->adapt();
      unusable_ += trace.picture.is_unusable() ? 1U : 0U;
      if (ring.front().empty()) continue;
      if (i != lost) write_step(ring.front(), i < pictures_until_);
      ring.pop();
    }
  }

  void write_step(std::span<const std::byte> record, bool with_picture) {
    if (std::exchange(breaks_state_, false)) {
      std::vector<std::byte> bytes(record.begin(), record.end());
      // The first byte of a state is a bool.
      bytes[sizeof(StepParts) + sizeof(Snapshot)] = std::byte{7};
      ASSERT_TRUE(writer_.add_step(bytes).ok());
      return;
    }
    if (with_picture) {
      ASSERT_TRUE(writer_.add_step(record).ok());
      return;
    }
    // As StepTap puts it if there is no memory for the picture.
    std::vector<std::byte> bytes(record.begin(), record.begin() + sizeof(StepParts) + sizeof(Snapshot));
    StepHeader header;
    std::memcpy(&header, bytes.data(), sizeof header);
    header.picture = PictureKind::kNone;
    std::memcpy(bytes.data(), &header, sizeof header);
    ASSERT_TRUE(writer_.add_step(bytes).ok());
  }

  /// A reload that makes the robots slower.
  void reload(StepInputs& inputs) {
    const auto files = std::make_unique<config::Configuration>(*configuration_);
    files->team.control.drive.max_speed_mps = kReloadedSpeed_mps;
    ConfigurationText text = text_of(*files);
    text.session = text.reload = 1;
    ASSERT_TRUE(writer_.add(text).ok());
    inputs.events.control = files->team.control;
  }

  struct Replayed {
    int frames = 0, from_pictures = 0, different = 0, not_compared = 0;
    std::string notes, hash;
    double max_speed_mps = 0.0;  // at the end
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
    out.max_speed_mps = source.configuration().team.control.drive.max_speed_mps;
    return out;
  }

  std::filesystem::path path_;
  std::unique_ptr<config::Configuration> configuration_ = std::make_unique<config::Configuration>();
  std::unique_ptr<Pipeline> pipeline_ = std::make_unique<Pipeline>();
  RecordingWriter writer_;
  std::size_t robots_ = 0, unusable_ = 0;
  std::mt19937 random_{1};
  static constexpr double kReloadedSpeed_mps = 0.31;
  // Steps: those whose picture is noise, the one that uses a reload, the first one whose picture is lost.
  int noise_from_ = kFrames, noise_to_ = kFrames, reload_at_ = -1, pictures_until_ = kFrames;
  // Steps: the one with which the recording begins, and the one for which there is no memory.
  int begins_at_ = 0, full_at_ = -1;
  bool breaks_state_ = false;  // of the first step
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

// The tap notices the loss, so the next step is recorded with the state after it.
TEST_F(JpegRecording, AfterAGapTheReplayContinuesFromTheRecordedState) {
  full_at_ = 10;
  record(1);
  const Replayed replayed = replay_all();
  EXPECT_EQ(replayed.frames, kFrames - 1);
  EXPECT_EQ(replayed.from_pictures, 11);
  EXPECT_EQ(replayed.not_compared, 1);
  EXPECT_EQ(replayed.different, 0);
  EXPECT_EQ(replayed.hash, writer_.hash().line());
  EXPECT_EQ(writer_.hash().steps(), static_cast<std::uint64_t>(kFrames - 2));
  EXPECT_NE(replayed.notes.find("frame 11: 1 step before it not recorded"), std::string::npos) << replayed.notes;
  EXPECT_NE(replayed.notes.find("frame 11: its state is recorded"), std::string::npos) << replayed.notes;
}

TEST_F(JpegRecording, ARecordingThatBeginsLateIsReplayedFromItsFirstState) {
  begins_at_ = 8;
  full_at_ = 15;
  record(1);
  const Replayed replayed = replay_all();
  EXPECT_EQ(replayed.frames, kFrames - 9);
  EXPECT_EQ(replayed.from_pictures, 1);
  EXPECT_EQ(replayed.not_compared, 2);
  EXPECT_EQ(replayed.different, 0);
  EXPECT_EQ(replayed.hash, writer_.hash().line());
  EXPECT_EQ(writer_.hash().steps(), static_cast<std::uint64_t>(kFrames - 11));
}

TEST_F(JpegRecording, AStateThatCannotBeReadEndsTheReplayWithItsPlace) {
  begins_at_ = 8;
  breaks_state_ = true;
  record(1);
  replay::RecordingSource source({});
  ASSERT_TRUE(source.open(path_.string()).ok());
  const auto step = source.next();
  EXPECT_EQ(step.code(), ErrorCode::kCorruptFrame);
  EXPECT_NE(step.text().find(path_.string() + ": byte "), std::string::npos) << step.text();
  EXPECT_NE(step.text().find("the state of the filters and the play cannot be read"), std::string::npos) << step.text();
}

TEST_F(JpegRecording, AReloadInAGapIsInForceAfterIt) {
  reload_at_ = full_at_ = 10;
  record(1);
  const Replayed replayed = replay_all();
  EXPECT_EQ(replayed.max_speed_mps, kReloadedSpeed_mps);
  EXPECT_EQ(replayed.not_compared, 1);
  EXPECT_EQ(replayed.different, 0);
  EXPECT_EQ(replayed.hash, writer_.hash().line());
}

TEST_F(JpegRecording, AReloadIsRepeated) {
  reload_at_ = 10;
  record(1);
  const Replayed replayed = replay_all();
  EXPECT_EQ(replayed.different, 0);
  EXPECT_EQ(replayed.not_compared, 0);
  EXPECT_EQ(replayed.max_speed_mps, kReloadedSpeed_mps);
  EXPECT_EQ(replayed.hash, writer_.hash().line());
}

TEST_F(JpegRecording, AReloadEndsWithItsSession) {
  reload_at_ = 10;
  record(1, -1, 2);
  const Replayed replayed = replay_all();
  EXPECT_EQ(replayed.frames, 2 * kFrames);
  EXPECT_EQ(replayed.different, 0);
  EXPECT_NE(replayed.max_speed_mps, kReloadedSpeed_mps);
  EXPECT_EQ(replayed.hash, writer_.hash().line());
}

// The step was dropped because the recorder's memory was full.
TEST_F(JpegRecording, AReloadWhoseStepIsLostTakesEffectInTheNextOneAndNothingIsCalledEqual) {
  reload_at_ = 10;
  record(1, 10);
  const Replayed replayed = replay_all();
  EXPECT_EQ(replayed.max_speed_mps, kReloadedSpeed_mps);
  EXPECT_NE(replayed.notes.find("frame 11: reload 1 took effect in a step that was not recorded"), std::string::npos)
      << replayed.notes;
  EXPECT_EQ(replayed.not_compared, kFrames - 11);
  EXPECT_EQ(replayed.hash, writer_.hash().line());
  EXPECT_EQ(writer_.hash().steps(), 10U);
}

// The last pictures are lost while noise hides the field: tracks begin anew after them, and not where the
// recorded sightings replace the pictures.
TEST_F(JpegRecording, AnUnusablePictureIsUnusableInTheReplayWithoutIt) {
  noise_from_ = 8;
  noise_to_ = 16;
  pictures_until_ = 12;
  record(1);
  EXPECT_GE(unusable_, 6U);
  const Replayed replayed = replay_all();
  EXPECT_EQ(replayed.from_pictures, 12);
  EXPECT_EQ(replayed.different, 0);
  EXPECT_EQ(replayed.not_compared, 0);
  EXPECT_EQ(replayed.hash, writer_.hash().line());
}

// What is recorded is what the program has read, not what the file holds later.
TEST_F(JpegRecording, TheLightIsRecordedAsItWasRead) {
  const std::filesystem::path folder = path_.string() + "-files";
  std::filesystem::copy(TOUCHLINE_MOCK_FOLDER, folder);
  const auto load = [&] {
    auto files = std::make_unique<config::Configuration>();
    const Result<void> loaded = config::load({(folder / "board.toml").string(), {}, {}, {}}, *files);
    EXPECT_TRUE(loaded.ok()) << loaded.text();
    return files;
  };
  const auto read_back = [](const ConfigurationText& text) {
    TemporaryFiles files;
    EXPECT_TRUE(files.write(text).ok());
    auto read = std::make_unique<config::Configuration>();
    const Result<void> loaded = config::load(files.paths({}), *read);
    EXPECT_TRUE(loaded.ok()) << loaded.text();
    return read;
  };
  const auto same_light = [](const config::Configuration& a, const config::Configuration& b) {
    const LightMap &x = a.pipeline.scan.light, &y = b.pipeline.scan.light;
    return x.columns == y.columns && x.rows == y.rows && x.illumination == y.illumination &&
           a.pipeline.adaptation.reference.colors.sum == b.pipeline.adaptation.reference.colors.sum;
  };
  const auto running = load();
  ASSERT_FALSE(running->venue.light.map.empty());
  const auto write_map = [&](float factor) {
    LightMap map = running->pipeline.scan.light;
    for (auto& plane : map.illumination) {
      for (float& value : plane) value *= factor;
    }
    const Result<std::string> png = config::encode_light_map(map);
    ASSERT_TRUE(png.ok()) << png.text();
    ASSERT_TRUE(hal::write_file((folder / running->venue.light.map).string(), png.value()).ok());
  };
  write_map(0.75f);
  const auto next = load();
  EXPECT_FALSE(same_light(*next, *running)) << "the file has changed";
  EXPECT_TRUE(same_light(*read_back(text_of(*running)), *running)) << "a session";
  // A reload: both ends use what was read with its files.
  write_map(0.5f);
  const auto applied = std::make_unique<config::Configuration>(*running);
  ASSERT_TRUE(config::apply_reloadable(*next, *applied).ok());
  EXPECT_TRUE(same_light(*applied, *next)) << "the program";
  EXPECT_TRUE(same_light(*read_back(text_of(*next)), *next)) << "the recording";
  std::filesystem::remove_all(folder);
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
