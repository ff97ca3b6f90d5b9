#pragma once

#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/setup/setup_files.h"

namespace touchline::setup {

/// Replaces these files of the folder by those of the draft, all or none. Files that the draft lacks stay: they may
/// belong to something else. Each former file is kept as NAME.bak.
///
/// First everything is written and synced under temporary names, so that a full disk changes nothing. `journal` names
/// them, and identifies the files that they replace, from the first rename to the last: if the computer fails between
/// them, finish_saving() completes the rest. Errors of hal::OutputFile; the message names the file. Nothing has changed
/// then. kInconsistent: somebody has changed a file meanwhile.
Result<void> save_files(const SetupFiles& draft, const std::vector<std::string>& names, const std::string& folder,
                        const std::string& journal);

/// Completes a save that was interrupted; does nothing if there is no journal. To be called at the start. Returns the
/// files that it has left as they are, because somebody has changed them since the save: theirs is the newer content.
/// Errors of hal::OutputFile; the journal stays then. kInconsistent: the journal is damaged, or of another version; it
/// is removed.
Result<std::vector<std::string>> finish_saving(const std::string& journal);

}  // namespace touchline::setup
