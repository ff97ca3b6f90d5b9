#pragma once

#include "firmware/config/configuration.h"

namespace touchline::config {

/// Returns whether a guided setup must calibrate the venue, for a configuration that load() rejected. This is the case
/// if the venue file does not exist, if it lacks the camera model or the colors, or if these belong to pictures of
/// another size or color space because another camera was chosen.
bool lacks_calibration(const Configuration& configuration);

/// Replaces `configuration.pipeline` by parameters with which nothing is recognized, for pictures of the kind in the
/// board file. The camera model is kept if the venue has one; otherwise it is a camera above the middle of the field,
/// so that all positions are finite.
void do_without_calibration(Configuration& configuration);

/// Returns whether the venue file has a camera model that can be used for the camera of the board file.
bool has_camera_model(const Configuration& configuration);

}  // namespace touchline::config
