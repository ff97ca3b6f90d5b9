#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tools/programs/calibrate/colors/color_assignment.h"

namespace touchline::calibrate {

/// Linear light, 0 to 1 in each channel.
using Linear = std::array<double, 3>;

/// `rgb`: values from 0 to 255; others are clipped.
Linear linear(const Rgb& rgb);

/// Appearance of a color in the light of most robots.
struct Look {
  Linear color{};
  double sigma = 0;  ///< standard deviation of the logarithm of each channel; 0: unknown
  /// A camera's color matrix makes some channels of saturated paints negative. The camera delivers black for them, and
  /// a little glare does not change that.
  std::array<bool, 3> at_black{};

  [[nodiscard]] bool is_known() const { return sigma > 0; }
  ///< Returns whether the color was seen in a picture; otherwise it is known at most by its name.
  [[nodiscard]] bool was_seen() const;
};

/// Return the appearance of a color from the typical value of its patches, and of a color that is known only by its
/// name.
Look seen_look(const Rgb& rgb);
Look named_look(const Rgb& rgb);

/// Light on a robot: a factor, and added glare. Each patch may have a little more or less glare.
struct RobotLight {
  double gain = 1, glare = 0;
};

/// Cost of an explanation, in nats: negative log-likelihood up to a constant.
struct PatchLight {
  double cost = 0, glare = 0;
};

/// A patch of a robot: the color that it should have, and its color in the picture.
struct ShownPatch {
  Look look;
  Linear seen{};
};

/// The largest values that the camera shows.
struct Brightness {
  double white = 1;  ///< linear value at which the camera clips
  double most = 0;   ///< largest channel of the colors that patches have; slightly below it a channel may be clipped
};

/// Explains a patch in the light of its robot, with the glare that explains it best.
PatchLight explain(const ShownPatch& patch, const RobotLight& light, const Brightness& brightness);

struct FittedLight {
  RobotLight light;
  double cost = 0;  ///< as PatchLight::cost, for the whole robot
};

/// Finds the light that explains the patches of a robot best. Robots in shade have down to a quarter of the light;
/// glare is at most 0.3 of white.
FittedLight fit_light(const std::vector<ShownPatch>& patches, const Brightness& brightness);

/// Returns whether this light, or the glare on one of the patches, differs so much from that of other robots that no
/// color should be learned from the patches.
bool is_odd(const RobotLight& light, const std::vector<ShownPatch>& patches, const Brightness& brightness);

/// Removes the effect of a robot's light from the values of one of its patches.
class LightRemoval {
 public:
  /// Indices of the results for the least, the mean and the largest glare that the robot's other patches show.
  static constexpr std::size_t kCount = 3, kMean = 1;

  /// `others`: the robot's patches of other colors.
  LightRemoval(const RobotLight& light, const std::vector<ShownPatch>& others, const Brightness& brightness);

  /// Returns what `rgb` would be in the light of other robots. A channel that may be clipped may have any larger value.
  /// `which`: 0 to kCount - 1.
  [[nodiscard]] Rgb without_light(const Rgb& rgb, std::size_t which) const;

 private:
  double gain_;
  Brightness brightness_;
  std::array<double, kCount> glare_{};
};

}  // namespace touchline::calibrate
