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
  float low_battery_v = 0.0f;  // below it a robot's battery is low; 0: never
};

/// The way of one frame, camera to packet. Large (fixed memory): make one, not on the stack.
class Pipeline {
 public:
  /// Reads a clock for StepTrace::stage_time; null: times stay zero.
  using StageClock = Instant (*)();

  Status configure(const PipelineParameters& parameters, StageClock clock = nullptr);

  /// From now on commands act this long after the capture of the frame they were computed from: measured loop latency
  /// and the radio's and robots' delay. Range 0 to 1 s.
  void set_action_delay(Duration delay) { action_delay_ = delay; }
  /// The controller's output is replaced by stop commands while true.
  void set_halted(bool halted) { halted_ = halted; }
  /// While true nobody sends what the controller decides (a replay; robots driven by others), so that the filters take
  /// the robots' commands for unknown.
  void set_observing(bool observing) { observing_ = observing; }

  /// The trace is valid until the next call. Never fails: a frame of another format or size gives an empty trace whose
  /// `status` says so.
  const StepTrace& step(const Frame& frame);

  /// Follows the light by what the last step() saw, whose frame must still be there. Nothing waits for it: to be called
  /// when the packet is on its way. Adds to that step's trace.
  void adapt() { adaptation_.update(scanner_, trace_); }
  void set_adaptation(AdaptationMode mode) { adaptation_.set_mode(mode); }
  [[nodiscard]] AdaptationMode adaptation() const { return adaptation_.mode(); }

  /// Bytes that the radio received until `now`, whatever they are: StepTrace::reports tells what robots said in them.
  void listen(std::span<const std::byte> bytes, Instant now) { monitor_.listen(bytes, now, trace_.reports); }
  [[nodiscard]] const RobotReports& reports() const { return trace_.reports; }

  /// Between two frames: thresholds, light map and region of interest are those of `tables` from the next frame on, and
  /// the adaptation begins anew as `adaptation` is configured; tracks and play go on. For `tables` and the answer see
  /// RegionScanner::exchange. Copies some hundred bytes.
  ScanTables& exchange(ScanTables& tables, const Adaptation& adaptation) {
    adaptation_ = adaptation;
    return scanner_.exchange(tables);
  }
  /// Between two frames; errors as Controller::retune.
  Status retune(const ControlParameters& parameters) { return controller_.retune(parameters); }

  /// A packet that halts all robots, for when there is no frame to step; it acts after the action delay, counted from
  /// `now`. Valid until the next call.
  const Packet& stop(Instant now);
  /// Puts a stop in the place of the last step's commands, in its trace and under its packet's number, as if it had
  /// been halted: for when robots must be halted before that packet was sent.
  void revoke();
  /// Forgets tracks and play: after a gap as long as a camera that was opened again, the robots may be anywhere.
  void reset();

 private:
  void stop_from(Instant acts_at);
  void encode_commands();

  RegionScanner scanner_;
  CameraModel camera_;
  Matcher matcher_;
  PatchCenterFit patch_center_fit_;
  BallCenterFit ball_center_fit_;
  Tracker tracker_;
  Controller controller_;
  Adaptation adaptation_;
  RobotMonitor monitor_;
  StageClock clock_ = nullptr;
  Duration action_delay_{};
  bool halted_ = false, observing_ = false;
  std::uint8_t packet_sequence_ = 0;
  StepTrace trace_;
};

}  // namespace touchline
