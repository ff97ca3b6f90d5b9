#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "core/pipeline.h"
#include "firmware/config/board_file.h"
#include "firmware/device_reconnector.h"
#include "firmware/live_update.h"
#include "firmware/loop_heartbeat.h"
#include "firmware/loop_report.h"
#include "firmware/loop_statistics.h"
#include "firmware/signals.h"
#include "hal/camera.h"
#include "hal/clock.h"
#include "hal/gpio.h"
#include "hal/radio.h"

namespace touchline {

struct LoopDevices {
  hal::Camera& camera;
  hal::Radio& radio;
  hal::Gpio& gpio;
  hal::Clock& clock;
  bool simulated_time = false;  // the clock stands still while the processor works
};

struct LoopSettings {
  config::FaultSettings faults;
  Duration radio_delay{};  // from the last byte sent to the wheels
  Duration status_interval = std::chrono::seconds(1);
  std::uint64_t frames = 0;                        // end after so many; 0: no limit
  Duration duration{};                             // end after so long; 0: no limit
  const AdaptationRequests* adaptation = nullptr;  // whoever else may steer it; null: nobody
  bool telemetry = true;                           // listens to what robots send back
  bool start_button = false;                       // robots stand until it is pressed
  bool emergency_stop = true;                      // there is one: robots stand while it cannot be read
  LiveUpdate* live_update = nullptr;               // from whoever changes parameters while it runs; null: nobody
};

/// When one frame was where.
struct StepTiming {
  Instant received{}, sent{};  // of the loop's clock
  Duration processing{};       // from `received` to `sent`, always of the machine's clock
  Duration latency{};          // from capture to `sent`; in simulated time its part up to `received` is simulated
};

/// Looks at each step while the frame's pixels are still there; on the loop's thread, so its time counts.
struct LoopObserver {
  void (*on_step)(void* context, const StepTrace& trace, const StepTiming& timing) = nullptr;
  void* context = nullptr;
};

enum class LoopEnd : std::uint8_t {
  kRequested,    // the stop flag was set
  kLimit,        // frames or duration reached
  kEndOfStream,  // a replayed input is over
  kDeviceLost,   // a device stayed away for longer than faults.leave_after_s
  kFault,        // an error that opening again cannot cure
};

/// From frame to packet, again and again. Between open() and close() nothing is allocated, printed or formatted on the
/// calling thread; what a person should know goes into the ring.
///
/// Robots are halted while the last good frame is older than faults.stop_after_s and while the emergency stop is
/// pulled or cannot be read, and before the start button: then every packet is a stop packet, and without frames stop
/// packets are sent all the same. The lines are read before each wait for a frame, so at the latest after one frame's
/// period or 50 ms, and again before the frame's packet is sent; while a line has a new level the wait ends when that
/// has lasted long enough to count.
///
/// A lost camera or radio is opened again, and so is a lost emergency stop. Without light and strobe, and on a board
/// without an emergency stop without the whole chip, the game goes on; that is told once.
///
/// The status light blinks once a second while all is well, five times while robots are halted; it stays on while
/// everything waits for the start button. A loop that hangs leaves it as it is.
class Loop {
 public:
  /// All references must outlive the loop.
  Loop(const LoopDevices& devices, Pipeline& pipeline, const LoopSettings& settings, ReportRing& reports,
       LoopObserver observer = {});
  ~Loop();
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  /// Opens radio, gpio and camera, in this order. On error `reason` says which one and why.
  Status open(std::string& reason);
  /// Until one of LoopEnd's reasons, then sends the stop packets. Only after open().
  LoopEnd run(const std::atomic<bool>& stop);
  /// One turn of run(): waits for a frame, a stop packet's time or a device, whatever comes first.
  std::optional<LoopEnd> iterate();
  /// Stop packets, several and spaced, until they have left the radio. run() ends with it.
  void halt_robots();
  /// Gives the devices back.
  void close();

