#pragma once

#include "core/light/light_reference.h"
#include "hal/result.h"
#include "tools/programs/calibrate/colors/color_fit.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

namespace touchline::calibrate {

/// Makes the reference of the field from the pictures that the colors were learned from: for each cell the median of
/// the pictures in which nothing covers it. Pictures are left out if their light differs from that of the picture with
/// most patches (of several, the picture with the median brightness). A position within 10 cm of a click or of a region
/// of a learned color counts as covered (24 pixels if the camera model is unknown). Cells more than 25 cm outside the
/// field (outside the region of interest if the camera model is unknown) are left out, because people stand there.
/// `draft.file.color` is not used.
LightReference field_reference(const VenueDraft& draft, const ColorFitInput& input, const ColorFit& fit);

/// Writes the reference beside the venue file and returns the section [light] that names it. Errors of
/// config::write_venue_picture().
Result<Section> write_field_reference(const std::string& venue, const VenueDraft& draft, const ColorFitInput& input,
                                      const ColorFit& fit);

}  // namespace touchline::calibrate
