#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/linux/network/descriptor.h"

namespace touchline::console {

struct ListeningAddress {
  std::string address;  // in numbers
  std::uint16_t port = 0;
};

/// Tells `touchline console --link` where a running program serves its console, which may be another port than the
/// configured one: a file beside the token, locked while this object exists. The system ends the lock with the process,
/// so that a file that a crash leaves behind tells nothing.
class ListeningFile {
 public:
  ListeningFile() = default;
  ~ListeningFile() { remove(); }
  ListeningFile(const ListeningFile&) = delete;
  ListeningFile& operator=(const ListeningFile&) = delete;

  /// Writes the file. Without it, for example in a folder that this user cannot write, the link has the configured
  /// port.
  void write(const std::string& token_file, const ListeningAddress& listening);
  void remove();

 private:
  std::string path_;
  hal::Descriptor file_;
};

/// Returns where running programs with this token serve their console, in the order of the ports.
std::vector<ListeningAddress> running_consoles(const std::string& token_file);

}  // namespace touchline::console
