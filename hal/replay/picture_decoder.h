#pragma once

#include <string>

#include "core/status.h"
#include "hal/replay/ffmpeg.h"

namespace touchline::hal::ffmpeg {

/// One PNG, PNM or JPEG file as it is stored; errors as read_picture().
Status decode_picture(const std::string& path, FramePtr& out, std::string& reason);

}  // namespace touchline::hal::ffmpeg
