#pragma once

namespace touchline::hal {

/// Opens /dev/null as standard input, output and error if they are closed. Otherwise the next device to be opened would
/// get one of these descriptors, and the output of the program would go to the robots. Call it first in main().
void reserve_standard_descriptors();

}  // namespace touchline::hal
