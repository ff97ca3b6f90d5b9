#pragma once

#include <string>

#include "hal/result.h"

namespace touchline {

/// A file that exists while the program drives robots. If it exists when the program starts, the previous run ended
/// unexpectedly: by a crash, a signal, the watchdog or a lost device. The service manager has then restarted the
/// program automatically, and robots must not move before a person starts them.
///
/// The folder is $RUNTIME_DIRECTORY, which systemd keeps across restarts and empties when the service is stopped and at
/// a reboot. Without it (started by a person, not by a service manager) there is no marker.
class RunMarker {
 public:
  explicit RunMarker(const std::string& folder) : path_(folder.empty() ? "" : folder + "/driving-robots") {}
  /// Returns the marker in $RUNTIME_DIRECTORY.
  static RunMarker of_service();

  [[nodiscard]] bool exists() const;
  /// kIo: the file cannot be created.
  [[nodiscard]] Result<void> create() const;
  /// Removes the file at a normal end of the program.
  void remove() const;

 private:
  std::string path_;  // empty: there is no marker
};

}  // namespace touchline
