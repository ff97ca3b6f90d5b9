#pragma once

#include "hal/result.h"
#include "tools/programs/setup/job.h"
#include "tools/programs/setup/message_link.h"

namespace touchline::setup {

/// Returns the camera's picture in a message "frame": format, width_px, height_px, and the planes one after the other
/// without padding of rows (picture_layout()). kInconsistent: the members or the number of bytes are wrong; otherwise
/// the firmware's error.
Result<CameraFrame> camera_frame_of(const Message& message);

}  // namespace touchline::setup
