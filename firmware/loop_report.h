#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/adaptation.h"
#include "core/control/referee_state.h"
#include "core/fixed_vector.h"
#include "core/status.h"
#include "core/time.h"
#include "core/types.h"
#include "firmware/fault_policy.h"
#include "firmware/stop_rules.h"
#include "hal/spsc_ring.h"

// Messages from the loop to the thread that prints: values of fixed size, because formatting text takes time.
namespace touchline {

enum class Device : std::uint8_t { kCamera, kRadio, kGpio };
inline constexpr std::array kDevices{Device::kCamera, Device::kRadio, Device::kGpio};
inline constexpr std::size_t kDeviceCount = kDevices.size();
using DeviceFlags = std::array<bool, kDeviceCount>;  // flag by Device
const char* describe(Device device) noexcept;

struct SeenRobot {
  Team team = Team::kOwn;
  RobotId id = kUnknownId;
  bool coasting = false;
  Pose pose;
};

/// Last telemetry of a robot.
struct RobotStatus {
  RobotId id = kUnknownId;
  float battery_v = 0.0f;                   // 0: not measured
  std::int8_t link_percent = kLinkUnknown;  // percentage of our packets that the robot received recently
  double age_s = 0.0;
  bool battery_low = false;
  std::optional<WheelSpeeds> wheels{};  // as its encoders measure them
};

// Maximum length of an error text; longer texts are cut off.
inline constexpr std::size_t kMaxReasonBytes = 240;

/// Text of fixed size, which may be cut off.
class ReasonText {
 public:
  void set(std::string_view text);
  /// Ends with a zero byte.
  [[nodiscard]] const char* c_str() const { return bytes_.data(); }
  [[nodiscard]] std::string_view view() const { return bytes_.data(); }
  [[nodiscard]] bool empty() const { return bytes_[0] == '\0'; }

 private:
  std::array<char, kMaxReasonBytes> bytes_{};
};

/// Status of the game, sent once per interval.
struct StatusReport {
  double elapsed_s = 0.0;
  double rate_hz = 0.0;  // rate of good frames over the interval
  std::uint32_t own_seen = 0, opponents_seen = 0;
  bool ball_seen = false;
  FieldPoint ball;
  Duration p50{}, p99{}, max{};  // capture to send, over the interval
  std::uint64_t packets = 0;     // counted since the start, like all counts below
  std::uint64_t packets_dropped = 0, packets_refused = 0, stop_packets = 0, frames_lost = 0, future_stamps = 0,
                overloads = 0, faults = 0, packets_ignored = 0;  // the last: of a source of poses
  std::optional<Score> score;                                    // nullopt: neither a referee nor an arena tells it
  bool own_on_positive_half = false;                             // if true, the own team plays towards negative x
  std::uint64_t commands_expired = 0;  // times that a robot stopped because its external command was too old
  std::uint32_t halt = kHaltNone;
  std::uint32_t stop_number = 0;  // ExternalInput::stop_number()
  AdaptationMode adaptation = AdaptationMode::kFollow;
  std::array<ReasonText, kDeviceCount> lost;  // by Device: reason why it cannot be used; "": it is open
  PictureTrace picture{};                     // picture check of the last frame
  float brightness = 1.0f;                    // brightness of the light relative to the calibration
  FixedVector<SeenRobot, kMaxRobots> robots;
  FixedVector<RobotStatus, kMaxRobotsPerTeam> robot_status;
  DriveReports drives;  // measured while the robots drove
};

/// Reports the first failure of a device with this code in an interval (while the device is lost, also only once per
/// reason), or that the device was reopened (code kOk).
struct FaultReport {
  double elapsed_s = 0.0;
  Device device = Device::kCamera;
  ErrorCode code = ErrorCode::kOk;
  FaultAction action = FaultAction::kNone;
  ReasonText reason;
};

/// Reports that robots were stopped or may move again, or that the number of the stop has changed while they stay
/// stopped.
struct HaltReport {
  double elapsed_s = 0.0;
  std::uint32_t halt = kHaltNone, before = kHaltNone;
  std::uint32_t stop_number = 0;
  PictureTrace picture{};  // picture check of the last frame
};

/// Warns that all robots have begun to stand although they are commanded to move.
struct StandingReport {
  double elapsed_s = 0.0;
  int robots = 0;
};

/// Reports that a robot's battery has become low.
struct BatteryReport {
  double elapsed_s = 0.0;
  RobotId id = kUnknownId;
  float battery_v = 0.0f;
};

/// Warns that the drives contradict the files. `robot`: whose gains these are; kUnknownId: the team's delay or lag.
struct DriveReport {
  double elapsed_s = 0.0;
  enum class Value : std::uint8_t { kDelay, kLag, kGain } value = Value::kDelay;
  RobotId robot = kUnknownId;
  std::array<ComparedValue, 2> compared;  // of both wheels; a delay or lag is the first one
};

struct Report {
  enum class Kind : std::uint8_t { kStatus, kFault, kHalt, kBattery, kStanding, kDrive } kind = Kind::kStatus;
  StatusReport status;
  FaultReport fault;
  HaltReport halt;
  BatteryReport battery;
  StandingReport standing;
  DriveReport drive;
};

// Holds one minute of status reports while the terminal is blocked.
using ReportRing = SpscRing<Report, 64>;

}  // namespace touchline
