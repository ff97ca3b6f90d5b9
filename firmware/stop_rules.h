#pragma once

#include <cstdint>
#include <optional>

#include "core/time.h"
#include "hal/gpio.h"

namespace touchline {

/// Reasons for which robots are stopped; bits.
enum Halt : std::uint16_t {
  kHaltNone = 0,
  kHaltNoFrames = 1,          // the last good frame is older than faults.stop_after_s
  kHaltEmergency = 2,         // the emergency stop is pulled, or was pulled and has not been reset
  kHaltUnreadableLine = 4,    // the emergency stop cannot be read, which counts as pulled
  kHaltStart = 8,             // the start button has not been pressed yet
  kHaltCrash = 16,            // the previous run ended unexpectedly while robots were driven
  kHaltReferee = 32,          // the referee stopped the game
  kHaltTeams = 64,            // the referee demands team colors or heights that cannot be used
  kHaltSilence = 128,         // a requested referee was never heard, or one that repeats its messages is silent
  kHaltConsole = 256,         // a client of the console stopped the robots
  kHaltSetup = 512,           // the board is being set up: it is not calibrated, or a draft of its files is in use
  kHaltSetupEnded = 1 << 10,  // explains kHaltConsole: nobody stopped the robots, the setup was saved or left
  kHaltRadio = 1 << 14,       // the radio is away, or was away for longer than faults.radio_outage_s
  kHaltDriver = 1 << 15,      // the driver of the console was silent
};

constexpr std::uint16_t kExternalHalts =
    kHaltReferee | kHaltTeams | kHaltSilence | kHaltConsole | kHaltSetup | kHaltSetupEnded;

/// What a session hands to the next one: the reasons that hold until a start.
struct HeldStops {
  std::uint16_t reasons = kHaltNone;  // bits of Halt
  std::uint32_t number = 0;           // see StopRules::held_number()
  bool is_started = false;            // the board has a start button, and it was pressed
};

struct StopRuleSettings {
  Duration stop_after{};                // robots stop when the last good frame is older
  Duration radio_outage{};              // after a longer one a start is needed
  bool resume_after_emergency = false;  // on release of the emergency stop; else a start is needed
  bool has_emergency_stop = true;
  bool has_start_button = false;
  HeldStops held{};  // of the previous session; kHaltCrash: the previous run ended unexpectedly
};

/// Decides when robots must stand still: no fresh frame, emergency stop, start button, crash of the previous run,
/// radio, referee, console. No I/O and no clock: time and inputs are arguments, so the same calls give the same
/// answers.
///
/// Robots may move only while halt() is kHaltNone. A reason lasts as long as its cause, or it is held until a start:
/// the start button, or Start of the console's driver. Both call start().
class StopRules {
 public:
  /// An emergency ends only after the line has been inactive for this time. The contacts of a switch bounce for some
  /// milliseconds, and nobody releases a switch and pulls it again within a tenth of a second.
  static constexpr Duration kEmergencyReleaseTime = std::chrono::milliseconds(100);

  explicit StopRules(const StopRuleSettings& settings);

  /// What holds now is not released by other settings.
  void set_limits(Duration stop_after, Duration radio_outage, bool resume_after_emergency);

  /// Applies the input lines as read at `now`. nullopt: they cannot be read, which counts as a pulled emergency stop if
  /// there is one.
  void apply_inputs(const std::optional<hal::GpioInputs>& inputs, Instant now);
  /// `reasons`: the bits of kExternalHalts that hold.
  void apply_external(std::uint16_t reasons);
  /// `away`: since when the radio has been lost; nullopt: it is open.
  void apply_radio(std::optional<Duration> away);
  /// `reason` holds from the first call with `cause` true until a start while `cause` is false.
  void hold(Halt reason, bool cause);
  /// A person starts the robots. Ends the held reasons whose cause is gone.
  void start() { held_ &= causes_; }
  /// Call it before a frame is processed: commands computed from an old frame must not drive robots.
  void check_frame(Instant capture_time, Instant now) { set(kHaltNoFrames, is_stale(capture_time, now)); }
  /// Call it after a frame was processed successfully. A capture time later than `now` counts as `now`, because a wrong
  /// stamp must not keep robots moving.
  void accept_frame(Instant capture_time, Instant now);
  /// Checks the age of the last good frame.
  void check_last_frame(Instant now) { set(kHaltNoFrames, !last_good_ || is_stale(*last_good_, now)); }

  /// Bits of Halt.
  [[nodiscard]] std::uint16_t halt() const;
  [[nodiscard]] bool may_move() const { return halt() == kHaltNone; }
  /// Whether only the start (button or restart) is missing.
  [[nodiscard]] bool only_waits_for_start() const {
    return !is_started() && (halt() & ~(kHaltStart | kHaltCrash)) == 0;
  }
  /// Whether the start button was pressed, or there is none.
  [[nodiscard]] bool is_started() const { return (held_ & kHaltStart) == 0; }
  /// Changes when something begins to hold robots until a start, and when its cause comes back or ends. A start from
  /// elsewhere that was meant for another number came too late.
  [[nodiscard]] std::uint32_t held_number() const { return held_number_; }
  /// Whether a start is needed.
  [[nodiscard]] bool is_held() const { return held_ != kHaltNone; }
  /// For the next session. An emergency that is not over is among the reasons.
  [[nodiscard]] HeldStops held() const;

 private:
  [[nodiscard]] bool is_stale(Instant capture_time, Instant now) const {
    return now - capture_time > settings_.stop_after;
  }
  void set(std::uint16_t reason, bool holds);

  StopRuleSettings settings_;
  std::uint16_t lasting_ = kHaltNoFrames;  // as long as their causes
  std::uint16_t held_;                     // until a start
  std::uint16_t causes_ = kHaltNone;       // of held reasons: present
  std::uint32_t held_number_;
  std::optional<Instant> last_good_;  // capture time; none: there has been no good frame
  bool emergency_ = false;            // pulled, or released a moment ago
  bool is_readable_ = true;
  Instant emergency_seen_{};
};

}  // namespace touchline
