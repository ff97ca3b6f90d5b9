#include "hal/recording/mcap_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "hal/recording/mcap_format.h"

namespace touchline::hal::mcap {

McapFile::~McapFile() {
  if (file_ >= 0) ::close(file_);
}

Result<void> McapFile::open(const std::string& path, Links links) {
  path_ = path;
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | (links == Links::kRefused ? O_NOFOLLOW : 0));
  struct stat status {};
  if (file_ < 0 || ::fstat(file_, &status) != 0) {
    const ErrorCode code = errno == ENOENT || errno == ENOTDIR ? ErrorCode::kNotFound
                           : errno == EACCES                   ? ErrorCode::kPermission
                                                               : ErrorCode::kIo;
    return failure(code, "%s: cannot be opened: %s", path.c_str(), std::strerror(errno));
  }
  if (!S_ISREG(status.st_mode)) return failure(ErrorCode::kUnsupported, "%s: is not a file", path.c_str());
  size_ = static_cast<std::uint64_t>(status.st_size);
  std::string magic;
  TOUCHLINE_TRY_ASSIGN(const bool has_magic, read(0, kMagic.size(), magic));
  if (!has_magic || magic != kMagic) {
    return failure(ErrorCode::kCorruptFrame, "%s: is not a recording (MCAP)", path.c_str());
  }
  return {};
}

Result<bool> McapFile::read(std::uint64_t offset, std::uint64_t count, std::string& out) const {
  if (offset > size_ || count > size_ - offset) return false;
  out.resize(static_cast<std::size_t>(count));
  std::size_t done = 0;
  while (done < out.size()) {
    const ssize_t bytes = ::pread(file_, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes < 0) return failure(ErrorCode::kIo, "%s: %s", path_.c_str(), std::strerror(errno));
    if (bytes == 0) return false;  // somebody has cut the file meanwhile
    done += static_cast<std::size_t>(bytes);
  }
  return true;
}

}  // namespace touchline::hal::mcap
