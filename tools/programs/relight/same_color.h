#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/color/color_tables.h"
#include "core/status.h"
#include "tools/programs/calibrate/patch_search.h"
#include "tools/programs/calibrate/venue_draft.h"

namespace touchline::relight {

/// Patches of one color all over a picture (Klancar section 7.3).
struct SameColor {
  std::vector<calibrate::FoundPatch> patches;
  std::size_t representative = 0;  // the one whose color the thresholds are made of
};

/// The patch at the pixel (or, without one, of the color of which there are most the one nearest to the middle of the
/// picture), and all others that have its color in the corrected picture. Patches have the paper's size; the camera
/// model tells how many pixels that is. kNotFound, with the reason: no patch there, or none at all.
Status find_same_color(const calibrate::ChannelImage& corrected, const calibrate::VenueDraft& venue,
                       const std::array<double, 2>* at_px, SameColor& out, std::string& reason);

/// Thresholds as a person sets them from one patch: all but the outer hundredths of its pixels, and a margin.
ColorBox thresholds_of(const calibrate::ChannelImage& image, const calibrate::FoundPatch& patch, int margin);

/// A byte a pixel: is it between the thresholds?
std::vector<std::uint8_t> classify(const calibrate::ChannelImage& image, const ColorBox& thresholds);

/// How many of the patches have at least half of their pixels classified.
std::size_t recognized(const SameColor& color, const std::vector<std::uint8_t>& classified);

}  // namespace touchline::relight
