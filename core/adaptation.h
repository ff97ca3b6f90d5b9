#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/color/box_shift.h"
#include "core/color/typical_colors.h"
#include "core/light/expected_gain.h"
#include "core/light/field_light.h"
#include "core/light/light_change.h"
#include "core/parameter.h"
#include "core/region/region_scanner.h"
#include "core/types.h"

namespace touchline {

enum class AdaptationMode : std::uint8_t {
  kOff,     // as calibrated; adapted values are reset
  kFollow,  // light map and color boxes follow the light
  kFrozen   // light map and color boxes keep their current values
};
inline constexpr std::array<Choice<AdaptationMode>, 3> kAdaptationModes{
    {{"off", AdaptationMode::kOff}, {"follow", AdaptationMode::kFollow}, {"frozen", AdaptationMode::kFrozen}}};

struct AdaptationParameters {
  AdaptationMode mode = AdaptationMode::kFollow;
  double time_constant_s = 10.0;
  double max_light = 2.0;
  double max_shift = 10.0;
  // Not a key of the venue file's section; the matcher uses it, too.
  TypicalColors typical;
  LightReference reference;  // key light.reference; no reference if its number of columns is 0

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(self.mode, kAdaptationModes,
                 {.name = "mode", .help = "Whether light map and color boxes follow slow changes of the light"});
    visit.number(self.time_constant_s, {.name = "time_constant_s",
                                        .range = {0.5, 3600.0},
                                        .unit = "s",
                                        .help = "Time constant of the light map; color boxes take four times as long"});
    visit.number(self.max_light, {.name = "max_light",
                                  .range = {1.01, 4.0},
                                  .help = "Largest factor by which the light may become brighter or darker"});
    visit.number(self.max_shift, {.name = "max_shift",
                                  .range = {0.0, 40.0},
                                  .help = "Largest shift of a color's boxes, in levels of each channel"});
  }
};

/// Adapts to changes of the light (future work in Klancar's section 8), in two ways. FieldLight measures steps, tints
/// and shadows from the field itself, before the frame is classified. (In YUV, a tint of the whole field moves the
/// boxes.) What remains is learned slowly, and only from certain sightings: a ball that agrees with its track, and the
/// patches of robots whose id is certain in this frame (confidence 0.9, shown by their own patches) and over time
/// (confidence 0.998 of the track). A change that is common to all patches in a neighborhood corrects the light map. A
/// change of a single color that is left moves this color's boxes, four times more slowly. Both are bounded. The object
/// is large (fixed memory); do not put it on the stack.
class Adaptation {
 public:
  /// kOutOfRange: as LightChange and BoxShift. kInconsistent: as FieldLight.
  Status configure(const AdaptationParameters& parameters, const ScanParameters& scan, ColorId ball_color);
  /// kOff restores the calibrated values within a few hundred frames.
  void set_mode(AdaptationMode mode);
  [[nodiscard]] AdaptationMode mode() const { return mode_; }
  [[nodiscard]] const TypicalColors& typical_colors() const { return typical_; }

  /// Measures the light of a frame and updates the scanner's tables before it scans the frame: tiles, and in YUV after
  /// a step of the tint up to 384 tables (1 ms). A frame that the scanner does not accept has no effect.
  void measure(const Frame& frame, RegionScanner& scanner);
  /// Returns the light that measure() found, for the same scanner; unknown unless the adaptation follows the light.
  /// Valid until the next call of a function that is not const.
  [[nodiscard]] ExpectedGain expected_gain(const RegionScanner& scanner) const;
  /// Returns FieldLight::recognized() of the last measured frame; negative unless the adaptation follows the light.
  [[nodiscard]] float recognized_field() const {
    return mode_ == AdaptationMode::kFollow ? field_.recognized() : -1.0f;
  }
  /// Learns from a frame whose pixels are still valid, and updates a part of the scanner's tables. The time is bounded:
  /// nine pixels per patch, some rows of tiles, two tables. Writes trace.light.
  void update(RegionScanner& scanner, StepTrace& trace);

 private:
  struct Sample {
    std::array<float, 3> mean{};
    std::array<bool, 3> saturated{};
  };
  // Finds the mean of the 3 x 3 pixels around the point. Returns false at the picture's edge, or if the pixels are not
  // uniform.
  static bool sample_at(const Frame& frame, const PixelPoint& center, Sample& out);
  void learn(const Shading& shading, StepTrace& trace, float step);
  bool learn_patch(const Shading& shading, const Frame& frame, const PatchSighting& patch, float step);
  void learn_color(const Shading& shading, ColorSpace space, ColorId color, const PixelPoint& center,
                   const Sample& sample, float step);
  void follow_tint(RegionScanner& scanner);
  void apply(RegionScanner& scanner);

  AdaptationMode mode_ = AdaptationMode::kOff;
  float time_constant_s_ = 0;
  ColorSpace space_ = ColorSpace::kRgb;
  TypicalColors typical_;
  ColorId ball_color_ = kBackground;
  FieldLight field_;
  LightChange light_;
  BoxShift shift_;
  Instant last_{};
  ColorBoxes target_;     // boxes of the scanner, after all tables are rebuilt
  bool changed_ = false;  // whether boxes have changed since they were last compared
  std::uint16_t next_row_ = 0, rows_due_ = 0;
  std::uint32_t next_table_ = 0;
};

}  // namespace touchline
