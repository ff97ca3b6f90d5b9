#pragma once

#include <cstdint>
#include <string>

#include "core/status.h"
#include "hal/replay/ffmpeg.h"

namespace touchline::hal::ffmpeg {

/// Decodes one PNG, PNM or JPEG file of at most `max_pixels`. Errors as for read_picture().
Status decode_picture(const std::string& path, std::int64_t max_pixels, FramePtr& out, std::string& reason);

}  // namespace touchline::hal::ffmpeg
