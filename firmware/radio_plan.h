#pragma once

#include <bitset>
#include <string>
#include <vector>

#include "core/types.h"
#include "firmware/config/configuration.h"
#include "hal/device_parameters.h"
#include "hal/linux/network/udp_radio.h"
#include "hal/result.h"

namespace touchline {

/// One of the radios that the board file names.
struct PlannedRadio {
  std::string key;  // of the board file: "radio" or "radio.more[0]"
  hal::RadioPortSettings settings;
  hal::UdpRadioSettings udp;           // of the backend "udp"
  std::bitset<kMaxReceivers> reaches;  // by receiver; kAllRobots is always set
};

/// Checks the radios of board and team file against each other. kInconsistent: the message has a line for each error.
Result<std::vector<PlannedRadio>> plan_radios(const config::Configuration& configuration);

/// Advice about radios that work now and may be another device tomorrow, one line each; "" if there is none. Reads
/// /dev.
std::string radio_hints(const config::Configuration& configuration);

}  // namespace touchline
