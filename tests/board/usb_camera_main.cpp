// Runs on the host: a USB camera (tests/board/usb_camera.h) at a USB port of the guest. Its pictures come from the
// arena (tests/board/wire.h).
//   board-usb-camera PICTURES.sock USB.sock
// The arena connects to the first socket. The second one is qemu's; the camera is plugged in when the arena requests
// it.
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "tests/board/usb_camera.h"

namespace {

using namespace touchline::board;

/// Waits for the arena and returns its connection.
int accept_at(const std::string& path) {
  const std::string unfinished = path + ".new";  // the final name appears when the socket listens
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (unfinished.size() >= sizeof address.sun_path) return -1;
  std::memcpy(address.sun_path, unfinished.c_str(), unfinished.size());
  const int listener = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  ::unlink(unfinished.c_str());
  if (::bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(listener, 1) != 0 || ::rename(unfinished.c_str(), path.c_str()) != 0) {
    return -1;
  }
  const int arena = ::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
  ::close(listener);
  return arena;
}

bool read_all(int file, void* out, std::size_t bytes) {
  return bytes == 0 || ::recv(file, out, bytes, MSG_WAITALL) == static_cast<ssize_t>(bytes);
}

/// Handles a message of the arena; returns false if the guest must be served first.
bool handle(UsbLink& link, UsbCamera& camera, const std::string& port, const FrameHeader& header, const Bytes& picture,
            FrameAnswer& answer) {
  switch (header.kind) {
    case ToGuest::kPlug:
      answer.error = link.is_plugged() ? 0 : link.plug(port);
      return true;
    case ToGuest::kUnplug:
      link.unplug();
      return true;
    case ToGuest::kNoFrame:
      return true;
    case ToGuest::kFrame:
    case ToGuest::kTornFrame:
      break;
  }
  if (!link.is_plugged()) {
    answer.error = ENODEV;
    return true;
  }
  if (!link.is_streaming()) return false;
  std::vector<Bytes> packets = camera.packets_of(header, picture);
  if (packets.empty()) {
    answer.error = EINVAL;
  } else {
    if (header.kind == ToGuest::kTornFrame) packets[packets.size() / 2].clear();
    link.stream(packets);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: board-usb-camera PICTURES.sock USB.sock\n");
    return 64;
  }
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const int arena = accept_at(argv[1]);
  if (arena < 0) {
    std::fprintf(stderr, "board-usb-camera: %s: %s\n", argv[1], std::strerror(errno));
    return 1;
  }
  UsbCamera camera;
  UsbLink link(camera);
  FrameHeader header;
  Bytes picture;
  for (bool pending = false;;) {
    std::array<pollfd, 2> watched{pollfd{link.file(), POLLIN, 0}, pollfd{pending ? -1 : arena, POLLIN, 0}};
    if (::poll(watched.data(), watched.size(), -1) < 0) continue;
    if (watched[0].revents != 0) link.serve();
    if (watched[1].revents != 0) {
      if (!read_all(arena, &header, sizeof header) || header.magic != kWireMagic) return 0;
      picture.resize(has_picture(header.kind) ? header.bytes : 0);
      if (!read_all(arena, picture.data(), picture.size())) return 0;
      pending = true;
    }
    FrameAnswer answer;
    answer.number = header.number;
    if (!pending || !handle(link, camera, argv[2], header, picture, answer)) continue;
    pending = false;
    if (::send(arena, &answer, sizeof answer, MSG_NOSIGNAL) != static_cast<ssize_t>(sizeof answer)) return 0;
  }
}
