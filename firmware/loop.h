#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "core/pipeline.h"
#include "firmware/adaptation_requests.h"
#include "firmware/board_outputs.h"
#include "firmware/config/board_file.h"
#include "firmware/crash_stop.h"
#include "firmware/external_input.h"
#include "firmware/frame_gaps.h"
#include "firmware/latency_estimate.h"
#include "firmware/live_update.h"
#include "firmware/loop_devices.h"
#include "firmware/loop_heartbeat.h"
#include "firmware/loop_report.h"
#include "firmware/loop_statistics.h"
#include "firmware/picture_exchange.h"
#include "firmware/recording/step_tap.h"
#include "firmware/report_writer.h"
#include "firmware/snapshot_ring.h"
#include "firmware/stop_rules.h"

namespace touchline {

/// Reads the score from a simulation that counts goals. Called on the loop's thread.
struct ScoreSource {
  Score (*read)(void* context) = nullptr;  // null: no score is counted
  void* context = nullptr;
};

/// Reads when robots of a simulation were put elsewhere for the last time, on the loop's clock. Called on the loop's
/// thread.
struct JumpSource {
  Instant (*read)(void* context) = nullptr;  // null: robots only drive
  void* context = nullptr;
};

struct LoopSettings {
  config::FaultSettings faults;
  Duration radio_delay{};    // time from the last byte sent until the wheels react
  hal::LineTime radio_line;  // of the slowest radio
  Duration status_interval = std::chrono::seconds(1);
  std::uint64_t frames = 0;                        // ends after this number of frames; 0: no limit
  Duration duration{};                             // ends after this time; 0: no limit
  const AdaptationRequests* adaptation = nullptr;  // requests to freeze or reset the adaptation; null: none
  bool telemetry = true;                           // receive telemetry from the robots
  bool start_button = false;   // the board has a start button; robots are stopped until it is pressed
  bool emergency_stop = true;  // the board has an emergency stop; robots are stopped while it cannot be read
  HeldStops held{};            // stops of the previous session or run that persist until a start
  const std::atomic<bool>* restart = nullptr;  // ends the loop with kRestart when true; null: never
  // Devices that may be absent at the start. If one of them cannot be opened, the loop starts nevertheless, and robots
  // stand until it is open. When an awaited camera opens, the loop ends with kRestart, because the users of its
  // pictures have to learn their format.
  DeviceFlags awaited{};
  // Pauses of the former session, whose restart found the awaited device open. If it cannot be opened now, the pauses
  // go on growing from these.
  LoopDevices::Pauses former_pauses{};
  std::uint64_t first_number = 0;     // number of the first frame's snapshot
  LiveUpdate* live_update = nullptr;  // new settings while the loop runs; null: none
  ExternalInputSettings external;
  SnapshotRing* snapshots = nullptr;        // gets a snapshot of every frame; null: no snapshots are made
  PictureExchange* pictures = nullptr;      // requests single pictures; null: no pictures are requested
  recording::StepTap* recording = nullptr;  // gets every step with its inputs; null: nothing is recorded
  ScoreSource score;                        // used if no referee tells the score
  JumpSource jumps;                         // of a simulation
};

/// Times of one frame.
struct StepTiming {
  Instant received{}, sent{};  // times on the loop's clock
  Duration processing{};       // from `received` to `sent`, always on the machine's clock
  Duration latency{};          // from capture to `sent`; in simulated time, the part up to `received` is simulated
};

/// Functions that are called on the loop's thread; null: not called.
struct LoopObserver {
  // Called after each step, while the frame's pixels are still valid. It delays the next frame.
  void (*on_step)(void* context, const StepTrace& trace, const StepTiming& timing) = nullptr;
  void* context = nullptr;
  // Called immediately before StepTiming::received and after StepTiming::sent. These calls delay the frame's packet and
  // the next frame.
  void (*on_received)(void* context) = nullptr;
  void (*on_sent)(void* context) = nullptr;
  // Called after each Pipeline::stop(), which needs no frame.
  void (*on_stop)(void* context, const StepInputs& inputs) = nullptr;
};

enum class LoopEnd : std::uint8_t {
  kRequested,    // the stop flag was set
  kRestart,      // LoopSettings::restart was set, or an awaited camera is there
  kLimit,        // frames or duration reached
  kEndOfStream,  // a replayed input has ended
  kDeviceLost,   // a device was lost for longer than faults.leave_after_s
  kFault,        // an error that reopening cannot fix
};

/// The real-time loop: takes each frame through the pipeline and sends its packet. Between open() and close() the
/// calling thread allocates, prints and formats nothing; reports for a person go into the ring.
///
/// StopRules decides when robots must stand still. While they must, every packet is a stop packet, and stop packets are
/// sent without frames too. The input lines are read before each wait for a frame, at least once per frame period or
/// every 50 ms. They are read again before the packet of a frame is sent. While a line is being debounced, the wait
/// ends when its new level is stable.
///
/// A lost camera, radio or emergency stop is reopened. The game continues without status light and strobe, and on a
/// board without an emergency stop also without the whole GPIO chip; this is reported once.
///
/// The status light blinks once a second while robots may move and five times a second while they are stopped; it stays
/// on while everything waits for the start button. If the loop hangs, the light does not change.
class Loop {
 public:
  /// All references must outlive the loop.
  Loop(const HalDevices& devices, Pipeline& pipeline, const LoopSettings& settings, ReportRing& reports,
       LoopObserver observer = {});
  /// Calls close().
  ~Loop();
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  /// Opens radio, GPIO and camera, in this order. The error text names the device and the cause. A device of
  /// LoopSettings::awaited causes no error.
  Result<void> open();
  /// Iterates until one of the reasons in LoopEnd, then sends the final stop packets, also before an exception leaves
  /// this function. Call it after open().
  LoopEnd run(const std::atomic<bool>& stop);
  /// One iteration of run(): waits for a frame or the next due action, whichever comes first.
  std::optional<LoopEnd> iterate();
  /// Sends several stop packets with pauses and waits until the radio has sent them. run() calls it at its end.
  void send_final_stops();
  /// Closes the devices; before that, sends the final stop packets if other packets followed the last ones.
  void close();

