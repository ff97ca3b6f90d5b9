#pragma once

#include <string>
#include <vector>

#include "core/types.h"
#include "firmware/config/venue_file.h"
#include "hal/result.h"
#include "tools/programs/calibrate/imaging/channel_image.h"

namespace touchline::setup {

/// Returns a PNG with alpha as large as the picture. Pixels that get a color with `after` and had another class with
/// `before` show this color, pixels that lose their color are black, and all others are transparent. kIo: the encoder
/// failed.
Result<std::string> color_change_mask(const calibrate::ChannelImage& picture,
                                      const std::vector<config::ColorEntry>& before,
                                      const std::vector<config::ColorEntry>& after);

}  // namespace touchline::setup
