#pragma once

#include <string>
#include <vector>

#include "core/parameter.h"

namespace touchline::config {

/// [console] of the board file: the page in a browser.
struct ConsoleSettings {
  bool enabled = false;
  std::string address = "127.0.0.1:8642";
  std::string token_file = "/var/lib/touchline/console-token";
  std::vector<std::string> hosts, origins;
  double picture_rate_hz = 15.0;
  std::string setup_socket = "/run/touchline-setup/setup.sock";

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.flag(self.enabled, {.name = "enabled", .help = "Serve the console; --console overrides it"});
    visit.text(self.address,
               {.name = "address",
                .help = "ADDRESS:PORT on which it is served, in numbers; port 0: a free one. With another "
                        "address than 127.0.0.1, other computers reach it, with the token"});
    visit.text(self.token_file,
               {.name = "token_file",
                .help = "File with the token that other computers need; `touchline console --token` makes it"});
    visit.texts(self.hosts, {.name = "hosts",
                             .help = "Names of this computer in the browser's address line, such as touchline.local, "
                                     "beside localhost and addresses in numbers"});
    visit.texts(self.origins,
                {.name = "origins",
                 .help = "Origins of other programs' pages that may look with Foxglove's protocol, such as \"file://\" "
                         "or \"https://app.foxglove.dev\""});
    visit.number(self.picture_rate_hz, {.name = "picture_rate_hz",
                                        .range = {0.1, 60.0},
                                        .unit = "Hz",
                                        .help = "Highest rate of pictures; each is copied after its frame's packet"});
    visit.text(self.setup_socket,
               {.name = "setup_socket",
                .help = "Unix socket of the setup program (touchline-setup), which calibrates for the page; empty: "
                        "there is none"});
  }
};

}  // namespace touchline::config
