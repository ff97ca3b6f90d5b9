#include "firmware/console/listening_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

namespace touchline::console {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBegin = "console-", kEnd = ".listening";  // the port is between them

fs::path folder_beside(const std::string& token_file) {
  const fs::path folder = fs::path(token_file).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

struct flock whole_file(short type) {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  return lock;
}

/// Returns what the file says if its program runs.
std::optional<ListeningAddress> read_running(const fs::path& path) {
  // Root may read a folder of the service's user: see open_token() in access.cpp.
  const hal::Descriptor file(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  struct flock lock = whole_file(F_RDLCK);
  if (!file.is_open() || ::fcntl(file.get(), F_OFD_GETLK, &lock) != 0 || lock.l_type == F_UNLCK) return std::nullopt;
  std::array<char, 64> bytes{};  // an IPv4 address and a port
  const ssize_t size = ::read(file.get(), bytes.data(), bytes.size());
  const std::string_view text(bytes.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return std::nullopt;
  ListeningAddress listening{std::string(text.substr(0, colon))};
  const std::string_view port = text.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), listening.port);
  const bool is_valid = error == std::errc() && end != port.data() + port.size() && *end == '\n' &&
                        listening.address.find_first_not_of("0123456789.") == std::string::npos;
  return is_valid ? std::optional(std::move(listening)) : std::nullopt;
}

}  // namespace

void ListeningFile::write(const std::string& token_file, const ListeningAddress& listening) {
  remove();
  const std::string name = std::string(kBegin) + std::to_string(listening.port) + std::string(kEnd);
  const std::string path = folder_beside(token_file) / name;
  // This program has the port now, so an existing file is one that a crash left behind.
  ::unlink(path.c_str());
  hal::Descriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600));
  struct flock lock = whole_file(F_WRLCK);
  if (!file.is_open()) return;
  const std::string text = listening.address + ":" + std::to_string(listening.port) + "\n";
  const bool is_written = ::write(file.get(), text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (!is_written || ::fcntl(file.get(), F_OFD_SETLK, &lock) != 0) {
    ::unlink(path.c_str());
    return;
  }
  path_ = path;
  file_ = std::move(file);
}

void ListeningFile::remove() {
  if (!file_.is_open()) return;
  ::unlink(path_.c_str());
  file_.reset();
}

std::vector<ListeningAddress> running_consoles(const std::string& token_file) {
  std::vector<ListeningAddress> running;
  std::error_code error;
  // Nothing is found in a folder that this user cannot read.
  for (fs::directory_iterator entry(folder_beside(token_file), error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename();
    if (!name.starts_with(kBegin) || !name.ends_with(kEnd)) continue;
    if (std::optional<ListeningAddress> one = read_running(entry->path())) running.push_back(std::move(*one));
  }
  std::sort(running.begin(), running.end(), [](const auto& a, const auto& b) { return a.port < b.port; });
  return running;
}

}  // namespace touchline::console
