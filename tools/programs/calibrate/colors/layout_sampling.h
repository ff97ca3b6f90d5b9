#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "tools/programs/calibrate/colors/marker_search.h"
#include "tools/programs/calibrate/imaging/local_background.h"

namespace touchline::calibrate {

/// The picture that patches are sampled from.
struct SampledPicture {
  const ChannelImage& image;
  const std::vector<std::uint8_t>& inside;  // as returned by inside_mask()
  const LocalBackground& floor;
};

/// A layout and where it is seen.
struct LayoutView {
  const MarkerLayout& layout;
  const CameraModel& camera;
  const SampledPicture& picture;

  /// Maps a pixel to the plane of the patches, m.
  [[nodiscard]] std::complex<double> on_field(PixelPoint pixel) const;
  /// Returns the position tolerance at this point, m, from kCenterError_px and kLayoutError_m.
  [[nodiscard]] double tolerance_m(std::complex<double> at) const;
  /// Returns whether the area of the patch fits this place of the layout.
  [[nodiscard]] bool fits(const FoundPatch& patch, std::size_t place) const;
  /// Returns the headings, in rad, that a robot with this team patch can have: both directions of the long axis of the
  /// team patch, and the headings at which another patch would be one of the identification patches.
  [[nodiscard]] std::vector<double> headings(const std::vector<FoundPatch>& patches,
                                             const std::vector<std::size_t>& numbers, std::size_t team) const;
};

/// Sample of the inner part of a patch's place.
struct PlaceSample {
  std::vector<std::size_t> pixels;
  Channels median{};
  PixelPoint middle;
  int radius_px = 0;    // radius of a circle around the patch
  double even = 0;      // share of the pixels that differ little from the median
  double contrast = 0;  // color distance of the median to the floor
  bool on_top = false;  // true: neither floor nor shadow
};

/// Returns the position of a patch in the robot's frame, m.
std::complex<double> place_of(const PatchPlace& place);

/// Position and heading of a robot.
struct LayoutFit {
  std::complex<double> center{0, 0}, turn{1, 0};  // center in m; turn has length 1 and the heading as angle
  double residual_m = 0;                          // RMS distance between the places and the layout
};

/// Fits a layout to the positions of its patches on the field (least squares in the complex plane). A single patch
/// shows no heading: `turn` is 1.
LayoutFit fit_layout(const MarkerLayout& layout, const std::vector<std::complex<double>>& places);

/// Samples the pixels of the layout's patch with the index `place`. `at`: center of this patch on the field; `turn`:
/// the robot's heading as the angle of a complex number. Returns nullopt if the patch lies outside the picture or the
/// region of interest, or has too few pixels.
std::optional<PlaceSample> sample_place(const LayoutView& view, std::size_t place, std::complex<double> at,
                                        std::complex<double> turn);

/// Makes a patch of a sample (FoundPatch::sampled).
FoundPatch sampled_patch(const ChannelImage& image, PlaceSample sample);

}  // namespace touchline::calibrate
