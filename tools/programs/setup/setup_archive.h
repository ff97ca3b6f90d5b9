#pragma once

#include <string>

#include "hal/result.h"
#include "tools/programs/setup/setup_files.h"

namespace touchline::setup {

/// A whole setup as one file: JSON with the texts of the files, and with pictures in base64. It has no secrets: keys
/// are those of board, venue and team file.
std::string archive_of(const SetupFiles& files);

/// Reads such a file. kInconsistent: it is none, is damaged, names a file that may not exist, or its board file cannot
/// be read; the message says what is wrong.
Result<SetupFiles> read_archive(const std::string& text);

}  // namespace touchline::setup
