#pragma once

#include <string>
#include <vector>

#include "tools/programs/calibrate/colors/color_assignment.h"
#include "tools/programs/calibrate/imaging/channel_image.h"

namespace touchline::calibrate {

/// Pixels of one patch differ from its mean color by less than this (noise and shade), as color_distance(); two patches
/// differ by more.
inline constexpr double kOneColor = 24.0;

/// Returns the pixels of the patch and those that continue it: connected, and of its median color. A place that a
/// layout predicts is only the inner part of a patch, and real patches are larger than a layout says. Empty if the
/// color continues beyond three times the radius of `pixels`, because then it is also that of the surroundings.
std::vector<std::size_t> continue_patch(const ChannelImage& image, const std::vector<std::uint8_t>& inside,
                                        const std::vector<std::size_t>& pixels);

/// The picture that patches were found in.
struct PatchPicture {
  const ChannelImage& image;
  const std::vector<std::uint8_t>& inside;
};

/// How much longer the patches of recognized robots are than their layout says: the median of the ratios.
struct PatchScale {
  double ratio = 1;
  std::size_t patches = 0;
};

/// `pictures`: in the order of AssignmentInput::picture.
std::array<PatchScale, 2> patch_scales(const AssignmentInput& input, const Assignment& assignment,
                                       const std::vector<PatchPicture>& pictures, const CameraModel& camera);

/// A line for each team whose patches differ from the layout by more than hand-cut ones do; empty: none.
std::string describe_scales(const std::array<PatchScale, 2>& scales);

}  // namespace touchline::calibrate
