#pragma once

#include "core/supervision/motion_check.h"
#include "core/supervision/repeat_detector.h"
#include "core/supervision/track_jump.h"
#include "core/types.h"

namespace touchline {

struct PictureCheckSettings {
  Duration oldest = std::chrono::milliseconds(200);  // largest age of a picture with which robots may drive
  int unusable_frames = 5;                           // see Persistence
};

/// A condition of single frames that must persist. It begins when frames with it exceed frames without it by `frames`,
/// and ends after as many frames without it. A flickering picture therefore neither stops robots nor lets them go.
class Persistence {
 public:
  bool update(bool holds, int frames) {
    count_ = holds ? count_ + 1 : count_ - 1;
    if (count_ >= frames) {
      count_ = frames;
      is_lasting_ = true;
    } else if (count_ <= 0) {
      count_ = 0;
      is_lasting_ = false;
    }
    return is_lasting_;
  }
  [[nodiscard]] bool is_lasting() const { return is_lasting_; }

 private:
  int count_ = 0;
  bool is_lasting_ = false;
};

/// Decides whether a picture can show the present: it does not repeat an earlier one, the step could process it, it
/// shows the field, and its robots move as commanded. The object is large (fixed memory).
class PictureCheck {
 public:
  struct Geometry {
    PixelFormat format = PixelFormat::kRgb24;
    std::uint16_t width_px = 0, height_px = 0;
    double wheel_base_m = 0.07, wheel_lag_s = 0.08;  // values of the own robots
  };
  void configure(const Geometry& geometry);
  void set(const PictureCheckSettings& settings) { settings_ = settings; }
  /// Trusts the picture again, because a person has started the robots.
  void acknowledge();
  /// Forgets what robots did before, because tracks begin anew.
  void restart();

  /// Checks a frame after its sightings were found and before they are fused. `trace`: the trace of this frame, with
  /// the tracks and commands of the previous frame; its member `picture` is written. `field_share`: share of the field
  /// that looks as it did when the colors were learned, except for the light; negative: not measured. `twist_of`: as in
  /// MotionCheck::check().
  template <class TwistOf>
  void check(StepTrace& trace, float field_share, TwistOf twist_of) {
    begin(trace, field_share);
    const MotionCheck::Result motion = motion_.check(trace.sightings, trace.frame.capture_time, twist_of);
    finish(trace, motion);
  }

 private:
  void begin(StepTrace& trace, float field_share);
  void finish(StepTrace& trace, const MotionCheck::Result& motion);

  PictureCheckSettings settings_;
  RepeatDetector repeats_;
  TrackJump jump_;
  MotionCheck motion_;
  Persistence repeated_, overload_, hidden_field_;
  int overload_frames_ = 0;
};

}  // namespace touchline
