#pragma once

#include <string>
#include <vector>

#include "tools/programs/calibrate/colors/color_assignment.h"
#include "tools/programs/calibrate/imaging/channel_image.h"

namespace touchline::calibrate {

/// Largest color_distance() of a patch's pixels from the patch's mean color, by noise and shade; two patches differ by
/// more.
inline constexpr double kOneColor = 24.0;

/// Returns the pixels of the patch and the connected pixels that have its median color. A sampled place is only the
/// inner part of a patch, and real patches are larger than their layout says. Empty if the color continues beyond three
/// times the radius of `pixels`, because then the surroundings have the same color.
std::vector<std::size_t> continue_patch(const ChannelImage& image, const std::vector<std::uint8_t>& inside,
                                        const std::vector<std::size_t>& pixels);

/// A picture and the patches that were found in it.
struct PatchPicture {
  const ChannelImage& image;
  const std::vector<std::uint8_t>& inside;
};

/// Factor by which the patches of recognized robots are longer than in their layout: the median of the ratios.
struct PatchScale {
  double ratio = 1;
  std::size_t patches = 0;
};

/// `pictures`: in the order of AssignmentInput::picture.
std::array<PatchScale, 2> patch_scales(const AssignmentInput& input, const Assignment& assignment,
                                       const std::vector<PatchPicture>& pictures, const CameraModel& camera);

/// Returns a line for each team whose patches differ from the layout by more than patches cut by hand do; empty if
/// there is none.
std::string describe_scales(const std::array<PatchScale, 2>& scales);

}  // namespace touchline::calibrate
