#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "hal/result.h"

namespace touchline::hal {

struct OutputOptions {
  /// False: if the path is a symbolic link, the file replaces the link, and its target is not changed.
  bool follow_links = true;
  /// False: commit() does not wait for the disk. For many files that can be written again, such as a series of
  /// pictures.
  bool sync = true;
  /// Permissions of the file. By default those of the file that is replaced, or 0666 minus the umask for a new one.
  std::optional<mode_t> mode = std::nullopt;
};

/// A complete file under its temporary name, and the name that it is to get. Symbolic links are followed already.
struct PreparedFile {
  std::string path, temporary;
};

/// A file that is written completely or not at all. The bytes go to a temporary file in the same folder; commit()
/// renames it to its name. If the process ends before, the former file stays as it was.
/// - The temporary file is NAME.RANDOM.part, created with O_EXCL and O_NOFOLLOW: an existing file or link is never
///   opened. The destructor removes it; after a SIGKILL or a power cut it stays in the folder.
/// - A symbolic link stays a link: its target is replaced, or created.
/// - The former file's permissions are kept, and its owner if the system allows it. Its hard links keep the old data.
/// - A character device, FIFO or pipe is written in place. Waiting for its reader ends when the process is to end
///   (hal/files/interruption.h).
/// - "-" is standard output.
///
/// Errors of all functions: kNotFound (no such folder), kPermission, kIo. The message names the file and the cause.
class OutputFile {
 public:
  OutputFile() = default;
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  Result<void> open(const std::string& path, const OutputOptions& options = {});
  Result<void> write(std::string_view bytes);
  /// Returns true for regular files: seek() works, and nothing can be read before commit().
  [[nodiscard]] bool replaces_file() const { return !temporary_.empty(); }
  /// Position in bytes from the file's beginning for the next write(). kUnsupported unless replaces_file().
  Result<void> seek(std::uint64_t position);
  /// Writes everything to the disk, still under the temporary name: a full disk shows here, before any file is
  /// replaced.
  Result<void> sync();
  /// Syncs the file, gives it its name, and syncs the folder. If only the last step fails, the error says that the file
  /// is replaced.
  Result<void> commit();
  /// In place of commit(), for several files that change together: syncs the file, closes it and leaves it to the
  /// caller, who renames or removes it. kUnsupported unless replaces_file().
  Result<PreparedFile> prepare();

 private:
  [[nodiscard]] Error error_of(const char* what, int error) const;
  Result<void> open_in_place(const OutputOptions& options, bool is_fifo);
  Result<void> open_temporary(const OutputOptions& options);
  Result<void> flush();
  Result<void> write_all(std::string_view bytes);
  Result<void> sync_folder();
  void close();

  std::string path_;       // as given, for messages
  std::string target_;     // the same without symbolic links
  std::string name_;       // of the file in the folder
  std::string temporary_;  // name in the folder; empty: written in place
  std::string buffer_;
  int file_ = -1, folder_ = -1;
  bool sync_ = true;
  bool has_reader_ = false;  // writing may have to wait for somebody who reads
};

/// Makes the renames in a folder survive a power failure. Also succeeds if the folder can only be written, or if the
/// file system cannot sync folders. kIo; kNotFound: no such folder.
Result<void> sync_folder(const std::string& folder);

/// Writes a whole file as OutputFile does.
Result<void> write_file(const std::string& path, std::string_view bytes, const OutputOptions& options = {});

}  // namespace touchline::hal
