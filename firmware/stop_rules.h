#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "core/time.h"
#include "core/types.h"
#include "hal/gpio.h"

namespace touchline {

/// Reasons for which robots are stopped; bits.
enum Halt : std::uint32_t {
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
  kHaltRepeats = 1 << 10,     // the camera delivers pictures that it has delivered before, as a whole or in a part
  kHaltOverload = 1 << 11,    // pictures exceed what a step can process, frame after frame
  kHaltField = 1 << 12,       // the field is not recognizable: dark, covered, or something else is shown
  kHaltMotion = 1 << 13,      // robots do not move as commanded
  kHaltRadio = 1 << 14,       // the radio is disconnected, or was for longer than faults.radio_outage_s
  kHaltDriver = 1 << 15,      // the driver of the console was silent
  kHaltSetupEnded = 1 << 16,  // explains kHaltConsole: nobody stopped the robots, the setup was saved or left
  kHaltEnd,                   // no reason: the highest bit plus 1. New bits stand above this line, in ascending order
};

constexpr std::uint32_t kExternalHalts =
    kHaltReferee | kHaltTeams | kHaltSilence | kHaltConsole | kHaltSetup | kHaltSetupEnded;

/// Reasons that follow from StepTrace::picture.
constexpr std::uint32_t kPictureHalts = kHaltRepeats | kHaltOverload | kHaltField | kHaltMotion;

/// Describes a reason to a person. Robots get stop packets while any reason holds.
struct HaltDescription {
  Halt bit;
  std::string_view word;     // word in messages of the console
  std::string_view reason;   // text in the status line and the event log
  std::string_view robots;   // what the robots do until they stop
  std::string_view ends_by;  // what ends the reason
};
/// Descriptions in the order in which the status line lists the reasons.
inline constexpr std::array kHaltDescriptions{
    HaltDescription{kHaltNoFrames, "no_frames", "no good frame",
                    "drive on with their last commands for faults.stop_after_s", "the next good frame"},
    HaltDescription{kHaltRepeats, "repeats", "the camera repeats its pictures",
                    "drive on for faults.stop_after_s (or what this camera usually repeats, if that is longer)",
                    "pictures that are new everywhere; if a part of them showed delayed pictures, a start"},
    HaltDescription{kHaltOverload, "overload", "too many colored regions in the picture",
                    "drive on for faults.unusable_frames", "as many frames without overload"},
    HaltDescription{kHaltField, "field", "the field is not recognizable", "drive on for faults.unusable_frames",
                    "as many frames that show the field"},
    HaltDescription{kHaltMotion, "motion", "robots do not move as commanded",
                    "drive on for two frames if everything is seen elsewhere at once, else for about a second",
                    "a start (the start button, or Start of the page)"},
    HaltDescription{kHaltEmergency, "emergency", "emergency stop", "stop at once",
                    "its release and a start; with faults.resume_after_emergency = true the release alone"},
    HaltDescription{kHaltUnreadableLine, "unreadable_line", "emergency stop cannot be read", "stop at once",
                    "a line that can be read and is not pulled, and a start as after an emergency stop"},
    HaltDescription{kHaltStart, "start", "waiting for the start button", "stand",
                    "a start (the start button, or Start of the page)"},
    HaltDescription{kHaltReferee, "referee", "the referee stopped the game", "stop at once", "the referee"},
    HaltDescription{kHaltSilence, "silence", "no message from the referee", "drive on for faults.referee_timeout_s",
                    "the next message of the referee"},
    HaltDescription{kHaltConsole, "console", "stopped from the console", "stop at once", "Start of the page"},
    HaltDescription{kHaltRadio, "radio", "the radio is disconnected, or was for too long",
                    "get no packets, and stop by their own time-out",
                    "the radio; after an outage longer than faults.radio_outage_s also a start"},
    HaltDescription{kHaltDriver, "driver", "the page with control stopped answering", "drive on for a second",
                    "a start"},
    HaltDescription{kHaltSetupEnded, "setup_ended", "the setup has ended, press Start on the page", "stand",
                    "Start of the page"},
    HaltDescription{kHaltSetup, "setup", "the board is being set up (page Set up of the console)", "stop at once",
                    "saving or discarding the draft on the page Set up"},
    HaltDescription{kHaltTeams, "teams", "the referee's team colors or heights do not fit the team file",
                    "stop at once", "colors and heights that fit, from the referee or in the team file"},
    HaltDescription{kHaltCrash, "crash", "the previous run ended unexpectedly", "stand",
                    "a start (the start button, or Start of the page), or a restart of the service"},
};

// Every bit is described exactly once.
static_assert([] {
  std::uint32_t described = kHaltNone;
  for (const HaltDescription& halt : kHaltDescriptions) {
    if (!std::has_single_bit(static_cast<std::uint32_t>(halt.bit)) || (described & halt.bit) != 0) return false;
    described |= halt.bit;
  }
  return described == 2 * (kHaltEnd - 1) - 1;
}());

/// Reasons that hold until a start. A session passes them to the next one.
struct HeldStops {
  std::uint32_t reasons = kHaltNone;  // bits of Halt
  std::uint32_t number = 0;           // as in StopRules::held_number()
  bool is_started = false;            // the board has a start button, and it was pressed
};

struct StopRuleSettings {
  Duration stop_after{};                // robots stop when the last good frame is older than this
  Duration radio_outage{};              // after a longer outage a start is needed
  bool resume_after_emergency = false;  // resume when the emergency stop is released; otherwise a start is needed
  bool has_emergency_stop = true;
  bool has_start_button = false;
  HeldStops held{};  // stops of the previous session; kHaltCrash: the previous run ended unexpectedly
};

/// Decides when robots must stand still: no fresh frame, emergency stop, start button, crash of the previous run,
/// radio, referee, console. The class uses no I/O and no clock: time and inputs are arguments, so the same calls give
/// the same results.
///
/// Robots may move only while halt() is kHaltNone. A reason lasts as long as its cause, or it is held until a start:
/// the start button, or Start of the console's driver. Both call start().
class StopRules {
 public:
  /// Time for which the line must be inactive before an emergency ends. The contacts of a switch bounce for some
  /// milliseconds, and nobody releases a switch and pulls it again within a tenth of a second.
  static constexpr Duration kEmergencyReleaseTime = std::chrono::milliseconds(100);

