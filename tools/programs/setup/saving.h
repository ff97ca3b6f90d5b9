#pragma once

#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/setup/setup_files.h"

namespace touchline::setup {

/// Replaces these files of the folder by those of the draft, either all or none. Files that the draft lacks are kept,
/// because something else may use them. Each former file is kept as NAME.bak.
///
/// First, everything is written and synced under temporary names, so a full disk changes nothing. From the first rename
/// to the last, `journal` names these files and identifies the files that they replace: if the computer fails in
/// between, finish_saving() completes the rest. Errors of hal::OutputFile; the message names the file, and nothing has
/// changed. kInconsistent: somebody has changed a file in the meantime.
Result<void> save_files(const SetupFiles& draft, const std::vector<std::string>& names, const std::string& folder,
                        const std::string& journal);

/// Completes a save that was interrupted; does nothing if there is no journal. Call it at the start. Returns the files
/// that it has not replaced because somebody has changed them since the save and so made them newer. Errors of
/// hal::OutputFile; then the journal remains. kInconsistent: the journal is damaged or has another version; it is
/// removed.
Result<std::vector<std::string>> finish_saving(const std::string& journal);

}  // namespace touchline::setup