  [[nodiscard]] const LoopStatistics& statistics() const { return statistics_; }
  /// For a thread that watches; from any thread.
  [[nodiscard]] const LoopHeartbeat& heartbeat() const { return heartbeat_; }
  /// Error that led to kFault or kDeviceLost.
  [[nodiscard]] const FaultReport& last_fault() const { return last_fault_; }

 private:
  void serve_frame(const hal::FrameLease& lease);
  void on_fault(Device device, ErrorCode code, Instant now);
  void on_output_fault(ErrorCode code, Instant now);
  [[nodiscard]] bool is_needed(Device device) const { return device != Device::kGpio || settings_.emergency_stop; }
  // Until the start button is pressed, robots wait for its chip as well.
  [[nodiscard]] bool is_awaited(Device device) const { return is_needed(device) || !started_; }
  void serve_lost_devices(Instant now);
  void send(const Packet& packet, bool is_stop, Instant now);
  void send_stop(Instant now);
  void serve_inputs(Instant now);
  void read_inputs(Instant now);
  void judge_emergency(const hal::GpioInputs& inputs, Instant now);
  void serve_radio(Instant now);
  void listen(Instant now);
  [[nodiscard]] bool outputs_work() { return reconnector(Device::kGpio).is_open() && !outputs_failed_; }
  void strobe(bool high, Instant now);
  void serve_light(Instant now);
  void update_halt(Instant now, Instant last_good);
  void adapt();
  void take_live_settings();
  void set_faults(const config::FaultSettings& faults);
  void note_latency(const Frame& frame, const StepTiming& timing);
  void report_if_due(Instant now);
  void report_batteries(Instant now);
  void report_fault(Device device, ErrorCode code, FaultAction action, Instant now);
  [[nodiscard]] const std::string& reason_of(Device device) const;
  [[nodiscard]] double elapsed_s(Instant now) const { return seconds(now - statistics_.begin); }
  DeviceReconnector& reconnector(Device device) { return *reconnectors_[static_cast<std::size_t>(device)]; }

  LoopDevices devices_;
  Pipeline& pipeline_;
  LoopSettings settings_;
  Duration stop_after_, slice_;
  ReportRing& reports_;
  LoopObserver observer_;
  std::array<std::optional<DeviceReconnector>, kDeviceCount> reconnectors_;
  bool is_open_ = false;
  std::optional<LoopEnd> end_;

  LoopStatistics statistics_;
  LoopHeartbeat heartbeat_;
  FaultReport last_fault_;
  Instant last_good_{};   // capture time
  Instant last_frame_{};  // when any frame came, good or not
  Instant last_packet_{};
  std::optional<std::uint32_t> last_sequence_;
  Duration smoothed_latency_{};
  bool latency_known_ = false;

  std::uint32_t freezes_served_ = 0, put_backs_served_ = 0;

  std::uint8_t halt_ = kHaltNoFrames;
  bool emergency_ = false;
  Instant emergency_seen_{};
  bool started_ = false;                      // the start button was pressed, or there is none
  bool restarted_ = false;                    // likewise, since the last emergency
  Duration look_again_{}, send_again_{};      // when a line or the radio has something to do before the next frame
  std::array<std::byte, 512> received_{};     // 30 frames of it a second are more than 115200 baud bring
  std::array<bool, 128> battery_reported_{};  // by id
  std::optional<bool> led_;
  bool outputs_failed_ = false;  // light or strobe, since the chip was opened

  // For reports, since the last one.
  Instant next_report_{}, last_report_{};
  std::uint64_t good_frames_reported_ = 0;
  LatencyHistogram interval_latency_;
  std::array<std::array<bool, kErrorCodeCount>, kDeviceCount> fault_reported_{};
  bool does_without_reported_ = false;  // since the begin
  std::uint8_t halt_reported_ = kHaltNoFrames;
  const StepTrace* last_trace_ = nullptr;
  Report report_;  // built here and copied into the ring: too large for the stack of a leaf
};

}  // namespace touchline
