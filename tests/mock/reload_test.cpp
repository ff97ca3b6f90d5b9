// Reloading the configuration of boards/mock during a game.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "firmware/config_reloader.h"
#include "firmware/session.h"
#include "tests/results.h"
#include "tools/programs/latency/allocation_counter.h"

namespace touchline {
namespace {

using namespace std::chrono_literals;

class Reload : public ::testing::Test {
 protected:
  Reload() : folder_(std::filesystem::temp_directory_path() / ("touchline-reload-" + std::to_string(::getpid()))) {
    std::filesystem::copy(TOUCHLINE_BOARDS "/mock", folder_);
  }
  ~Reload() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string text_of(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder_ / name).rdbuf();
    return text.str();
  }
  void replace(const std::string& name, const std::string& from, const std::string& to) const {
    std::string changed = text_of(name);
    const std::size_t at = changed.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    std::ofstream(folder_ / name) << changed.replace(at, from.size(), to);
  }
  /// The lines that bound a color of the venue file.
  [[nodiscard]] std::string box_of(const std::string& color) const {
    const std::string text = text_of("venue.toml");
    const std::size_t low = text.find("low = ", text.find("name = \"" + color + "\"")),
                      high = text.find("high = ", low);
    return text.substr(low, text.find('\n', high) - low);
  }
  /// A corner of the box, which contains almost none of the color's pixels.
  static std::string corner_of(const std::string& box) {
    std::array<int, 3> low{};
    EXPECT_EQ(std::sscanf(box.c_str(), "low = [%d, %d, %d]", &low[0], &low[1], &low[2]), 3) << box;
    std::ostringstream out;
    out << box.substr(0, box.find("high")) << "high = [" << low[0] + 2 << ", " << low[1] + 2 << ", " << low[2] + 2
        << "]";
    return out.str();
  }
  void begin() {
    SessionOptions options;
    options.files.board = (folder_ / "board.toml").string();
    ASSERT_OK(session_.load(options));
    ASSERT_OK(session_.open({&Reload::observe, this}));
    reloader_.emplace(session_.files(), session_.configuration(), session_.devices().hal_devices().camera,
                      session_.live_update());
    run(30);  // until all robots have tracks
    watching_ = true;
  }
  void run(int frames) {
    for (const int end = frames_ + frames; frames_ < end;) ASSERT_FALSE(session_.loop().iterate().has_value());
  }
  /// Reloads during the game; returns the messages.
  std::string reload() {
    std::string messages;
    std::atomic<bool> done{false};
    const std::atomic<bool> cancelled{false};
    std::thread thread([&] {
      for (const std::string& line : reloader_->reload(cancelled)) messages += line + "\n";
      done.store(true, std::memory_order_release);
    });
    const std::uint64_t before = latency::allocations_of_this_thread();
    while (!done.load(std::memory_order_acquire)) static_cast<void>(session_.loop().iterate());
    EXPECT_EQ(latency::allocations_of_this_thread() - before, 0U);
    thread.join();
    return messages;
  }

  Session session_;
  std::optional<ConfigReloader> reloader_;
  int frames_ = 0, with_ball_ = 0, incomplete_ = 0;
  double longest_step_m_ = 0.0, brightness_ = 0.0;

 private:
  static void observe(void* context, const StepTrace& trace, const StepTiming&) {
    Reload& reload = *static_cast<Reload*>(context);
    ++reload.frames_;
    reload.with_ball_ += trace.sightings.ball.seen ? 1 : 0;
    reload.brightness_ = 0.0;
    for (std::size_t i = 0; i < 640U * 3; ++i) reload.brightness_ += trace.frame.plane[0][640U * 3 * 240 + i];
    if (!reload.watching_) return;
    std::size_t seen = 0;
    for (const RobotTrack& robot : trace.tracks.robots) {
      if (robot.id == kUnknownId || robot.state != TrackState::kSeen) continue;
      ++seen;
      FieldPoint& last = reload.last_[static_cast<std::size_t>(robot.team)][static_cast<std::size_t>(robot.id)];
      if (reload.has_last_) {
        reload.longest_step_m_ = std::max(
            reload.longest_step_m_,
            static_cast<double>(std::hypot(robot.pose.position.x_m - last.x_m, robot.pose.position.y_m - last.y_m)));
      }
      last = robot.pose.position;
    }
    reload.has_last_ = true;
    reload.incomplete_ += seen == 10 ? 0 : 1;
  }

  std::filesystem::path folder_;
  bool watching_ = false, has_last_ = false;
  std::array<std::array<FieldPoint, 128>, 2> last_{};
};

// Without a reload, no robot moves farther than 0.021 m from frame to frame (1.2 m/s is 0.02 m).
TEST_F(Reload, ThresholdsChangeWithoutLosingAFrameOrAPose) {
  const std::string box = box_of("orange"), too_small = corner_of(box);
  replace("venue.toml", box, too_small);
  begin();
  run(10);
  EXPECT_EQ(with_ball_, 0);
  replace("venue.toml", too_small, box);
  const std::string messages = reload();
  EXPECT_NE(messages.find(" on: color.orange\n"), std::string::npos) << messages;
  run(30);
  EXPECT_GE(with_ball_, 25);
  EXPECT_EQ(incomplete_, 0) << "frames that do not show all ten robots";
  EXPECT_LT(longest_step_m_, 0.03);
  EXPECT_EQ(session_.loop().statistics().frames_lost, 0U);
  EXPECT_EQ(session_.loop().statistics().frames, session_.loop().statistics().good_frames);
}

TEST_F(Reload, AShorterExposureDarkensTheArenasCamera) {
  begin();
  const double before = brightness_;
  replace("board.toml", "rate_hz = 60.0", "rate_hz = 60.0\nexposure_us = 3500");
  const std::string messages = reload();
  EXPECT_NE(messages.find(" on: camera.exposure_us 5000 -> 3500\n"), std::string::npos) << messages;
  run(5);
  // With a gamma of 2.2, 0.7 of the light gives 0.85 of the value.
  EXPECT_NEAR(brightness_ / before, 0.85, 0.03);
  EXPECT_EQ(session_.loop().statistics().frames_lost, 0U);
}

}  // namespace
}  // namespace touchline
