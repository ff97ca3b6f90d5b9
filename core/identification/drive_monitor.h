#pragma once

#include <array>
#include <cstddef>

#include "core/geometry/field_area.h"
#include "core/identification/drive_estimator.h"
#include "core/radio/packet_layout.h"
#include "core/types.h"

namespace touchline {

/// What the files state of the own robots.
struct StatedDrives {
  bool is_enabled = true;  // false: nothing is measured
  double lag_s = 0.08, wheel_base_m = 0.07;
  double robot_radius_m = 0.0375;  // half the side
  FieldParameters field;
  FixedVector<Receiver, kMaxRobotsPerTeam> receivers;  // with their gains; other robots have gains of 1
};

/// Measures the drives of all own robots while they play, with a DriveEstimator for each, and decides which values are
/// in force: those of the files until a measurement contradicts them.
///
/// Motion counts only while no wall and no other robot can be touched; residuals tell other pushes. All robots share
/// the radio's delay and the kind of their wheels, so delay and lag are the weighted means of all robots, and a robot
/// starts where the first one ended its search. The same calls give the same values. Nothing is allocated. The object
/// has 1 MB.
class DriveMonitor {
 public:
  void configure(const StatedDrives& stated);
  /// Sets the delay of the radio that the files state. If it changes, it is in force unless the measured one
  /// contradicts it.
  void set_stated_delay(Duration delay);
  /// Tracks begin anew: the next sightings do not continue the former ones.
  void interrupt();
  /// Forgets the records and the gains of all robots: other ones may have their ids. Delay and lag stay in force.
  void restart_robots();
  /// Adds the sightings of the own robots whose ids are certain. `tracks` have fused `sightings`. A robot that was not
  /// seen for some seconds starts anew: a spare may have its id.
  void add_sightings(const Tracks& tracks, const Sightings& sightings);
  /// Adds commands whose packets ended at `sent`, later by `lateness` of each receiver. `commands`: as they were
  /// encoded, with correction_of() and before the stated gains divide them.
  void add_commands(const Commands& commands, Instant sent, const std::array<Duration, kMaxRobotsPerTeam>& lateness);
  /// Processes at most kMaxIntervals intervals of the records, and compares the result with the files.
  void work();
  // About 0.1 ms on x86, until each robot has values. Then a quarter suffices to follow slow changes: a pass over the
  // full records of five robots takes 14 s at 60 frames per second.
  static constexpr std::size_t kMaxIntervals = 48;

  [[nodiscard]] const DriveReports& reports() const { return reports_; }
  /// How much longer than stated the delay in force is.
  [[nodiscard]] Duration more_delay() const { return from_seconds(reports_.delay_s.used - reports_.delay_s.stated); }
  /// Factor for the wheel speeds of robot `id` whose packet is encoded with the stated gains.
  [[nodiscard]] std::array<float, 2> correction_of(RobotId id) const;
  /// Writes all that is in force and not as stated.
  void write(DriveCorrections& out) const;

 private:
  struct Robot {
    RobotDrive drive;
    DriveEstimator estimator;
    Instant seen{}, touched{}, commanded{};  // last sighting, possible contact, and command that moves
    WheelSpeeds sent;                        // last ones
    bool has_commands = false;
  };

  [[nodiscard]] Robot* robot_of(RobotId id, Instant now);
  [[nodiscard]] const Robot* robot_of(RobotId id) const;
  [[nodiscard]] bool may_touch(const RobotTrack& robot, const Tracks& tracks) const;
  void restart(Robot& robot, RobotId id);
  [[nodiscard]] bool is_complete() const;
  void report(Robot& robot);
  void publish();
  void combine(MeasuredValue RobotDrive::*member, double sigma_needed, ComparedValue& out) const;

  StatedDrives stated_;
  FixedVector<Robot, kMaxRobotsPerTeam> robots_;
  std::size_t next_ = 0;  // whose record is processed
  int tries_ = 0;         // passes of this robot in a row
  DriveEstimate first_;   // of the robot that ended its search first
  DriveReports reports_;
};

}  // namespace touchline