  explicit StopRules(const StopRuleSettings& settings);

  /// Changes the limits. New limits do not release robots that are held now.
  void set_limits(Duration stop_after, Duration radio_outage, bool resume_after_emergency);

  /// Applies the input lines as read at `now`. nullopt means that they cannot be read, which counts as a pulled
  /// emergency stop if there is one.
  void apply_inputs(const std::optional<hal::GpioInputs>& inputs, Instant now);
  /// `reasons`: the bits of kExternalHalts that hold.
  void apply_external(std::uint32_t reasons);
  /// `away`: time since the radio was lost; nullopt: it is open.
  void apply_radio(std::optional<Duration> away);
  /// Holds `reason` from the first call with `cause` true until a start while `cause` is false.
  void hold(Halt reason, bool cause);
  /// Starts the robots for a person: ends the held reasons whose cause no longer exists.
  void start();
  /// Returns whether somebody has started the robots since the last call.
  [[nodiscard]] bool take_start() { return std::exchange(was_started_, false); }
  /// Applies the check of the last frame's picture. Two reasons hold until a start, because they cannot be checked
  /// while robots stand: motion that contradicts the commands, and an older picture that went on in a part.
  void apply_picture(const PictureTrace& picture);
  /// Call it before a frame is processed: commands computed from an old frame must not drive robots.
  void check_frame(Instant capture_time, Instant now) { set(kHaltNoFrames, is_stale(capture_time, now)); }
  /// Call it after a frame was processed successfully. A capture time later than `now` counts as `now`, because a wrong
  /// stamp must not keep robots moving.
  void accept_frame(Instant capture_time, Instant now);
  /// Checks the age of the last good frame.
  void check_last_frame(Instant now) { set(kHaltNoFrames, !last_good_ || is_stale(*last_good_, now)); }

  /// Returns the bits of Halt.
  [[nodiscard]] std::uint32_t halt() const;
  [[nodiscard]] bool may_move() const { return halt() == kHaltNone; }
  /// Returns whether only the start (button or restart) is missing.
  [[nodiscard]] bool only_waits_for_start() const {
    return !is_started() && (halt() & ~(kHaltStart | kHaltCrash)) == 0;
  }
  /// Returns whether the start button was pressed, or there is none.
  [[nodiscard]] bool is_started() const { return (held_ & kHaltStart) == 0; }
  /// Returns a number that changes when a reason begins to hold robots until a start, and when the cause of the reason
  /// comes back or ends. A start of the console that names another number came too late and has no effect.
  [[nodiscard]] std::uint32_t held_number() const { return held_number_; }
  /// Returns whether a start is needed.
  [[nodiscard]] bool is_held() const { return held_ != kHaltNone; }
  /// Returns the stops that the next session takes over. An emergency stop that has not ended is one of them.
  [[nodiscard]] HeldStops held() const;

 private:
  [[nodiscard]] bool is_stale(Instant capture_time, Instant now) const {
    return now - capture_time > settings_.stop_after;
  }
  void set(std::uint32_t reason, bool holds);

  StopRuleSettings settings_;
  std::uint32_t lasting_ = kHaltNoFrames;  // reasons that hold as long as their causes
  std::uint32_t held_;                     // reasons that hold until a start
  std::uint32_t causes_ = kHaltNone;       // causes of held reasons that are present
  std::uint32_t held_number_;
  std::optional<Instant> last_good_;  // capture time of the last good frame; nullopt: there was none
  bool emergency_ = false;            // the switch is pulled, or was released a moment ago
  bool is_readable_ = true;
  Instant emergency_seen_{};
  bool was_started_ = false;  // for take_start()
};

}  // namespace touchline
