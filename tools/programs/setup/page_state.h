#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tools/programs/setup/draft.h"

namespace touchline::setup {

/// `steps` of the page's state (docs/console-protocol.md): what the steps have measured, and what follows from the
/// files, which are also in `folder`. A file with errors gives what could be read of it.
nlohmann::json steps_of(const DraftState& draft, const std::string& folder);

/// What `touchline check` says of the files; "" if they are complete.
std::string problems_of(const SetupFiles& files, const std::string& folder);

/// Checks the keys of one file by themselves; what the files need of each other comes later. kInconsistent: the message
/// names line and key.
Result<void> check_file(const SetupFiles& files, const std::string& name, const std::string& folder);

/// `quality` of a step.
nlohmann::json quality(const char* level, const std::string& text);
nlohmann::json quality(const char* level, const std::string& text, double number, const char* unit);

}  // namespace touchline::setup
