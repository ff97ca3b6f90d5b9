#include "hal/files/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace touchline::hal {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

Error error_of(const std::string& path, int error) {
  std::error_code ignored;
  if (error == ENOENT || error == ENOTDIR) {
    const std::string target = std::filesystem::read_symlink(path, ignored).string();
    if (target.empty()) return failure(ErrorCode::kNotFound, "%s: no such file", path.c_str());
    return failure(ErrorCode::kNotFound, "%s: is a symbolic link to %s, which does not exist", path.c_str(),
                   target.c_str());
  }
  if (error == ELOOP) return failure(ErrorCode::kIo, "%s: its symbolic links form a loop", path.c_str());
  const ErrorCode code = error == EACCES || error == EPERM ? ErrorCode::kPermission : ErrorCode::kIo;
  return failure(code, "%s: cannot be read: %s", path.c_str(), std::strerror(error));
}

const char* kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "folder";
  if (S_ISFIFO(mode)) return "FIFO";
  if (S_ISCHR(mode)) return "character device";
  if (S_ISBLK(mode)) return "block device";
  return "socket";
}

Error too_large(const std::string& path, std::size_t limit_bytes) {
  return failure(ErrorCode::kOutOfRange, "%s: is larger than %zu MiB, the limit for such a file", path.c_str(),
                 limit_bytes >> 20);
}

}  // namespace

Result<std::string> read_file(const std::string& path, std::size_t limit_bytes) {
  std::string bytes;
  // Without O_NONBLOCK, opening a FIFO would wait for a writer.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  struct stat status {};
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0) return error_of(path, errno);
  if (!S_ISREG(status.st_mode)) {
    return failure(ErrorCode::kUnsupported, "%s: is a %s, not a file", path.c_str(), kind_of(status.st_mode));
  }
  if (static_cast<std::size_t>(status.st_size) > limit_bytes) return too_large(path, limit_bytes);
  // Files in /proc and /sys report size 0, and any file can grow while it is read.
  std::size_t size = 0;
  bytes.resize(std::max<std::size_t>(4096, static_cast<std::size_t>(status.st_size) + 1));
  for (;;) {
    const ssize_t count = ::read(file.get(), bytes.data() + size, bytes.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return error_of(path, errno);
    if (count == 0) break;
    size += static_cast<std::size_t>(count);
    if (size > limit_bytes) return too_large(path, limit_bytes);
    if (size == bytes.size()) bytes.resize(std::min(2 * size, limit_bytes + 1));
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace touchline::hal
