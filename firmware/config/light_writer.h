#pragma once

#include <string>
#include <string_view>

#include "firmware/config/venue_file.h"
#include "hal/result.h"

namespace touchline::config {

/// Writes an illumination map (a PNG file) and the section [light] of the venue file that belongs to it. Returns the
/// path of the map.
///
/// The map never replaces the one that the venue file names: of the names VENUE-light.png and VENUE-light-2.png, it
/// gets the other one. The venue file is replaced last, by one rename. Whenever the process ends, it therefore names
/// either the old map with the old `normal` or the new map with the new one. The same holds for VENUE.bak, which is
/// written before the map. `entry.map` is set by this function.
///
/// Errors of replace_section() and hal::OutputFile. If only syncing the folder at the end fails, the error says that
/// the venue file was replaced.
Result<std::string> write_light(const std::string& venue, std::string_view png, LightEntry entry);

/// Writes a picture beside the venue file, for a section that will name it, and returns its file name: VENUE-KIND.png,
/// or VENUE-KIND-2.png if the venue file already names the first (`in_use`, empty if none). First keeps the venue file
/// as VENUE.bak, because a former backup may name the picture that is replaced. Errors of hal::OutputFile.
Result<std::string> write_venue_picture(const std::string& venue, const std::string& kind, const std::string& in_use,
                                        std::string_view png);

}  // namespace touchline::config
