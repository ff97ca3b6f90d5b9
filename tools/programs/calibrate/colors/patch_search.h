#pragma once

#include <vector>

#include "core/geometry/camera_model.h"
#include "core/geometry/field_area.h"
#include "core/marker/marker_layout.h"
#include "core/marker/matcher.h"
#include "tools/programs/calibrate/colors/color_names.h"
#include "tools/programs/calibrate/colors/region_growing.h"
#include "tools/programs/calibrate/imaging/channel_image.h"
#include "tools/programs/calibrate/imaging/local_background.h"

namespace touchline::calibrate {

/// Size of an object of one color to search for: a patch of a layout, or the ball.
struct PatchSize {
  double area_m2 = 0;
  double height_m = 0;  // height above the floor
  double extent_m = 0;  // largest diameter
};

/// A region of one color with the size of a patch.
struct FoundPatch {
  double u_px = 0, v_px = 0;  // seed of the region's growth
  int radius_px = 0;          // limit of the region's growth
  PixelPoint center;
  std::vector<std::size_t> pixels;  // indices into ChannelImage::pixels
  Rgb rgb{};                        // median color
  Lab lab;
  double instability = 0;  // as in GrownPatch
  bool sampled = false;    // a sample at a place that a layout predicts (complete_markers), not a grown region
  double elongation = 1;   // ratio of the standard deviations along the principal axes; 1 for a square and a disk
  // Colors that the pixels would have in usual light, to which `rgb` and `lab` refer; empty: the pixels' own colors.
  std::vector<Channels> usual = {};
};

/// Capacity for the patches of two complete teams and the ball, four times over for clutter.
inline constexpr std::size_t kPatchesOfTwoTeams = kMaxRobots * kMaxPatches + 1,
                             kMaxFoundPatches = 4 * kPatchesOfTwoTeams;

/// Finds patches without clicks. Grows a region (grow_region) from each even spot that differs from the local
/// background. Keeps it if its area is 0.35 to 1.7 times the projected area of one of the sizes; this range allows for
/// shade, blur and the dark side of a ball. `inside`: see inside_mask(); pixels outside the field and its margin are
/// ignored. Other objects of these sizes (white dots, logos) are found as well; color and arrangement have to exclude
/// them. If there are more than kMaxFoundPatches, the patches are kept that differ most from the floor and have the
/// rarest colors.
std::vector<FoundPatch> find_patches(const ChannelImage& image, const std::vector<std::uint8_t>& inside,
                                     const LocalBackground& floor, const CameraModel& camera,
                                     const FieldParameters& field, const std::vector<PatchSize>& sizes);

/// Returns whether a color is neither the floor's nor that of a shadow or a robot's dark body on it.
bool differs_from_floor(const Channels& color, const Channels& floor, ColorSpace space);

/// Makes a patch of a region that was grown from `from` with this limit of growth.
FoundPatch patch_of(const ChannelImage& image, PixelPoint from, int radius_px, GrownPatch grown);

/// Returns the limit of growth at this pixel, which is a little more than the largest of the sizes.
int growth_radius_px(PixelPoint at, const CameraModel& camera, const std::vector<PatchSize>& sizes);

/// Returns whether the area fits one of the sizes.
bool has_size_of_a_patch(const FoundPatch& patch, const CameraModel& camera, const std::vector<PatchSize>& sizes);

/// Returns the ratio of the patch's area to the projected area of the size.
double relative_area(const FoundPatch& patch, const CameraModel& camera, const PatchSize& size);

constexpr double kMinRelativeArea = 0.35, kMaxRelativeArea = 1.7;

PatchSize size_of(const PatchPlace& place, const MarkerLayout& layout);
PatchSize size_of(const BallParameters& ball);

}  // namespace touchline::calibrate
