#pragma once

#include <cstdint>
#include <string>

#include "hal/result.h"
#include "tools/programs/relight/changed_picture.h"
#include "tools/programs/relight/painted_things.h"

namespace touchline::relight {

/// Changes a picture, a folder of pictures or a video, and writes NAME.png into the folder `out` for each picture. NAME
/// is the picture's name, or the frame number with six digits for a video. The things listed for a picture are painted
/// before it is changed. `every`: 1 for all frames, n for the frames 0, n, 2n... Returns the number of pictures
/// written. kInconsistent: a picture would replace its input; otherwise the errors of reading and writing.
Result<std::uint64_t> change_series(const std::string& input, const std::string& out, const PictureChange& change,
                                    const Things& things, std::uint64_t every);

}  // namespace touchline::relight
