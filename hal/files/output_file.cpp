#include "hal/files/output_file.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <thread>
#include <utility>

#include "hal/files/interruption.h"

namespace touchline::hal {
namespace {

constexpr std::size_t kBufferBytes = 65536;
constexpr int kMaxLinks = 40;     // Maximum number of links, as in the kernel.
constexpr int kMaxAttempts = 16;  // Number of attempts; a second one is needed only if two names share 64 random bits.

ErrorCode code_of(int error) {
  switch (error) {
    case ENOENT:
    case ENOTDIR:
      return ErrorCode::kNotFound;
    case EACCES:
    case EPERM:
    case EROFS:
      return ErrorCode::kPermission;
    default:
      return ErrorCode::kIo;
  }
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

std::string name_of(const std::string& path) { return path.substr(path.rfind('/') + 1); }

// Replaces `path` by the target of its symbolic links, which need not exist. Returns 0 or an errno.
int follow_links(std::string& path) {
  for (int i = 0; i < kMaxLinks; ++i) {
    std::array<char, PATH_MAX> target{};
    const ssize_t size = ::readlink(path.c_str(), target.data(), target.size());
    if (size < 0) return errno == EINVAL || errno == ENOENT ? 0 : errno;
    std::string next(target.data(), static_cast<std::size_t>(size));
    path = next.starts_with('/') ? next : folder_of(path).append("/").append(next);
  }
  return ELOOP;
}

std::string temporary_name(const std::string& name) {
  std::uint64_t random = 0;
  if (::getrandom(&random, sizeof random, 0) != sizeof random) return {};
  std::array<char, 32> suffix{};
  std::snprintf(suffix.data(), suffix.size(), ".%016llx.part", static_cast<unsigned long long>(random));
  return name.substr(0, NAME_MAX - std::strlen(suffix.data())) + suffix.data();
}

}  // namespace

OutputFile::~OutputFile() { close(); }

void OutputFile::close() {
  if (!temporary_.empty() && folder_ >= 0) ::unlinkat(folder_, temporary_.c_str(), 0);
  if (file_ >= 0 && file_ != STDOUT_FILENO) ::close(file_);
  if (folder_ >= 0) ::close(folder_);
  file_ = folder_ = -1;
  temporary_.clear();
  buffer_.clear();
  has_reader_ = false;
}

Error OutputFile::error_of(const char* what, int error) const {
  return failure(code_of(error), "%s: %s: %s", path_.c_str(), what, std::strerror(error));
}

Result<void> OutputFile::open(const std::string& path, const OutputOptions& options) {
  close();
  path_ = path;
  sync_ = options.sync;
  if (path == "-" || path == "/dev/stdout") {
    path_ = "standard output";
    file_ = STDOUT_FILENO;
    struct stat redirected {};
    has_reader_ = ::fstat(file_, &redirected) == 0 && !S_ISREG(redirected.st_mode);
    return {};
  }
  struct stat status {};
  // The kernel follows the links here, and rejects those that it does not trust (sysctl fs.protected_symlinks).
  const bool exists = (options.follow_links ? ::stat(path.c_str(), &status) : ::lstat(path.c_str(), &status)) == 0;
  if (!exists && errno != ENOENT) return error_of("cannot be written", errno);
  if (path.empty() || path.back() == '/' || (exists && S_ISDIR(status.st_mode))) {
    return failure(ErrorCode::kIo, "%s: is a folder, not a file to write", path_.c_str());
  }
  if (exists && !S_ISREG(status.st_mode) && !S_ISLNK(status.st_mode)) {
    return open_in_place(options, S_ISFIFO(status.st_mode));
  }
  return open_temporary(options);
}

Result<void> OutputFile::open_in_place(const OutputOptions& options, bool is_fifo) {
  const int no_follow = options.follow_links ? 0 : O_NOFOLLOW;
  const auto open = [&] { return ::open(path_.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY | no_follow); };
  file_ = open();
  // Repeat while a FIFO has no reader.
  while (is_fifo && file_ < 0 && errno == ENXIO && !is_interrupted()) {
    std::this_thread::sleep_for(kInterruptionDelay);
    file_ = open();
  }
  if (file_ < 0) return error_of("cannot be written", is_interrupted() ? EINTR : errno);
  has_reader_ = true;
  struct stat status {};
  if (::fstat(file_, &status) == 0 && !S_ISREG(status.st_mode)) return {};
  close();
  return failure(ErrorCode::kIo, "%s: was replaced by another file while it was opened; try again", path_.c_str());
}

Result<void> OutputFile::open_temporary(const OutputOptions& options) {
  std::string target = path_;
  if (options.follow_links) {
    if (const int error = follow_links(target); error != 0) return error_of("cannot be written", error);
  }
  name_ = name_of(target);
  target_ = target;
  folder_ = ::open(folder_of(target).c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (folder_ < 0) return error_of("cannot be created", errno);
  struct stat former {};
  const bool exists = ::fstatat(folder_, name_.c_str(), &former, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(former.st_mode);
  // Check the file's permissions, because a rename checks only the folder's and would replace a write-protected file.
  if (exists && ::faccessat(folder_, name_.c_str(), W_OK, AT_EACCESS) != 0) return error_of("cannot be written", errno);

  const bool mode_known = exists || options.mode.has_value();
  for (int attempt = 0; attempt < kMaxAttempts && file_ < 0; ++attempt) {
    const std::string name = temporary_name(name_);
    file_ =
        ::openat(folder_, name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode_known ? 0600 : 0666);
    if (file_ >= 0) temporary_ = name;
    if (file_ < 0 && errno != EEXIST) break;
  }
  if (file_ < 0) return error_of("cannot be created in its folder", errno);
  if (!mode_known) return {};
  // Only root can change the owner; a user can choose only among the groups that the user belongs to. If both calls
  // fail, the file belongs to this user.
  if (exists && (former.st_uid != ::geteuid() || former.st_gid != ::getegid())) {
    static_cast<void>(::fchown(file_, former.st_uid, former.st_gid) == 0 || ::fchown(file_, -1u, former.st_gid) == 0);
  }
  if (::fchmod(file_, options.mode.value_or(former.st_mode & 0777)) != 0) return error_of("cannot be written", errno);
  return {};
}

Result<void> OutputFile::write(std::string_view bytes) {
  // The reader of a pipe or a terminal waits for each line, so it is not buffered.
  if (!replaces_file()) return write_all(bytes);
  if (buffer_.size() + bytes.size() > kBufferBytes) {
    TOUCHLINE_TRY(flush());
    if (bytes.size() >= kBufferBytes) return write_all(bytes);
  }
  buffer_.append(bytes);
  return {};
}

Result<void> OutputFile::flush() {
  Result<void> written = write_all(buffer_);
  buffer_.clear();
  return written;
}

Result<void> OutputFile::write_all(std::string_view bytes) {
  // A ready pipe takes PIPE_BUF bytes without waiting.
  const std::size_t most = has_reader_ ? PIPE_BUF : bytes.size();
  while (!bytes.empty()) {
    if (has_reader_ && !wait_until_ready(file_, Ready::kWrite)) return error_of("cannot be written", EINTR);
    const ssize_t count = ::write(file_, bytes.data(), std::min(most, bytes.size()));
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count < 0) return error_of("cannot be written", errno);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return {};
}

Result<void> OutputFile::seek(std::uint64_t position) {
  if (!replaces_file()) return failure(ErrorCode::kUnsupported, "%s: cannot seek", path_.c_str());
  TOUCHLINE_TRY(flush());
  if (::lseek(file_, static_cast<off_t>(position), SEEK_SET) < 0) return error_of("cannot be written", errno);
  return {};
}

Result<void> OutputFile::sync() {
  TOUCHLINE_TRY(flush());
  if (replaces_file() && sync_ && ::fsync(file_) != 0) return error_of("cannot be written to the disk", errno);
  return {};
}

Result<void> OutputFile::commit() {
  TOUCHLINE_TRY(sync());
  if (replaces_file()) {
    if (::renameat(folder_, temporary_.c_str(), folder_, name_.c_str()) != 0) {
      return error_of("cannot be replaced", errno);
    }
    temporary_.clear();
  }
  // Network file systems report failed writes only here.
  const int file = std::exchange(file_, -1);
  if (file != STDOUT_FILENO && ::close(file) != 0) return error_of("cannot be written", errno);
  Result<void> synced = sync_ && folder_ >= 0 ? sync_folder() : Result<void>();
  close();
  return synced;
}

Result<PreparedFile> OutputFile::prepare() {
  if (!replaces_file()) return failure(ErrorCode::kUnsupported, "%s: is not a file", path_.c_str());
  TOUCHLINE_TRY(sync());
  if (::close(std::exchange(file_, -1)) != 0) return error_of("cannot be written", errno);
  const std::string folder = folder_of(target_);
  PreparedFile prepared{target_, (folder == "/" ? "/" : folder + "/") + temporary_};
  temporary_.clear();
  close();
  return prepared;
}

Result<void> OutputFile::sync_folder() {
  const int folder = ::openat(folder_, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  // A folder may permit writing without reading. Some file systems cannot sync a folder: EINVAL.
  if (folder < 0 && errno == EACCES) return {};
  const bool synced = folder >= 0 && (::fsync(folder) == 0 || errno == EINVAL);
  const int error = errno;
  if (folder >= 0) ::close(folder);
  if (synced) return {};
  return error_of("is replaced, but a power failure may restore the former file: its folder cannot be synced", error);
}

Result<void> sync_folder(const std::string& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0 && errno == EACCES) return {};
  const bool synced = file >= 0 && (::fsync(file) == 0 || errno == EINVAL);
  const int error = errno;
  if (file >= 0) ::close(file);
  if (synced) return {};
  return failure(code_of(error), "%s: cannot be synced: %s", folder.c_str(), std::strerror(error));
}

Result<void> write_file(const std::string& path, std::string_view bytes, const OutputOptions& options) {
  OutputFile file;
  TOUCHLINE_TRY(file.open(path, options));
  TOUCHLINE_TRY(file.write(bytes));
  return file.commit();
}

}  // namespace touchline::hal
