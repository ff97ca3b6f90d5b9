#pragma once

namespace touchline::hal {

/// Opens /dev/null as standard input, output and error where they are closed. Otherwise the next device that is opened
/// would get one of these descriptors, and what the program prints would go to the robots. Call it first in main().
void reserve_standard_descriptors();

}  // namespace touchline::hal
