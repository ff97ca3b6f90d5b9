#include "core/identification/drive_monitor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "core/geometry/angle.h"
#include "core/identification/drive_excitation.h"
#include "hal/mock/radio_channel.h"
#include "tests/mock/noise_free_arena.h"

// Robots of the arena's physics and radio that drive to and fro; the monitor sees what a pipeline would give it.
namespace touchline {
namespace {

constexpr double kDelay_s = 0.06, kStated_s = 0.018;
constexpr int kRobots = 3;

class DriveMonitorTest : public testing::Test {
 protected:
  static hal::mock::ArenaParameters arena() {
    hal::mock::ArenaParameters arena;
    arena.opponents = hal::mock::Opponents::kStand;
    arena.robot.clear();
    for (int id = 0; id < kRobots; ++id) {
      arena.robot.push_back({hal::mock::Side::kOwn, id, 0.5 * (id - 1), 0.0, 0.0, {"red"}});
    }
    arena.radio.delay_s = kDelay_s - arena.radio.jitter_s;
    return arena;
  }

  void SetUp() override {
    for (std::uint64_t id = 0; id < kRobots; ++id) {
      excitations_.emplace_back(ExcitationLimits{}, id + 1);
      excitations_.back().set_wiring({});
      excitations_.back().set_center({static_cast<float>(0.5 * (static_cast<double>(id) - 1.0)), 0.0f});
    }
    configure({});
  }

  void configure(const StatedDrives& stated) {
    stated_ = stated;
    monitor_->configure(stated);
    monitor_->set_stated_delay(from_seconds(kStated_s));
  }

  void run(double duration_s) {
    const Instant end = now_ + from_seconds(duration_s);
    while (now_ < end) {
      world_.step();
      now_ += std::chrono::milliseconds(1);
      channel_.deliver(now_, world_);
      if (now_ < next_frame_) continue;
      next_frame_ = next_frame_ + from_seconds(1.0 / 60.0);
      step();
    }
  }

  // A frame without latency.
  void step() {
    Tracks tracks;
    Sightings sightings;
    Commands commands;
    commands.stop = false;
    tracks.capture_time = now_;
    std::vector<hal::mock::Drive> drives;
    const hal::mock::Snapshot snapshot = world_.snapshot();
    for (int id = 0; id < kRobots; ++id) {
      const auto index = static_cast<std::size_t>(id);
      const hal::mock::Placement& at = snapshot.robots[index];
      RobotSighting sighting;
      sighting.team = Team::kOwn;
      sighting.has_heading = true;
      sighting.pose = {{static_cast<float>(at.x_m), static_cast<float>(at.y_m)}, wrap_to_float(at.theta_rad)};
      RobotTrack track;
      track.team = Team::kOwn;
      track.id = static_cast<RobotId>(are_renamed ? (id + 1) % kRobots : id);
      track.state = TrackState::kSeen;
      track.pose = sighting.pose;
      track.confidence = 1.0f;
      sightings.robots.push_back(sighting);
      tracks.robots.push_back(track);
      RobotCommand command;
      command.id = static_cast<RobotId>(id);
      command.wheels = excitations_[index].next(sighting.pose, now_);
      commands.robots.push_back(command);
      const std::array<float, 2> correction = monitor_->correction_of(command.id);
      const std::array<float, 2> stated =
          index < stated_.receivers.size() ? stated_.receivers[index].wheel_gain : Receiver{}.wheel_gain;
      WheelSpeeds& sent = commands.robots.back().wheels;
      sent = {sent.left_mps * correction[0], sent.right_mps * correction[1]};
      drives.push_back(
          {id, static_cast<double>(sent.left_mps / stated[0]), static_cast<double>(sent.right_mps / stated[1])});
    }
    ASSERT_TRUE(channel_.send(bytes_of(hal::mock::packet_of(drives, sequence_++)), now_).ok());
    if (are_away) tracks.robots.clear();
    monitor_->add_sightings(tracks, sightings);
    monitor_->add_commands(commands, channel_.drained(), {});
    monitor_->work();
  }

  bool are_renamed = false;  // each track has the id of the next robot
  bool are_away = false;     // no robot is tracked

  const RobotDrive& robot(std::size_t index) const { return monitor_->reports().robots[index]; }

