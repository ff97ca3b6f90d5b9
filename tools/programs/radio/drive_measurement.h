#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/field_area.h"
#include "core/identification/drive_estimator.h"
#include "core/identification/drive_excitation.h"
#include "firmware/config/configuration.h"
#include "firmware/loop.h"
#include "hal/mailbox.h"

namespace touchline::radio {

struct MeasurementSettings {
  RobotId robot = 0;
  std::size_t receiver = 0;  // the robot, as index of the team file's list own.robot
  double duration_s = 23.0;  // from the first motion
  std::uint64_t seed = 1;
  ExcitationLimits limits;
  DriveExpectation expected;
  FieldParameters field;
  double robot_radius_m = 0.0375;
  hal::LineTime radio_line;
};

/// What the measurement needs of one frame.
struct DriveStep {
  Instant captured{}, sent{};    // `sent`: when the radio accepted the frame's packets
  bool stop = true;              // all robots were stopped
  WheelSpeeds wheels;            // sent to the robot; zero without a command
  std::size_t packet_bytes = 0;  // of the frame's packets, up to that of the robot
  std::size_t pauses = 0;        // between these packets
  std::optional<Pose> sighting;  // of the robot, with its heading
  Tracks tracks;
};
DriveStep drive_step_of(const StepTrace& trace, const StepTiming& timing, const MeasurementSettings& settings);

/// Returns the settings for robot `robot` of these files.
MeasurementSettings measurement_settings(const config::Configuration& configuration, RobotId robot);

/// Drives one robot within a small area of the field, and measures its drive. Nothing is allocated by step().
class DriveMeasurement {
 public:
  enum class End : std::uint8_t { kNone, kDone, kNotSeen, kNoRoom, kLeftArea, kHalted, kStands };

  explicit DriveMeasurement(const MeasurementSettings& settings);

  /// Takes a frame and returns the speeds that the robot's wheels shall get next; zero before and after the
  /// measurement. Whoever calls it brings them into the loop as the commands of another program, so that all limits and
  /// stops apply.
  WheelSpeeds step(const DriveStep& step);
  /// The same on the loop's thread; the speeds are put into commands().
  void on_step(const StepTrace& trace, const StepTiming& timing);

  [[nodiscard]] Mailbox<ExternalCommands>& commands() { return mailbox_; }
  /// Set when the measurement has ended; the loop may end then.
  [[nodiscard]] const std::atomic<bool>& has_ended() const { return has_ended_; }
  /// After the loop's end.
  [[nodiscard]] End end() const { return end_; }
  [[nodiscard]] DriveEstimator& estimator() { return estimator_; }
  [[nodiscard]] double driven_s() const { return driven_s_; }
  /// Distance that the robot's center needs from walls.
  [[nodiscard]] double wall_distance_m() const;

 private:
  void record(const DriveStep& step);
  [[nodiscard]] const RobotTrack* track_of(const Tracks& tracks) const;
  [[nodiscard]] bool has_room(const Tracks& tracks, const RobotTrack& robot) const;
  [[nodiscard]] End check(const DriveStep& step);

  const MeasurementSettings settings_;
  DriveEstimator estimator_;
  DriveExcitation excitation_;
  Mailbox<ExternalCommands> mailbox_;
  std::atomic<bool> has_ended_{false};
  End end_ = End::kNone;
  Vector2 center_;
  Instant first_frame_{}, begin_{}, seen_{}, obeyed_{};
  bool has_frame_ = false, drives_ = false;
  double driven_s_ = 0.0;
};

/// Values of the files while a robot is measured, as for --set: the other robots stand, and the wheels get the steps
/// that show delay and lag.
std::vector<std::string> measuring_overrides();

/// What ended the measurement, and what to do next.
const char* describe(DriveMeasurement::End end);

}  // namespace touchline::radio
