#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/color/color_tables.h"
#include "hal/result.h"
#include "tools/programs/calibrate/colors/patch_search.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

namespace touchline::relight {

/// Patches of one color distributed over a picture (Klancar section 7.3).
struct SameColor {
  std::vector<calibrate::FoundPatch> patches;
  std::size_t representative = 0;  // index of the patch that defines the thresholds
};

/// Finds the patch at the pixel, and all other patches that have its color in the corrected picture. Without a pixel,
/// it starts from the patch of the most frequent color that is nearest to the center of the picture. Patches have the
/// size that the paper gives, projected with the camera model. kNotFound, with the reason: no patch at the pixel, or no
/// patch at all.
Result<SameColor> find_same_color(const calibrate::ChannelImage& corrected, const calibrate::VenueDraft& venue,
                                  const std::array<double, 2>* at_px);

/// Returns the thresholds that a person would set from one patch: the range of its pixels without the outer
/// percentiles, widened by a margin.
ColorBox thresholds_of(const calibrate::ChannelImage& image, const calibrate::FoundPatch& patch, int margin);

/// Classifies the pixels: one byte per pixel, 1 if it lies between the thresholds.
std::vector<std::uint8_t> classify(const calibrate::ChannelImage& image, const ColorBox& thresholds);

/// Returns the number of patches of which at least half the pixels were classified.
std::size_t recognized(const SameColor& color, const std::vector<std::uint8_t>& classified);

}  // namespace touchline::relight
