#pragma once

#include <string>

#include "hal/result.h"
#include "tools/programs/setup/setup_files.h"

namespace touchline::setup {

/// Returns a whole setup as one file: JSON with the texts of the files, and with pictures in base64. It contains no
/// secrets, only keys of the board, venue and team file.
std::string archive_of(const SetupFiles& files);

/// Reads a file that archive_of() made. kInconsistent: it is no archive, is damaged, names a file that is not allowed,
/// or its board file cannot be read; the message says what is wrong.
Result<SetupFiles> read_archive(const std::string& text);

}  // namespace touchline::setup
