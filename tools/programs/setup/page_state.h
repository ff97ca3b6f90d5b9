#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tools/programs/setup/draft.h"

namespace touchline::setup {

/// Returns `steps` of the page's state (docs/console-protocol.md): the measurements of the steps, and values derived
/// from the files, which are also in `folder`. From a file with errors, the readable part is used.
nlohmann::json steps_of(const DraftState& draft, const std::string& folder);

/// Returns the problems that `touchline check` reports about the files; "" if they are complete.
std::string problems_of(const SetupFiles& files, const std::string& folder);

/// Checks the keys of one file on their own; consistency between files is checked later. kInconsistent: the message
/// names line and key.
Result<void> check_file(const SetupFiles& files, const std::string& name, const std::string& folder);

/// Returns a `quality` member for a step.
nlohmann::json quality(const char* level, const std::string& text);
nlohmann::json quality(const char* level, const std::string& text, double number, const char* unit);

}  // namespace touchline::setup
