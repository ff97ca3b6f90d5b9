#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hal/result.h"

namespace touchline::setup {

/// Content of a file, shared by all undo states in which it is the same.
using FileContent = std::shared_ptr<const std::string>;

/// The files of a setup, by name: board, venue and team, and the pictures that the venue file names. All lie in one
/// folder. Venue and team file may be missing.
struct SetupFiles {
  std::string board, venue, team;  // names
  std::map<std::string, FileContent> content;

  /// Returns the text of a file; "" if it is missing.
  [[nodiscard]] const std::string& text(const std::string& name) const;
};

/// Returns whether a file of a setup may have this name: letters, digits, '.', '_', '-', at most 64, not beginning with
/// '.'; .toml or .png.
bool is_file_name(std::string_view name);

/// Reads a file of a setup, with the limits for configuration files or for pictures. Errors of hal::read_file().
Result<FileContent> read_setup_file(const std::string& path);

/// Reads the saved files: the board file at this path and the files that it names in the same folder. kNotFound: there
/// is no board file; kInconsistent: it is not valid TOML, or the venue or team file is not named or is in another
/// folder.
Result<SetupFiles> read_setup(const std::string& board_path);
/// As read_setup(), for files in memory; files in `content` that nothing names are skipped.
Result<SetupFiles> setup_of(const std::string& board, const std::map<std::string, FileContent>& content);

/// Makes the folder contain exactly these files. Writes only files that differ, and a file after the files that it
/// names. Errors of hal::OutputFile.
Result<void> write_folder(const SetupFiles& files, const std::string& folder);

/// Returns the names of files that differ or exist in only one of both.
std::vector<std::string> changed_files(const SetupFiles& before, const SetupFiles& after);
/// Returns whether both have this file with the same content, or neither has it.
bool same_file(const SetupFiles& a, const SetupFiles& b, const std::string& name);

/// Renames the pictures of the draft so that none replaces a picture which the saved venue file names. So the saved
/// venue file and its pictures stay consistent until the last rename of a save. Changes [light] of the draft's venue
/// file. Errors of config::replace_section().
Result<void> keep_saved_pictures(const SetupFiles& saved, SetupFiles& draft);

}  // namespace touchline::setup
