#include "hal/linux/network/unix_listener.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <cerrno>
#include <cstring>

#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

constexpr int kSocketType = SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC;
// Limit of connections that wait to be accepted, for programs that connect between two frames.
constexpr int kWaitingConnections = 8;

sockaddr_un address_of(const std::string& path) {
  sockaddr_un out{};
  out.sun_family = AF_UNIX;
  std::memcpy(out.sun_path, path.c_str(), path.size() + 1);  // parse_network_address() has checked the length
  return out;
}

bool is_served(const sockaddr_un& address) {
  const Descriptor probe(::socket(AF_UNIX, kSocketType, 0));
  const int connected = ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  return connected == 0 || errno != ECONNREFUSED;
}

// Removes the socket that a dead process has left.
Result<void> remove_stale(const std::string& path, const sockaddr_un& address) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) return {};
  const auto refuse = [&](const char* why) {
    return failure(ErrorCode::kDeviceBusy, "unix://%s: %s; remove it or choose another path", path.c_str(), why);
  };
  if (!S_ISSOCK(status.st_mode)) return refuse("the file exists and is no socket");
  if (is_served(address)) return refuse("another process listens there");
  if (status.st_uid != ::geteuid()) return refuse("the socket belongs to another user");
  if (::unlink(path.c_str()) == 0) return {};
  return failure(ErrorCode::kPermission, "unix://%s: the socket of a dead process cannot be removed: %s", path.c_str(),
                 system_text(errno));
}

}  // namespace

Result<void> UnixListener::open(const std::string& path) {
  close();
  const sockaddr_un address = address_of(path);
  TOUCHLINE_TRY(remove_stale(path, address));
  Descriptor socket(::socket(AF_UNIX, kSocketType, 0));
  const auto* at = reinterpret_cast<const sockaddr*>(&address);
  struct stat status {};
  if (!socket.is_open() || ::bind(socket.get(), at, sizeof(address)) != 0 || ::lstat(path.c_str(), &status) != 0) {
    return failure(open_error(errno), "unix://%s: the socket cannot be made: %s", path.c_str(), system_text(errno));
  }
  path_ = path;
  device_ = status.st_dev;
  inode_ = status.st_ino;
  socket_ = std::move(socket);
  if (::listen(socket_.get(), kWaitingConnections) == 0) return {};
  const int error = errno;
  close();
  return failure(open_error(error), "unix://%s: listening failed: %s", path.c_str(), system_text(error));
}

Descriptor UnixListener::accept() const {
  return Descriptor(::accept4(socket_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
}

void UnixListener::close() {
  if (!socket_.is_open()) return;
  struct stat status {};
  const bool is_own = ::lstat(path_.c_str(), &status) == 0 && status.st_dev == device_ && status.st_ino == inode_;
  if (is_own) ::unlink(path_.c_str());
  socket_.reset();
}

}  // namespace touchline::hal
