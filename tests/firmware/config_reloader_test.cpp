// Settings that change while the loop runs; also run under the thread sanitizer.
#include "firmware/config_reloader.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <mutex>

#include "tests/firmware/loop_fixture.h"
#include "tests/results.h"
#include "tools/programs/latency/allocation_counter.h"

namespace touchline::testing {
namespace {

using namespace std::chrono_literals;

class ConfigReloaderTest : public LoopTest {
 protected:
  ConfigReloaderTest()
      : folder_(std::filesystem::temp_directory_path() / ("touchline-reloader-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
    write_board(5000, "0.2");
    write_venue("200, 20, 200");
    write("team.toml",
          "version = 1\n[own]\ncolor = \"blue\"\nmax_robots = 1\n[[own.robot]]\nid = 0\ncolors = [\"red\"]\n[ball]\n"
          "color = \"orange\"\n");
    settings.live_update = &live_update_;
  }
  ~ConfigReloaderTest() override {
    if (loop) loop->close();
    std::filesystem::remove_all(folder_);
  }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  void write_board(int exposure_us, const std::string& stop_after_s, int buffers = 4) const {
    write("board.toml",
          "version = 1\nvenue = \"venue.toml\"\nteam = \"team.toml\"\n[camera]\nbackend = \"v4l2\"\n"
          "format = \"rgb24\"\nwidth_px = 64\nheight_px = 48\nexposure_us = " +
              std::to_string(exposure_us) + "\nbuffers = " + std::to_string(buffers) +
              "\n[radio]\nbackend = \"none\"\n[faults]\nstop_after_s = " + stop_after_s + "\n");
  }
  /// The ball's pixels are 210, 110, 220.
  void write_venue(const std::string& orange_low) const {
    write("venue.toml",
          "version = 1\n[picture]\nwidth_px = 64\nheight_px = 48\n[field]\nlength_m = 2.2\nwidth_m = 1.8\n"
          "[camera_model]\nkind = \"full\"\n[camera_model.full]\nfx_px = 600.0\nfy_px = 600.0\ncx_px = 31.5\n"
          "cy_px = 23.5\nrotation_rad = [3.14159265, 0.0, 0.0]\nposition_m = [0.0, 0.0, 2.0]\n[colors]\n"
          "space = \"rgb\"\n[[color]]\nname = \"orange\"\n[[color.box]]\nlow = [" +
              orange_low + "]\nhigh = [" + (orange_low == "200, 20, 200" ? "220, 40, 255" : "220, 120, 255") +
              "]\n[[color]]\nname = \"blue\"\n[[color.box]]\nlow = [100, 100, 200]\nhigh = [120, 120, 255]\n"
              "[[color]]\nname = \"red\"\n[[color.box]]\nlow = [150, 100, 200]\nhigh = [170, 120, 255]\n");
  }
  /// Starts the loop with the files.
  void begin() {
    const config::FilePaths paths{(folder_ / "board.toml").string(), "", "", {}};
    const auto configuration = std::make_unique<config::Configuration>();
    ASSERT_OK(config::load(paths, *configuration));
    start({&ConfigReloaderTest::look, this});
    ASSERT_TRUE(pipeline->configure(configuration->pipeline).ok());
    reloader_.emplace(paths, *configuration, camera, live_update_);
    camera.show_ball();
    run_until(0.5);
  }
  /// Requests a reload on its thread while the loop iterates. Returns the messages without the folder's name.
  std::string reload() {
    std::mutex saying;
    std::string messages;
    std::atomic<std::uint32_t> requests{0};
    std::atomic<bool> done{false};
    {
      const ReloadThread thread([&](const std::atomic<bool>& cancelled) { return reloader_->reload(cancelled); },
                                requests,
                                [&](const std::string& line) {
                                  const std::scoped_lock alone(saying);
                                  messages += line + "\n";
                                  done.store(true, std::memory_order_release);
                                });
      requests.fetch_add(1);
      const std::uint64_t before = latency::allocations_of_this_thread();
      while (!done.load(std::memory_order_acquire)) {
        static_cast<void>(loop->iterate());
        std::this_thread::sleep_for(1ms);  // simulated time takes no real time
      }
      EXPECT_EQ(latency::allocations_of_this_thread() - before, 0U);
    }
    run_until(now_s() + 0.1);
    const std::string prefix = folder_.string() + "/";
    for (std::size_t at = messages.find(prefix); at != std::string::npos; at = messages.find(prefix, at)) {
      messages.erase(at, prefix.size());
    }
    return messages;
  }
  /// As reload(), with the number of the frame, which is checked, replaced by N.
  std::string reload_from_next_frame() {
    std::string messages = reload();
    const std::string begin = "reload: from frame ";
    const std::size_t at = messages.find(begin);
    EXPECT_NE(at, std::string::npos) << messages;
    if (at == std::string::npos) return messages;
    std::size_t digits = 0;
    const unsigned long frame = std::stoul(messages.substr(at + begin.size()), &digits);
    EXPECT_GT(frame, 25U);
    EXPECT_LE(frame, loop->statistics().frames);
    return messages.replace(at + begin.size(), digits, "N");
  }
  void expect_no_hitch() {
    EXPECT_EQ(loop->statistics().frames_lost, 0U);
    EXPECT_EQ(loop->statistics().frames, loop->statistics().good_frames);
    for (std::size_t i = 1; i < radio.sent.size(); ++i) {
      ASSERT_EQ(radio.sent[i].sequence, static_cast<std::uint8_t>(radio.sent[i - 1].sequence + 1));
      ASSERT_NEAR(radio.sent[i].at_s - radio.sent[i - 1].at_s, 0.02, 1e-6) << "a packet for every frame";
    }
  }

  LiveUpdate live_update_;
  std::optional<ConfigReloader> reloader_;
  bool ball_is_seen_ = false;

 private:
  static void look(void* context, const StepTrace& trace, const StepTiming&) {
    static_cast<ConfigReloaderTest*>(context)->ball_is_seen_ = trace.sightings.ball.seen;
  }

  std::filesystem::path folder_;
};

TEST_F(ConfigReloaderTest, NewThresholdsApplyFromTheNextFrame) {
  begin();
  EXPECT_FALSE(ball_is_seen_);
  write_venue("200, 100, 200");
  EXPECT_EQ(reload_from_next_frame(), "reload: from frame N on: color.orange\n");
  EXPECT_TRUE(ball_is_seen_);
  // This reload changes the values back, and so uses the scanner's first tables.
  write_venue("200, 20, 200");
  EXPECT_EQ(reload_from_next_frame(), "reload: from frame N on: color.orange\n");
  EXPECT_FALSE(ball_is_seen_);
  write_venue("200, 100, 200");
  EXPECT_EQ(reload_from_next_frame(), "reload: from frame N on: color.orange\n");
  EXPECT_TRUE(ball_is_seen_);
  EXPECT_EQ(reload(), "reload: nothing has changed\n");
  EXPECT_FALSE(camera.adjusted_exposure_us.has_value());
  expect_no_hitch();
}

TEST_F(ConfigReloaderTest, InvalidFilesChangeNothing) {
  begin();
  write_venue("230, 100, 200");
  write_board(4000, "99");
  EXPECT_EQ(reload(),
            "board.toml:14: faults.stop_after_s: 99 is out of range: 0.02 to 5 s\nreload: nothing was changed\n");
  write_board(4000, "0.3");
  EXPECT_EQ(reload(),
            "venue.toml:21: color[0].box[0]: low 230 is above high 220 in channel 0\nreload: nothing was changed\n");
  EXPECT_FALSE(camera.adjusted_exposure_us.has_value());
  EXPECT_EQ(reloader_->running().board.camera.exposure_us, 5000);
  EXPECT_FALSE(ball_is_seen_);
  expect_no_hitch();
}

TEST_F(ConfigReloaderTest, CameraAndTimesChangeAndOtherKeysNeedARestart) {
  camera.negotiated = "/dev/fake0: exposure_us = 4000: set to 4100";
  begin();
  write_board(4000, "0.06", 6);
  EXPECT_EQ(reload_from_next_frame(),
            "reload: camera: /dev/fake0: exposure_us = 4000: set to 4100\n"
            "reload: from frame N on: camera.exposure_us 5000 -> 4000, faults.stop_after_s 0.2 -> 0.06\n"
            "reload: needs a restart: camera.buffers\n");
  EXPECT_EQ(camera.adjusted_exposure_us, 4000);
  expect_no_hitch();
  // Robots are stopped after the new time.
  const double stalled_s = now_s();
  camera.add({stalled_s, stalled_s + 0.15, ErrorCode::kTimeout});
  run_until(stalled_s + 0.15);
  EXPECT_TRUE(all_stop(stalled_s + 0.1, stalled_s + 0.15));
}

TEST(ReloadThreadTest, AnExceptionEndsOnlyOneReload) {
  std::atomic<std::uint32_t> requests{1};
  std::atomic<int> reloads{0};
  std::mutex printing;
  std::vector<std::string> printed;
  {
    const ReloadThread thread(
        [&](const std::atomic<bool>&) -> std::vector<std::string> {
          if (++reloads == 1) throw std::bad_alloc();
          return {"reload: nothing has changed"};
        },
        requests,
        [&](const std::string& line) {
          const std::scoped_lock lock(printing);
          printed.push_back(line);
        });
    const auto wait_for = [&](std::size_t lines) {
      for (int i = 0; i < 5000; ++i) {
        {
          const std::scoped_lock lock(printing);
          if (printed.size() >= lines) return;
        }
        std::this_thread::sleep_for(1ms);
      }
    };
    wait_for(1);
    requests.fetch_add(1);
    wait_for(2);
  }
  EXPECT_EQ(printed, (std::vector<std::string>{"reload: failed: std::bad_alloc; nothing was changed",
                                               "reload: nothing has changed"}));
}

TEST_F(ConfigReloaderTest, AFrozenAdaptationStaysFrozen) {
  AdaptationRequests requests;
  settings.adaptation = &requests;
  begin();
  requests.freeze.fetch_add(1);
  run_until(now_s() + 0.1);
  ASSERT_EQ(pipeline->adaptation(), AdaptationMode::kFrozen);
  write_venue("200, 100, 200");
  EXPECT_EQ(reload_from_next_frame(), "reload: from frame N on: color.orange\n");
  EXPECT_EQ(pipeline->adaptation(), AdaptationMode::kFrozen);
}

}  // namespace
}  // namespace touchline::testing
