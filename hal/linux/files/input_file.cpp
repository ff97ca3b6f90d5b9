#include "hal/linux/files/input_file.h"

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

Status failed(const std::string& path, int error, std::string& reason) {
  std::error_code ignored;
  if (error == ENOENT || error == ENOTDIR) {
    const std::filesystem::path target = std::filesystem::read_symlink(path, ignored);
    reason = path + (target.empty() ? ": no such file"
                                    : ": is a symbolic link to " + target.string() + ", which does not exist");
    return ErrorCode::kNotFound;
  }
  reason = path + (error == ELOOP ? ": is a symbolic link in a loop"
                                  : std::string(": cannot be read: ") + std::strerror(error));
  return error == EACCES || error == EPERM ? ErrorCode::kPermission : ErrorCode::kIo;
}

const char* kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "folder";
  if (S_ISFIFO(mode)) return "FIFO";
  if (S_ISCHR(mode)) return "character device";
  if (S_ISBLK(mode)) return "block device";
  return "socket";
}

Status too_large(const std::string& path, std::size_t limit_bytes, std::string& reason) {
  reason =
      path + ": is larger than " + std::to_string(limit_bytes >> 20) + " MiB, the most that is read of such a file";
  return ErrorCode::kOutOfRange;
}

}  // namespace

Status read_file(const std::string& path, std::size_t limit_bytes, std::string& bytes, std::string& reason) {
  bytes.clear();
  // Without O_NONBLOCK, opening a FIFO would wait for a writer.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  struct stat status {};
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0) return failed(path, errno, reason);
  if (!S_ISREG(status.st_mode)) {
    reason = path + ": is a " + kind_of(status.st_mode) + ", not a file";
    return ErrorCode::kUnsupported;
  }
  if (static_cast<std::size_t>(status.st_size) > limit_bytes) return too_large(path, limit_bytes, reason);
  // Files of /proc and /sys have size 0, and any file can grow meanwhile.
  std::size_t size = 0;
  bytes.resize(std::max<std::size_t>(4096, static_cast<std::size_t>(status.st_size) + 1));
  for (;;) {
    const ssize_t count = ::read(file.get(), bytes.data() + size, bytes.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return failed(path, errno, reason);
    if (count == 0) break;
    size += static_cast<std::size_t>(count);
    if (size > limit_bytes) return too_large(path, limit_bytes, reason);
    if (size == bytes.size()) bytes.resize(std::min(2 * size, limit_bytes + 1));
  }
  bytes.resize(size);
  return {};
}

}  // namespace touchline::hal
