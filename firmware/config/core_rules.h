#pragma once

#include "firmware/config/configuration.h"
#include "firmware/config/error_list.h"

namespace touchline::config {

/// Asks every stage of the pipeline whether it accepts the resolved parameters, and adds a message with file, line and
/// key for each that does not. Ranges, and rules that compare keys of one file, were checked before with messages of
/// their own; this function finds the errors that only the core knows. Takes some milliseconds and allocates.
void add_core_refusals(const Configuration& configuration, ErrorList& errors);

}  // namespace touchline::config
