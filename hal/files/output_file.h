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
  /// False: commit() does not wait for the disk. This is for many files that can be written again, such as a series of
  /// pictures.
  bool sync = true;
  /// Permissions of the file. The default is the permissions of the replaced file, or 0666 minus the umask for a new
  /// one.
  std::optional<mode_t> mode = std::nullopt;
};

/// A complete file under its temporary name, and its final name. In both, symbolic links are already resolved.
struct PreparedFile {
  std::string path, temporary;
};

/// A file that is written completely or not at all. The bytes go to a temporary file in the same folder; commit()
/// renames it to its name. If the process ends before, the former file stays as it was.
/// - The temporary file is NAME.RANDOM.part, created with O_EXCL and O_NOFOLLOW: an existing file or link is never
///   opened. The destructor removes it; after a SIGKILL or a power cut it stays in the folder.
/// - A symbolic link stays a link: its target is replaced, or created.
/// - The former file's permissions are kept, and its owner if the system allows it. Its hard links keep the old data.
/// - A character device, FIFO or pipe is written in place. Waiting for its reader ends when the process is told to end
///   (hal/files/interruption.h).
/// - "-" is standard output.
///
/// Errors of all functions: kNotFound (the folder does not exist), kPermission, kIo. The message names the file and the
/// cause.
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
  /// Sets the position of the next write(), in bytes from the file's beginning. kUnsupported unless replaces_file().
  Result<void> seek(std::uint64_t position);
  /// Writes everything to the disk, still under the temporary name, so that a full disk is noticed before any file is
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

  std::string path_;       // path as given, for messages
  std::string target_;     // the path with symbolic links resolved
  std::string name_;       // folder of the file
  std::string temporary_;  // temporary name in the folder; empty: the file is written in place
  std::string buffer_;
  int file_ = -1, folder_ = -1;
  bool sync_ = true;
  bool has_reader_ = false;  // writing may have to wait for a reader
};

/// Makes the renames in a folder survive a power failure. Also succeeds if the folder can only be written, or if the
/// file system cannot sync folders. kIo; kNotFound: no such folder.
Result<void> sync_folder(const std::string& folder);

/// Writes a whole file as OutputFile does.
Result<void> write_file(const std::string& path, std::string_view bytes, const OutputOptions& options = {});

}  // namespace touchline::hal
