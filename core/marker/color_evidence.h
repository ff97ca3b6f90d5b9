#pragma once

#include <array>

#include "core/color/typical_colors.h"
#include "core/light/expected_gain.h"
#include "core/marker/border_color.h"
#include "core/marker/marker_layout.h"
#include "core/marker/simd4.h"
#include "core/marker/surface_color.h"
#include "core/types.h"

namespace touchline {

/// Light on a robot relative to that at calibration, as a factor of pixel values per channel.
struct LocalLight {
  std::array<float, 3> gain{};
  // Variance of its logarithm: independent part, and part common to all channels.
  std::array<float, 3> variance{}, common_variance{};
  // Variance of the logarithm of the ratio of two paints, relative to the ratio at calibration.
  float ratio_variance = 0;
  float glare = 0;  // share of the lamps' light that the team patch mirrors, in linear light
};

/// Expected R, G, B of a paint in some light, with relative errors.
struct ExpectedColor {
  std::array<float, 3> rgb{}, white{};              // color of the paint, and of a white surface
  std::array<float, 3> variance{}, common_sigma{};  // independent error, and error common to all channels
};
/// Four expected colors, one in each lane.
struct ExpectedColors4 {
  std::array<Simd4<float>, 3> rgb{}, white{}, variance{}, common_sigma{};
  void set(std::size_t lane, const ExpectedColor& color);
};

/// Prior of the light on a robot, before its team patch is measured.
struct LightPrior {
  std::array<float, 3> gain{1, 1, 1};
  // Standard deviations of the gain's logarithm: common to all channels, and of each channel.
  float common_sigma = 1.0f, tint_sigma = 0.3f;
};

/// Returns the prior of the light on a robot at a place of the picture from that of the field around it.
LightPrior expected_light(const ExpectedGain& light, PixelPoint at);

/// Returns the light on a robot of which nothing but the prior is known.
LocalLight light_around(const LightPrior& prior);

/// The border of a robot's patch, and the light on this robot.
struct BorderOfRobot {
  BorderColor border;
  LocalLight light;
};

/// Compares the pixels of a robot's identification patches with the colors that they may have. All patches of a robot
/// are under the same light, so its team patch shows how the other colors look in it: the ratio of two colors hardly
/// depends on lamps, exposure and light map. In YUV, pixel values are converted to RGB first (ITU-R BT.601).
class ColorEvidence {
 public:
  /// Log likelihood of a surface that has none of the venue's colors: a robot's top, the floor, a hand.
  static constexpr float kNoColor = -3.0f;
  /// Lower limit of a color's log likelihood, because a robot's own patch may be covered or reflect a lamp. One patch
  /// at this limit costs more than a patch of the right color gains, so a robot that is not in the team file gets no
  /// id.
  static constexpr float kFloor = kNoColor - 8.0f;

  void configure(const TypicalColors& typical);

  /// Returns true if the typical value of the color was measured.
  [[nodiscard]] bool knows(ColorId color) const { return typical_.measured[color]; }

  /// Returns true if the typical values of all colors of a team with an id were measured. Other teams are not named.
  [[nodiscard]] bool can_name(const TeamMarking& team) const;

  /// Returns the typical value of a color as R, G, B above black.
  [[nodiscard]] const std::array<float, 3>& typical_rgb(ColorId color, ColorSpace space) const {
    return rgb_[static_cast<std::size_t>(space)][color];
  }

  /// Estimates the light on a team patch of this color. An uninformative channel (too dark, saturated) follows the
  /// other channels and the prior. A channel that is dark in this color shows whether the patch mirrors a lamp.
  [[nodiscard]] LocalLight light_on(const SurfaceColor& seen_patch, ColorId team_color, ColorSpace space,
                                    const LightPrior& prior) const;

  /// Returns the log likelihood of the surface's color under the hypothesis that it is the same surface as `other`, a
  /// few centimeters away.
  static float log_likelihood_of_same(const SurfaceColor& surface, const SurfaceColor& other);

  [[nodiscard]] ExpectedColor expected_color(const LocalLight& light, ColorId color, ColorSpace space) const;

  /// Returns the log likelihoods of the surface for four colors. `glare` is that of LocalLight. `in_box`: -1 if the
  /// surface's region has the color's class, else 0. A surface may be whiter than its color, because it mirrors a lamp,
  /// only if it is in the box or the team patch mirrors a lamp, too: otherwise any gray surface might be a dark paint.
  [[nodiscard]] static Simd4<float> log_likelihoods(const SurfaceColor& surface, const ExpectedColors4& expected,
                                                    float glare, Simd4<std::int32_t> in_box);

  /// Returns the log likelihood ratio of the border of a patch with saturated pixels: the patch has `color` in this
  /// light, or it has none of the venue's colors. Only the ratios of channels count.
  [[nodiscard]] float log_likelihood_of_border(const BorderColor& border, const LocalLight& light, ColorId color,
                                               ColorSpace space) const;

  /// Returns the log likelihood ratio of the borders of two robots' patches: `a` and `b` have these colors, or they
  /// have the exchanged ones. Common errors of all saturated patches in a picture cancel: a tint that saturated team
  /// patches do not show, and the contrast of borders, which clipping before demosaicing reduces and clipping after
  /// demosaicing increases.
  [[nodiscard]] float log_likelihood_of_order(const BorderOfRobot& a, ColorId color_of_a, const BorderOfRobot& b,
                                              ColorId color_of_b, ColorSpace space) const;

 private:
  struct BorderDeviation {
    std::array<float, 3> value{}, variance{};
    std::array<float, 3> slope{};  // change per unit of the light's logarithm
  };
  [[nodiscard]] BorderDeviation deviation_of(const BorderColor& border, const LocalLight& light, ColorId color,
                                             ColorSpace space) const;

  TypicalColors typical_;
  // Typical values in R, G, B, by color space.
  std::array<std::array<std::array<float, 3>, kMaxColors + 1>, kColorSpaces.size()> rgb_{};
};

}  // namespace touchline
