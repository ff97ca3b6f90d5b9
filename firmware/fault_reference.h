#pragma once

#include <string>

#include "hal/result.h"

namespace touchline {

/// Returns the tables of docs/faults.md: a row for each reason to stop the robots (kHaltDescriptions), and for each
/// error of a device (kErrorDescriptions of fault_policy.h).
std::string fault_reference_markdown();
/// Returns the page with the tables between its marks replaced. kNotFound: the page has no marks.
Result<std::string> updated_fault_reference(std::string page);

}  // namespace touchline
