#pragma once

#include <cstdint>
#include <string>

#include "hal/replay/ffmpeg.h"
#include "hal/result.h"

namespace touchline::hal::ffmpeg {

/// Decodes one PNG, PNM or JPEG file of at most `max_pixels`. Errors as for read_picture().
Result<FramePtr> decode_picture(const std::string& path, std::int64_t max_pixels);

}  // namespace touchline::hal::ffmpeg
