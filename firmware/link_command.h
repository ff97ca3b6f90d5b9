#pragma once

#include <string>

#include "hal/result.h"

namespace touchline {

struct LinkOptions {
  bool is_undone = false;   // --undo
  bool is_terminal = true;  // the text is for a terminal, so that it may contain the token
  std::string root;         // in front of all paths, for tests
  std::string systemctl = "/usr/bin/systemctl";
};

/// touchline link, as root: opens the service's page to the computers of private networks (RFC 1918) and prints the
/// login links. Writes a drop-in for the systemd unit, makes the token, announces the page with avahi if that is
/// installed, and restarts the service, which stops the robots. With `is_undone` it closes the page again; the token
/// and touchline-setup stay. kPermission: the user is not root; kNotFound: the service is not installed; kIo: the
/// system's text.
Result<std::string> link_command(const LinkOptions& options);

}  // namespace touchline
