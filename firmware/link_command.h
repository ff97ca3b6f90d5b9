#pragma once

#include <string>

#include "hal/result.h"

namespace touchline {

struct LinkOptions {
  bool is_undone = false;  // --undo
  std::string root;        // in front of all paths, for tests
};

/// touchline link, as root: opens the service's page to the computers of private networks (RFC 1918) and prints the
/// login links. Writes a drop-in for the systemd unit, makes the token, announces the page with avahi if avahi is
/// installed, and restarts the service, which stops the robots. With `is_undone`, it undoes these changes. kPermission:
/// the user is not root; kNotFound: the service is not installed; kIo: the system's text.
Result<std::string> link_command(const LinkOptions& options);

}  // namespace touchline
