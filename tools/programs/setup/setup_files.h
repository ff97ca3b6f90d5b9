#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hal/result.h"

namespace touchline::setup {

/// Content of a file; shared by the steps of undo that have not changed it.
using FileContent = std::shared_ptr<const std::string>;

/// The files of a setup, by name: board, venue and team, and the pictures that the venue file names. All lie in one
/// folder. Venue and team file may be missing.
struct SetupFiles {
  std::string board, venue, team;  // names
  std::map<std::string, FileContent> content;

  /// Text of a file; "" if it is missing.
  [[nodiscard]] const std::string& text(const std::string& name) const;
};

/// A file of a setup may have this name: letters, digits, '.', '_', '-', at most 64, not a '.' first; .toml or .png.
bool is_file_name(std::string_view name);

/// Reads a file of a setup: a text as any configuration file, a picture as any picture. Errors of hal::read_file().
Result<FileContent> read_setup_file(const std::string& path);

/// Reads the saved files: the board file at this path and what it names beside it. kNotFound: no board file;
/// kInconsistent: it is not valid TOML, or venue or team file are not named or not in its folder.
Result<SetupFiles> read_setup(const std::string& board_path);
/// The same for files in memory; `content` may have more files, which are left out.
Result<SetupFiles> setup_of(const std::string& board, const std::map<std::string, FileContent>& content);

/// Makes the folder hold exactly these files; only files that differ are written, those that name others last. Errors
/// of hal::OutputFile.
Result<void> write_folder(const SetupFiles& files, const std::string& folder);

/// Names of the files that differ or exist in one of them only.
std::vector<std::string> changed_files(const SetupFiles& before, const SetupFiles& after);
/// Whether both have this file with the same content, or none has it.
bool same_file(const SetupFiles& a, const SetupFiles& b, const std::string& name);

/// Renames the pictures of the draft so that none replaces a picture which the saved venue file names: until its last
/// rename, a save leaves those two as they belong together. Changes [light] of the draft's venue file. Errors of
/// config::replace_section().
Result<void> keep_saved_pictures(const SetupFiles& saved, SetupFiles& draft);

}  // namespace touchline::setup
