#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/config/configuration.h"
#include "hal/result.h"

namespace touchline::recording {

/// The files with which a session runs, or that a reload brings, as a recording holds them: texts with the values of
/// all keys, so that later defaults do not change them, and the pictures that the venue file names (empty: none).
struct ConfigurationText {
  std::uint32_t session = 0;  // from 1 on
  std::uint32_t reload = 0;   // number of the reload, from 1 on; 0: the session's beginning
  std::string version;        // of the program
  std::string camera;         // CameraInfo::description
  bool is_calibrated = true;  // false: nothing is recognized, and there is nothing to replay
  std::string board, venue, team;
  std::string light_map, light_reference;  // PNG files
};

/// Takes the texts of a configuration, and the pictures as they were read with it: their files may have changed since.
ConfigurationText text_of(const config::Configuration& configuration);
/// Returns one JSON object.
std::string encode(const ConfigurationText& text);
/// kCorruptFrame: it is no such object.
Result<ConfigurationText> decode_configuration(std::string_view json);

/// The files of a ConfigurationText in a folder of their own, which the destructor removes.
class TemporaryFiles {
 public:
  TemporaryFiles() = default;
  ~TemporaryFiles();
  TemporaryFiles(const TemporaryFiles&) = delete;
  TemporaryFiles& operator=(const TemporaryFiles&) = delete;

  /// Writes the files. kIo: the folder for temporary files cannot be written.
  Result<void> write(const ConfigurationText& text);
  /// Returns their paths, with `overrides` after those that the recording needs here: the fastest kernel of this
  /// computer, whose results are those of any other, and the places of the pictures.
  [[nodiscard]] config::FilePaths paths(const std::vector<std::string>& overrides) const;

 private:
  std::string folder_;
  std::vector<std::string> overrides_;
};

}  // namespace touchline::recording
