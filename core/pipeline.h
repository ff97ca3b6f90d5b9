#pragma once

#include "core/adaptation.h"
#include "core/control/controller.h"
#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "core/radio/packet.h"
#include "core/radio/telemetry.h"
#include "core/region/region_scanner.h"
#include "core/subpixel/ball_center_fit.h"
#include "core/subpixel/patch_center_fit.h"
#include "core/supervision/picture_check.h"
#include "core/track/tracker.h"
#include "core/types.h"

namespace touchline {

struct PipelineParameters {
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

/// The referee's assignment of colors and sides to the teams.
struct TeamAssignment {
  bool colors_exchanged = false;    // each team has the team color of the other one
  bool sides_exchanged = false;     // the own team defends the half with positive x
  std::array<float, 2> height_m{};  // height of the markers, by Team; 0: as configured

  friend bool operator==(const TeamAssignment&, const TeamAssignment&) = default;
};

/// Processes a frame from the camera to the radio packet. The object is large (fixed memory); do not put it on the
/// stack.
class Pipeline {
 public:
  /// Clock for StepTrace::stage_time. If null, the times stay zero.
  using StageClock = Instant (*)();

  Status configure(const PipelineParameters& parameters, StageClock clock = nullptr);

  /// Sets the time from the capture of a frame until its commands act: the measured loop latency plus the delay of
  /// radio and robots. Range 0 to 1 s.
  void set_action_delay(Duration delay) { action_delay_ = delay; }
  /// Sets how much later than the action delay the commands of a receiver act (a robot by its index, or kAllRobots,
  /// which has no effect), because the packets of other robots take the line first.
  void set_lateness(std::size_t receiver, Duration lateness) {
    if (receiver < radio_.receivers.size()) tracker_.set_lateness(radio_.receivers[receiver].id, lateness);
  }
  /// While true, stop commands replace the controller's output.
  void set_halted(bool halted) { halted_ = halted; }
  /// While true, the commands are not sent (a replay, or robots that another program drives), so the filters treat the
  /// robots' commands as unknown.
  void set_observing(bool observing) { observing_ = observing; }

  /// Sets the limits of the checks whose results are in StepTrace::picture.
  void set_picture_check(const PictureCheckSettings& settings) { picture_check_.set(settings); }
  /// Trusts the picture again, because a person has started the robots (PictureCheck::acknowledge()).
  void acknowledge_picture() { picture_check_.acknowledge(); }

  /// Processes one frame. The trace is valid until the next call. For a frame of another format or size, the trace is
  /// empty and has an error in `status`.
  const StepTrace& step(const Frame& frame);

  /// Adapts to the light, using the sightings of the last step(), whose frame must still be valid. Call it after the
  /// packet was sent, because nothing depends on it. Writes to the trace of this step.
  void adapt() { adaptation_.update(scanner_, trace_); }
  /// Copies the tables that decided the classes of the last step's pixels, about 0.5 MB. Call it before adapt().
  void copy_classifier(PixelClassifier& out) const { scanner_.copy_to(out); }
  void set_adaptation(AdaptationMode mode) { adaptation_.set_mode(mode); }
  [[nodiscard]] AdaptationMode adaptation() const { return adaptation_.mode(); }

  /// Decodes telemetry from the bytes that the radio received until `now`, and updates StepTrace::reports.
  void listen(std::span<const std::byte> bytes, Instant now) { monitor_.listen(bytes, now, trace_.reports); }
  [[nodiscard]] const RobotReports& reports() const { return trace_.reports; }

  /// Replaces thresholds, light map and region of interest by those of `tables`, and restarts the adaptation with the
  /// configuration of `adaptation`. Tracks and game continue. Call it between two frames. For `tables` and the return
  /// value see RegionScanner::exchange. Copies about 100 kB.
  ScanTables& exchange(ScanTables& tables, const Adaptation& adaptation) {
    adaptation_ = adaptation;
    matcher_.set_typical_colors(adaptation.typical_colors());
    return scanner_.exchange(tables);
  }
  /// Changes control parameters between two frames. Errors as Controller::set_parameters.
  Status set_control(const ControlParameters& parameters) {
    Status status = controller_.set_parameters(parameters);
    if (status.ok()) radio_.wheel_base_m = parameters.drive.wheel_base_m;
    return status;
  }

  /// Sets the commands of other programs, as Controller::set_external.
  void set_external(const ExternalCommands& commands, Instant now) { controller_.set_external(commands, now); }
  /// Changes team colors, sides and marker heights between two frames. New team colors reset tracks and game. Positions
  /// remain in the venue's coordinates. kOutOfRange: a height is not allowed. kInconsistent: the colors cannot be
  /// exchanged, because a team has no color, or its color has another meaning. After an error nothing has changed.
  Status assign_teams(const TeamAssignment& assignment);

  /// Creates packets that stop all robots, for times without a frame. They act after the action delay, counted from
  /// `now`. Valid until the next call.
  const OutgoingPackets& stop(Instant now);
  /// Writes packets that stop all robots into `out`, for a program that ends before it can call stop(). Nothing else
  /// changes.
  void prepare_stop(Instant now, OutgoingPackets& out) const;
  /// Returns whether each step has packets: the layout has fields, and robots if each gets a packet of its own.
  [[nodiscard]] bool has_receivers() const {
    return !radio_.fields.empty() && !(radio_.one_each && radio_.receivers.empty());
  }
  /// Returns the layout of the packets.
  [[nodiscard]] const PacketLayout& radio() const { return radio_; }
  /// Sends the layout's bytes for the start before the next packets. Call it after the radio was opened.
  void on_radio_opened();
  /// Replaces the last step's commands by a stop, in its trace and with its packets' sequence number. Call it if the
  /// robots must stop before the step's packet was sent.
  void revoke();
  /// Resets tracks and game. Call it after a long gap, for example when the camera was reopened.
  void reset();

 private:
  // Radio links lose packets: with 3 % of loss, all three are lost once in 40,000 times.
  static constexpr int kStarts = 3;

  void check_picture();
  void stop_from(Instant now);
  void encode_commands(Instant now);

  RegionScanner scanner_;
  CameraModel camera_;
  Matcher matcher_;
  PatchCenterFit patch_center_fit_;
  BallCenterFit ball_center_fit_;
  Tracker tracker_;
  Controller controller_;
  TeamMarkings teams_;  // markers as configured
  TeamAssignment assignment_;
  Adaptation adaptation_;
  RobotMonitor monitor_;
  PictureCheck picture_check_;
  StageClock clock_ = nullptr;
  Duration action_delay_{};
  bool halted_ = false, observing_ = false;
  std::uint32_t packet_sequence_ = 0;
  PacketLayout radio_;
  int starts_left_ = kStarts;  // packets that get the bytes for the start
  Instant last_start_{};
  StepTrace trace_;
};

}  // namespace touchline
