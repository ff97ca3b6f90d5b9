#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tools/programs/calibrate/colors/color_assignment.h"

namespace touchline::calibrate {

/// Linear light, 0 to 1 in each channel.
using Linear = std::array<double, 3>;

/// `rgb`: values from 0 to 255, of which others are clipped.
Linear linear(const Rgb& rgb);

/// What a color looks like in the light of most robots.
struct Look {
  Linear color{};
  double sigma = 0;  ///< of the logarithm of each channel; 0: unknown
  /// A camera's color matrix makes channels of saturated paints negative; what it delivers is black, to which glare
  /// adds nothing visible at first.
  std::array<bool, 3> at_black{};

  [[nodiscard]] bool is_known() const { return sigma > 0; }
  [[nodiscard]] bool was_seen() const;  ///< in a picture; else it is at most known by its name
};

/// Of a color that patches have: their typical value, and of one that is known by its name alone.
Look seen_look(const Rgb& rgb);
Look named_look(const Rgb& rgb);

/// The light on a robot: a factor, and glare that is added. Each patch may have a little more or less glare.
struct RobotLight {
  double gain = 1, glare = 0;
};

/// Cost of an explanation, in nats: negative log-likelihood up to a constant.
struct PatchLight {
  double cost = 0, glare = 0;
};

/// A patch of a robot: the color that it should have, and what the picture shows.
struct ShownPatch {
  Look look;
  Linear seen{};
};

/// What the camera shows as its greatest values.
struct Brightness {
  double white = 1;  ///< linear value at which the camera clips
  double most = 0;   ///< greatest channel of the colors that patches have; shortly below it a channel may be clipped
};

/// Explains a patch in the light of its robot, with the glare that explains it best.
PatchLight explain(const ShownPatch& patch, const RobotLight& light, const Brightness& brightness);

struct FittedLight {
  RobotLight light;
  double cost = 0;  ///< as PatchLight::cost, of the whole robot
};

/// The light that explains the patches of a robot best. Robots in shade have down to a quarter of the light; glare is
/// at most 0.3 of white.
FittedLight fit_light(const std::vector<ShownPatch>& patches, const Brightness& brightness);

/// Whether this light, or the glare on one of the patches, differs so much from that on other robots that no color
/// should be learned from its values.
bool is_odd(const RobotLight& light, const std::vector<ShownPatch>& patches, const Brightness& brightness);

/// Takes a robot's light away from the values of one of its patches.
class LightRemoval {
 public:
  /// Results for the least, the mean and the greatest glare that the robot's other patches show.
  static constexpr std::size_t kCount = 3, kMean = 1;

  /// `others`: the robot's patches of other colors.
  LightRemoval(const RobotLight& light, const std::vector<ShownPatch>& others, const Brightness& brightness);

  /// What `rgb` would be in the light of other robots. A channel that may be clipped may have any greater value.
  /// `which`: 0 to kCount - 1.
  [[nodiscard]] Rgb without_light(const Rgb& rgb, std::size_t which) const;

 private:
  double gain_;
  Brightness brightness_;
  std::array<double, kCount> glare_{};
};

}  // namespace touchline::calibrate
