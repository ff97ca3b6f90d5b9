#pragma once

#include <type_traits>

#include "core/adaptation.h"
#include "core/control/controller.h"
#include "core/geometry/camera_model.h"
#include "core/identification/drive_monitor.h"
#include "core/marker/matcher.h"
#include "core/radio/packet.h"
#include "core/radio/telemetry.h"
#include "core/region/region_scanner.h"
#include "core/step_inputs.h"
#include "core/subpixel/ball_center_fit.h"
#include "core/subpixel/missed_robots.h"
#include "core/subpixel/top_fit.h"
#include "core/supervision/picture_check.h"
#include "core/track/tracker.h"
#include "core/types.h"

namespace touchline {

struct PipelineParameters {
  // False: each frame has the sightings of another source (Frame::sightings). Then scan, camera, adaptation and what
  // `marker` says of patches have no meaning, and frames with a picture are refused.
  bool has_pictures = true;
  ScanParameters scan;
  CameraParameters camera;
  MarkerParameters marker;
  TrackParameters track;
  ControlParameters control;
  AdaptationParameters adaptation;
  float low_battery_v = 0.0f;  // a battery below this voltage is low; 0: never
  PacketLayout radio = touchline_layout();
  PacketLayout telemetry = touchline_telemetry_layout();
};

/// Processes a frame from the camera to the radio packet. The object is large (fixed memory); do not put it on the
/// stack.
class Pipeline {
 public:
  /// Clock for StepTrace::stage_time. If null, the times stay zero.
  using StageClock = Instant (*)();

  /// Replaces the built-in play, see Controller::set_strategy(). Call it before configure().
  void set_strategy(Strategy* strategy) { controller_.set_strategy(strategy); }

  Status configure(const PipelineParameters& parameters, StageClock clock = nullptr);

  /// Processes one frame, a picture or the sightings of another source, with everything else that the step depends on.
  /// The trace is valid until the next call. For a frame of another format or size, the trace is empty and has an error
  /// in `status`.
  const StepTrace& step(const Frame& frame, const StepInputs& inputs = {});
  /// Creates packets that stop all robots, for times without a frame. They act after the action delay, counted from
  /// `inputs.now`. Valid until the next call.
  const OutgoingPackets& stop(const StepInputs& inputs);

  /// Adapts to the light and measures the drives, using the sightings and commands of the last step(), whose frame must
  /// still be valid. Call it after the packet was sent, because nothing depends on it before the next step. Writes to
  /// the trace of this step.
  void adapt();
  /// Returns the commands as the last packets carry them: those of the trace, with the wheels' measured gains
  /// (DriveMonitor) and within max_wheel_speed_mps; before own.robot.wheel_gain divides them.
  [[nodiscard]] const Commands& sent_commands() const { return sent_; }
  /// Copies the tables that decided the classes of the last step's pixels, about 0.5 MB. Call it before adapt().
  void copy_classifier(PixelClassifier& out) const { scanner_.copy_to(out); }
  [[nodiscard]] AdaptationMode adaptation() const { return adaptation_.mode(); }
  [[nodiscard]] const RobotReports& reports() const { return trace_.reports; }
  /// Returns what the measured drives changed in the last call, for StepInputs::drives.
  [[nodiscard]] const DriveCorrections& drive_corrections() const { return drive_corrections_; }
  /// Returns the tables that the last call no longer uses, because its inputs contained new ones; null: there were
  /// none.
  [[nodiscard]] ScanTables* released_tables() const { return released_tables_; }

  /// Checks an assignment for StepInputs::teams. kOutOfRange: a height is not allowed. kInconsistent: the colors cannot
  /// be exchanged, because a team has no color, or its color has another meaning.
  [[nodiscard]] Status check_teams(const TeamAssignment& assignment) const;

  /// Writes packets that stop all robots into `out`, for a program that ends before it can call stop(). Nothing else
  /// changes.
  void prepare_stop(Instant now, OutgoingPackets& out) const;
  /// Returns whether each step has packets: the layout has fields, and robots if each gets a packet of its own.
  [[nodiscard]] bool has_receivers() const {
    return !radio_.fields.empty() && !(radio_.one_each && radio_.receivers.empty());
  }
  /// Returns the layout of the packets.
  [[nodiscard]] const PacketLayout& radio() const { return radio_; }
  /// Replaces the last step's commands by a stop, in its trace and with its packets' sequence number. Call it if the
  /// robots must stop before the step's packet was sent. StepTrace::revoked tells a recording.
  void revoke();

  /// Passes to `archive` all that tracks, commands and packets of the next steps depend on, beside configuration and
  /// inputs. Three things are left out. What recognition and picture checks have learned: the next frames must have
  /// sightings, and their inputs `was_unusable`. The measurements of the drives (1 MB): the inputs must have `drives`.
  /// And a strategy of set_strategy(). Call it after adapt(), or after a stop.
  /// `self` is constant if the archive writes. An archive that reads gets a pipeline with the same configuration, and
  /// its refuse() is called for values that are not possible; then the pipeline cannot be used any more.
  /// `archive(members...)` calls visit_state() of each member that is a class with this function.
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    TeamAssignment assignment = self.assignment_;
    archive(assignment);
    if constexpr (!std::is_const_v<Self>) {
      if (!self.assign_teams(assignment).ok()) return archive.refuse();
    }
    archive(self.tracker_, self.controller_, self.is_unusable_, self.packet_sequence_, self.starts_left_,
            self.last_start_);
    if constexpr (!std::is_const_v<Self>) {
      if (self.starts_left_ < 0 || self.starts_left_ > kStarts) archive.refuse();
    }
  }

 private:
  // Radio links lose packets: with 3 % of loss, all three are lost once in 40,000 times.
  static constexpr int kStarts = 3;

  class StageTimer;
  [[nodiscard]] StageTimer timer(Stage stage);
  void apply(const StepInputs& inputs);
  // Finds sightings in the picture.
  void recognize(const Frame& frame);
  // Takes the sightings of a source that recognizes robots and ball itself.
  void adopt(const Sightings& sightings);
  void listen(const StepEvents& events);
  Status configure_recognition(const PipelineParameters& parameters);
  Status assign_teams(const TeamAssignment& assignment);
  Status teams_of(const TeamAssignment& assignment, TeamMarkings& out) const;
  void reset();
  void check_picture();
  void stop_from(Instant now);
  // Uses this time constant of the wheels from now on.
  void use_lag(double lag_s);
  void correct_commands();
  void encode_commands(Instant now);

  RegionScanner scanner_;
  CameraModel camera_;
  Matcher matcher_;
  TopFit top_fit_;
  MissedRobots missed_robots_;
  ExpectedRobots expected_robots_;
  BallCenterFit ball_center_fit_;
  Tracker tracker_;
  RobotFilterParameters robot_filter_;  // of the track parameters
  Controller controller_;
  TeamMarkings teams_;  // markers as configured
  TeamAssignment assignment_;
  Adaptation adaptation_;
  RobotMonitor monitor_;
  DriveMonitor drives_;
  DriveCorrections drive_corrections_;  // in force
  ControlParameters control_;           // as configured
  PictureCheck picture_check_;
  bool is_unusable_ = false;  // the last picture
  StageClock clock_ = nullptr;
  StepInputs inputs_;  // of the last call
  ScanTables* released_tables_ = nullptr;
  std::uint32_t packet_sequence_ = 0;
  PacketLayout radio_;
  bool has_pictures_ = true;
  int starts_left_ = kStarts;  // packets that get the bytes for the start
  Instant last_start_{};
  Commands sent_;
  StepTrace trace_;
};

}  // namespace touchline
