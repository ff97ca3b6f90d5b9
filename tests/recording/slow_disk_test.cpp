// A disk that stands still, is full, or is gone while a game is recorded: the loop's thread does not wait for it, every
// packet is sent, and what was lost is counted. The linker replaces write() and fdatasync() of the recorder's thread.
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <thread>

#include "firmware/recording/recorder.h"
#include "firmware/recording/recording_writer.h"
#include "hal/recording/mcap_reader.h"
#include "tests/firmware/loop_fixture.h"

namespace {

std::atomic<bool> stands_still{false}, is_waiting{false};
std::atomic<int> write_error{0};

// Blocks for as long as the disk stands still.
void wait_for_disk() {
  while (stands_still.load()) {
    is_waiting.store(true);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  is_waiting.store(false);
}

}  // namespace

extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier): the linker's names
ssize_t __real_write(int file, const void* bytes, std::size_t count);
int __real_fdatasync(int file);

ssize_t __wrap_write(int file, const void* bytes, std::size_t count) {
  wait_for_disk();
  if (write_error.load() == 0) return __real_write(file, bytes, count);
  errno = write_error.load();
  return -1;
}

int __wrap_fdatasync(int file) {
  wait_for_disk();
  if (write_error.load() == 0) return __real_fdatasync(file);
  errno = write_error.load();
  return -1;
}
// NOLINTEND(bugprone-reserved-identifier)
}

namespace touchline::testing {
namespace {

using namespace recording;

class SlowDisk : public LoopTest {
 protected:
  SlowDisk() : folder_(std::filesystem::temp_directory_path() / ("touchline-disk-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
    RecordingPlan plan;
    plan.folder = folder_.string();
    plan.settings.memory_mb = 8;
    plan.settings.reserve_mb = 0;
    auto opened = Recorder::open(plan, "test");
    EXPECT_TRUE(opened.ok()) << opened.text();
    recorder_ = std::move(opened).value();
    recorder_->start([this](const std::string& line) {
      const std::scoped_lock lock(mutex_);
      printed_ += line + "\n";
    });
    recorder_->tap().begin_session(false);
    settings.recording = &recorder_->tap();
    start();
  }
  ~SlowDisk() override {
    stands_still = false;
    write_error = 0;
    recorder_.reset();
    std::filesystem::remove_all(folder_);
  }

  /// Runs the loop, and returns how often its thread has waited for anything.
  long run_and_count_waits(double end_s) {
    rusage before{}, after{};
    EXPECT_EQ(::getrusage(RUSAGE_THREAD, &before), 0);
    run_until(end_s);
    EXPECT_EQ(::getrusage(RUSAGE_THREAD, &after), 0);
    return after.ru_nvcsw - before.ru_nvcsw;
  }
  template <class Condition>
  static bool becomes_true(const Condition& condition) {
    for (int i = 0; i < 10'000 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return condition();
  }

  struct Found {
    std::uint64_t steps = 0, pictures = 0, missing = 0;
    bool is_complete = false;
  };
  /// Reads the recording.
  [[nodiscard]] Found found() const {
    Found out;
    hal::mcap::McapReader reader;
    EXPECT_TRUE(reader.open(path()).ok());
    const auto step = std::make_unique<StepMessage>();
    std::uint64_t next = 0;
    for (;;) {
      const auto message = reader.next();
      if (!message.ok() || !message.value()) break;
      if (reader.channels().at(message.value()->channel).topic != kStepTopic) continue;
      EXPECT_TRUE(decode(message.value()->data, *step).ok());
      ++out.steps;
      out.pictures += step->header.picture != PictureKind::kNone ? 1U : 0U;
      out.missing += step->header.number - next;
      next = step->header.number + 1;
    }
    out.is_complete = reader.is_complete();
    return out;
  }
  [[nodiscard]] std::string path() const { return (folder_ / recorder_->status_reader()().file).string(); }
  [[nodiscard]] std::string printed() {
    const std::scoped_lock lock(mutex_);
    return printed_;
  }

  std::filesystem::path folder_;
  std::unique_ptr<Recorder> recorder_;
  std::mutex mutex_;
  std::string printed_;
};

TEST_F(SlowDisk, ThatStandsForFiveSecondsDelaysNoStep) {
  run_until(1.0);
  stands_still = true;
  ASSERT_TRUE(becomes_true([] { return is_waiting.load(); }));
  // Five seconds of the game, and five more, in which nothing can be recorded.
  const std::uint64_t before = loop->statistics().frames;
  const long waits = run_and_count_waits(11.0);
  const std::uint64_t frames = loop->statistics().frames - before;
  EXPECT_TRUE(is_waiting.load()) << "the disk stood all the time";
  EXPECT_EQ(waits, 0) << "the loop's thread waited";
  EXPECT_GT(frames, 480U);
  EXPECT_EQ(packets(1.0, 11.0).size(), frames) << "robots got every packet";
  EXPECT_GT(recorder_->tap().lost_pictures(), 100U);
  EXPECT_GT(recorder_->tap().lost_steps(), 50U);
  stands_still = false;
  ASSERT_TRUE(becomes_true([&] { return !is_waiting.load(); }));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // the recorder catches up
  run_until(12.0);
  loop->close();
  recorder_->finish();
  const Found read = found();
  EXPECT_TRUE(read.is_complete);
  EXPECT_EQ(read.missing, recorder_->tap().lost_steps()) << "lost steps are gaps in the file";
  const std::string summary = recorder_->summary();
  EXPECT_NE(summary.find(": " + std::to_string(read.steps) + " steps, " + std::to_string(read.pictures) + " pictures"),
            std::string::npos)
      << summary;
  EXPECT_NE(summary.find(std::to_string(recorder_->tap().lost_pictures()) + " pictures lost, " +
                         std::to_string(read.missing) + " steps lost"),
            std::string::npos)
      << summary;
}

class FailingDisk : public SlowDisk, public ::testing::WithParamInterface<int> {};

TEST_P(FailingDisk, EndsTheRecordingAndNotTheGame) {
  run_until(2.0);
  // A second of steps is in the file.
  ASSERT_TRUE(becomes_true([&] { return std::filesystem::file_size(path()) > 100'000; }));
  write_error = GetParam();
  run_until(3.0);
  ASSERT_TRUE(becomes_true([&] { return printed().find("recording: ends: ") != std::string::npos; })) << printed();
  const std::uint64_t before = loop->statistics().frames;
  EXPECT_EQ(run_and_count_waits(8.0), 0);
  const std::uint64_t frames = loop->statistics().frames - before;
  EXPECT_GT(frames, 240U);
  EXPECT_EQ(packets(3.0, 8.0).size(), frames);
  loop->close();
  recorder_->finish();
  EXPECT_NE(recorder_->summary().find("; it ended early: "), std::string::npos) << recorder_->summary();
  const Found read = found();
  EXPECT_GT(read.steps, 30U);
  EXPECT_FALSE(read.is_complete) << "the disk takes no end of the file";
  EXPECT_NE(recorder_->summary().find(": " + std::to_string(read.steps) + " steps"), std::string::npos)
      << recorder_->summary();
}

INSTANTIATE_TEST_SUITE_P(IsFullOrGone, FailingDisk, ::testing::Values(ENOSPC, EIO, ENODEV));

}  // namespace
}  // namespace touchline::testing