  hal::mock::World world_{arena(), 1};
  hal::mock::RadioChannel channel_{arena(), 115200, 1};
  std::unique_ptr<DriveMonitor> monitor_ = std::make_unique<DriveMonitor>();
  std::vector<DriveExcitation> excitations_;
  Instant now_{}, next_frame_{};
  std::uint8_t sequence_ = 0;
  StatedDrives stated_;
};

TEST_F(DriveMonitorTest, KnowsTheDelayOfTheTeamWithinTenSeconds) {
  run(10.0);
  const ComparedValue& delay = monitor_->reports().delay_s;
  ASSERT_TRUE(delay.measured.is_known);
  EXPECT_NEAR(delay.measured.value, kDelay_s, 0.003);
  EXPECT_EQ(delay.stated, kStated_s);
  EXPECT_TRUE(delay.is_contradicted());
  EXPECT_NEAR(seconds(monitor_->more_delay()), kDelay_s - kStated_s, 0.006);
}

TEST_F(DriveMonitorTest, KnowsLagAndGainsWithinThirtySeconds) {
  run(30.0);
  const ComparedValue& lag = monitor_->reports().lag_s;
  ASSERT_TRUE(lag.measured.is_known);
  EXPECT_NEAR(lag.measured.value, 0.08, 0.01);
  // The file is right, so it stays in force.
  EXPECT_EQ(lag.used, 0.08);
  ASSERT_EQ(monitor_->reports().robots.size(), static_cast<std::size_t>(kRobots));
  for (std::size_t i = 0; i < kRobots; ++i) {
    for (std::size_t wheel = 0; wheel < 2; ++wheel) {
      EXPECT_NEAR(robot(i).gain[wheel].measured.value, world_.motors(i).gain[wheel], 0.02);
    }
  }
}

TEST_F(DriveMonitorTest, CorrectsWheelsByTheGainInForce) {
  StatedDrives stated;
  stated.receivers.push_back({0, 0, {1.2f, 0.8f}});
  configure(stated);
  EXPECT_EQ(monitor_->correction_of(0), (std::array<float, 2>{1.0f, 1.0f}));
  run(30.0);
  const RobotDrive& drive = robot(0);
  EXPECT_DOUBLE_EQ(drive.gain[0].stated, static_cast<double>(1.2f));
  ASSERT_TRUE(drive.gain[0].is_contradicted());
  EXPECT_NEAR(static_cast<double>(monitor_->correction_of(0)[0]), 1.2 / drive.gain[0].used, 1e-6);
}

TEST_F(DriveMonitorTest, SurvivesWrongIds) {
  run(12.0);
  are_renamed = true;
  run(1.5);
  are_renamed = false;
  run(12.0);
  const ComparedValue& delay = monitor_->reports().delay_s;
  ASSERT_TRUE(delay.measured.is_known);
  EXPECT_NEAR(delay.measured.value, kDelay_s, 0.003);
  EXPECT_NEAR(delay.used, kDelay_s, 0.003);
  EXPECT_NEAR(monitor_->reports().lag_s.used, 0.08, 0.01);
}

TEST_F(DriveMonitorTest, StartsARobotAnewThatWasAwayForSeconds) {
  StatedDrives stated;
  stated.receivers.push_back({0, 0, {1.2f, 0.8f}});
  configure(stated);
  run(30.0);
  ASSERT_TRUE(robot(0).gain[0].is_contradicted());
  const double delay_s = monitor_->reports().delay_s.used;
  are_away = true;
  run(2.0);
  are_away = false;
  run(0.1);
  EXPECT_TRUE(robot(0).gain[0].is_contradicted()) << "hidden";
  are_away = true;
  run(4.0);
  are_away = false;
  run(0.1);
  EXPECT_EQ(robot(0).gain[0].used, robot(0).gain[0].stated) << "may be a spare";
  EXPECT_EQ(monitor_->correction_of(0), (std::array<float, 2>{1.0f, 1.0f}));
  EXPECT_EQ(monitor_->reports().delay_s.used, delay_s) << "the radio is the same";
}

TEST_F(DriveMonitorTest, StartsAllRobotsAnewWithOtherTeams) {
  StatedDrives stated;
  stated.receivers.push_back({0, 0, {1.2f, 0.8f}});
  configure(stated);
  run(30.0);
  ASSERT_NE(monitor_->correction_of(0)[0], 1.0f);
  const double delay_s = monitor_->reports().delay_s.used;
  monitor_->restart_robots();
  EXPECT_TRUE(monitor_->reports().robots.empty());
  EXPECT_EQ(monitor_->correction_of(0), (std::array<float, 2>{1.0f, 1.0f}));
  run(0.1);
  EXPECT_EQ(monitor_->correction_of(0), (std::array<float, 2>{1.0f, 1.0f}));
  EXPECT_EQ(monitor_->reports().delay_s.used, delay_s);
}

TEST_F(DriveMonitorTest, AnotherStatedDelayLeavesAValidMeasurementInForce) {
  run(10.0);
  const double measured_s = monitor_->reports().delay_s.measured.value;
  ASSERT_TRUE(monitor_->reports().delay_s.measured.is_known);
  monitor_->set_stated_delay(from_seconds(0.03));
  EXPECT_EQ(monitor_->reports().delay_s.stated, 0.03);
  EXPECT_EQ(monitor_->reports().delay_s.used, measured_s);
  monitor_->set_stated_delay(from_seconds(kDelay_s));
  EXPECT_FALSE(monitor_->reports().delay_s.is_contradicted()) << "right files stay in force";
}

TEST_F(DriveMonitorTest, DoesNotUseADelayThatNoRadioHas) {
  hal::mock::ArenaParameters slow = arena();
  slow.radio.delay_s = 0.35;
  channel_ = hal::mock::RadioChannel(slow, 115200, 1);
  run(20.0);
  EXPECT_FALSE(monitor_->reports().delay_s.measured.is_known);
  EXPECT_EQ(monitor_->more_delay(), Duration::zero());
  for (const RobotDrive& drive : monitor_->reports().robots) {
    for (const ComparedValue& gain : drive.gain) EXPECT_FALSE(gain.is_contradicted());
  }
}

TEST_F(DriveMonitorTest, MeasuresNothingIfSwitchedOff) {
  StatedDrives stated;
  stated.is_enabled = false;
  configure(stated);
  run(5.0);
  EXPECT_TRUE(monitor_->reports().robots.empty());
  EXPECT_EQ(monitor_->more_delay(), Duration::zero());
}

}  // namespace
}  // namespace touchline