  [[nodiscard]] const LoopStatistics& statistics() const { return statistics_; }
  /// Shows a watchdog that the loop runs; callable from any thread.
  [[nodiscard]] const LoopHeartbeat& heartbeat() const { return heartbeat_; }
  [[nodiscard]] bool is_open(Device device) const { return devices_.is_open(device); }
  /// Returns the value for LoopSettings::former_pauses of the next session.
  [[nodiscard]] LoopDevices::Pauses pauses() const { return devices_.pauses(); }
  /// Returns the bits of Halt.
  [[nodiscard]] std::uint32_t halt() const { return rules_.halt(); }
  /// Returns the stops that the next session takes over.
  [[nodiscard]] HeldStops held() const { return rules_.held(); }
  /// Returns the error that led to kFault or kDeviceLost.
  [[nodiscard]] const FaultReport& last_fault() const { return reports_.last_fault(); }

 private:
  // The parts of an iteration, in this order.
  void check_inputs(Instant now);
  void serve_radio(Instant now);
  void wait_for_frame(Instant deadline);
  void stop_if_due(Instant now);
  void receive_telemetry(Instant now);
  void reopen_lost_devices(Instant now);
  void update_status_light(Instant now);
  void take_external_input(Instant now);
  void note_live_settings();
  void update_end(Instant now);

  // The parts of a frame.
  void process_frame(const hal::FrameLease& lease);
  void measure_latency(const Frame& frame, const StepTiming& timing);
  void adapt_to_light();
  /// Completes `inputs_` before a step or a stop. Events are noted there when they happen.
  void fill_inputs(Instant now, Duration action_delay);
  /// Clears the events after a step or a stop has used them.
  void on_inputs_used(Instant now);
  void fill_snapshot(const StepTrace& trace, const hal::FrameLease& lease, const StepTiming& timing,
                     Instant machine_sent);
  // Begins tracks anew with the first frame that shows robots of a simulation elsewhere.
  void note_jump(const Frame& frame);
  /// Returns the score of the referee, or of a simulation that counts goals.
  [[nodiscard]] std::optional<Score> score() const;

  void read_inputs(Instant now);
  void check_radio(Instant now);
  /// Returns how long the radio, or a port of it, has been lost; nullopt: it is open.
  [[nodiscard]] std::optional<Duration> radio_away(Instant now) const;
  void report_radio_ports(Instant now);
  void acknowledge_start();
  void send(const OutgoingPackets& packets, bool is_stop, Instant now);
  void note_times_on_line(const OutgoingPackets& packets);
  /// Prepares the packets that stop all robots if the process crashes now.
  void prepare_crash_stop(Instant now);
  void send_stop(Instant now);
  void on_reopened(Device device, Instant now);
  /// Returns whether the program ends because the device is lost for so long.
  [[nodiscard]] bool is_lost_for_good(Device device, Duration away) const;
  void on_fault(Device device, const Error& error, Instant now);
  // Reports an error of the strobe or the status light; `result` is that of setting it.
  void check_output(const Result<void>& result, Instant now);
  void report_fault(Device device, const Error& error, FaultAction action, Instant now);
  void set_faults(const config::FaultSettings& faults);
  [[nodiscard]] bool is_required(Device device) const { return device != Device::kGpio || settings_.emergency_stop; }
  [[nodiscard]] FaultAction reopening_action(Device device) const {
    return is_awaited(device) ? FaultAction::kReopen : FaultAction::kContinueWithout;
  }
  // Returns whether robots wait for the device. Until the start button is pressed, they also wait for its chip.
  [[nodiscard]] bool is_awaited(Device device) const { return is_required(device) || !rules_.is_started(); }

  Pipeline& pipeline_;
  StepInputs inputs_;  // of the last or the next step
  LoopSettings settings_;
  LoopObserver observer_;
  LoopDevices devices_;
  BoardOutputs outputs_;
  StopRules rules_;
  ExternalInput external_;
  ReportWriter reports_;
  LoopStatistics statistics_;
  LoopHeartbeat heartbeat_;
  std::optional<LoopEnd> end_;

  Duration poll_period_{};              // longest wait for a frame
  Duration input_due_{}, radio_due_{};  // due times of an input line and the radio, before the next frame
  Instant last_frame_{};                // arrival of the last frame, good or not
  Instant last_packet_{};
  std::optional<Instant> last_jump_;  // JumpSource as the last frame with a jump found it
  Duration packet_time_{};            // time of the last frame's first packet on the radio's line
  DeviceFlags was_open_{};            // since open()
  bool needs_final_stops_ = false;    // packets were sent since the last final stop packets
  OutgoingPackets stop_packets_;
  FrameGaps frame_gaps_;
  LatencyEstimate latency_;
  AdaptationRequestReader adaptation_requests_;
  Snapshot snapshot_;  // too large for the stack
};

}  // namespace touchline
