#pragma once

#include <vector>

#include "core/geometry/camera_model.h"
#include "core/geometry/field_area.h"
#include "core/marker/marker_layout.h"
#include "core/marker/matcher.h"
#include "tools/programs/calibrate/channel_image.h"
#include "tools/programs/calibrate/color_names.h"

namespace touchline::calibrate {

/// A thing of one color that is looked for: a patch of a layout, or the ball.
struct PatchSize {
  double area_m2 = 0;
  double height_m = 0;  // above the floor
  double extent_m = 0;  // largest diameter
};

/// A surface of one color that has a patch's size.
struct FoundPatch {
  double u_px = 0, v_px = 0;  // where it was grown from
  int radius_px = 0;          // how far it could have grown
  PixelPoint center;
  std::vector<std::size_t> pixels;  // indices into ChannelImage::pixels
  Rgb rgb{};                        // median
  Lab lab;
  double instability = 0;  // as of GrownPatch
  double elongation = 1;   // ratio of its spreads along the principal axes, 1 for a square and a disk
};

/// Patches without a click: from every even spot that differs from the floor around it, a region is grown as from a
/// click (grow_patch), and kept when its area is that of one of the sizes as the camera sees it there (from 0.35 to 1.7
/// of it: shade, blur and a ball's dark side). `inside` as of inside_mask(); pixels outside of the field and its margin
/// are left out. What else has such a size (white dots, logos) is found as well; colors and places have to tell.
std::vector<FoundPatch> find_patches(const ChannelImage& image, const std::vector<std::uint8_t>& inside,
                                     const CameraModel& camera, const FieldParameters& field,
                                     const std::vector<PatchSize>& sizes);

/// Share of the size's area, as the camera sees it there, that the patch has.
double relative_area(const FoundPatch& patch, const CameraModel& camera, const PatchSize& size);

constexpr double kLeastRelativeArea = 0.35, kMostRelativeArea = 1.7;

PatchSize size_of(const PatchPlace& place, const MarkerLayout& layout);
PatchSize size_of(const BallParameters& ball);

}  // namespace touchline::calibrate
