#include "firmware/config/file_replacement.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace touchline::config {
namespace {

Status failed(const std::string& path, const char* what, std::string& reason) {
  const int error = errno;
  reason = path + ": " + what + ": " + std::strerror(error);
  return error == EACCES || error == EPERM || error == EROFS ? ErrorCode::kPermission : ErrorCode::kIo;
}

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

Status write_new(const std::string& path, const std::string& text, mode_t mode, std::string& reason) {
  const Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, mode));
  if (file.get() < 0) return failed(path, "cannot be made", reason);
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count = ::write(file.get(), text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return failed(path, "cannot be written", reason);
    written += static_cast<std::size_t>(count);
  }
  if (::fchmod(file.get(), mode) != 0 || ::fsync(file.get()) != 0) return failed(path, "cannot be written", reason);
  return {};
}

Status sync_folder(const std::filesystem::path& folder, std::string& reason) {
  const Descriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some file systems cannot sync a folder and say EINVAL.
  if (directory.get() < 0 || (::fsync(directory.get()) != 0 && errno != EINVAL)) {
    return failed(folder.string(), "cannot be synced", reason);
  }
  return {};
}

}  // namespace

Status read_text(const std::string& path, std::string& text, bool& exists, std::string& reason) {
  text.clear();
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  exists = file.get() >= 0;
  if (!exists) return errno == ENOENT ? Status() : failed(path, "cannot be read", reason);
  char block[4096];
  while (true) {
    const ssize_t count = ::read(file.get(), block, sizeof block);
    if (count == 0) return {};
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return failed(path, "cannot be read", reason);
    text.append(block, static_cast<std::size_t>(count));
  }
}

Status replace_file(const std::string& path, const std::string& text, std::string& reason) {
  std::error_code error;
  std::filesystem::path target = std::filesystem::canonical(path, error);
  if (error) target = std::filesystem::absolute(path);
  mode_t mode = 0644;
  struct stat status {};
  const bool exists = ::stat(target.c_str(), &status) == 0;
  if (exists) mode = status.st_mode & 07777;

  const std::string fresh = target.string() + ".new", backup = target.string() + ".bak";
  if (const Status written = write_new(fresh, text, mode, reason); !written.ok()) {
    ::unlink(fresh.c_str());
    return written;
  }
  if (exists) {
    std::string former;
    bool there = false;
    Status kept = read_text(target.string(), former, there, reason);
    if (kept.ok()) kept = write_new(backup, former, mode, reason);
    if (!kept.ok()) {
      ::unlink(fresh.c_str());
      return kept;
    }
  }
  if (::rename(fresh.c_str(), target.c_str()) != 0) {
    const Status renamed = failed(path, "cannot be replaced", reason);
    ::unlink(fresh.c_str());
    return renamed;
  }
  return sync_folder(target.parent_path(), reason);
}

}  // namespace touchline::config
