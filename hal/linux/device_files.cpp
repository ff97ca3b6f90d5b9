#include "hal/linux/device_files.h"

#include <glob.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <system_error>

namespace touchline::hal {

bool is_numbered(const std::string& file, const std::string& name) {
  return file.size() > name.size() && file.compare(0, name.size(), name) == 0 &&
         file.find_first_not_of("0123456789", name.size()) == std::string::npos;
}

std::vector<std::string> numbered_files(const std::string& name) {
  std::vector<std::string> files;
  glob_t found{};
  if (::glob((name + "*").c_str(), 0, nullptr, &found) == 0) {
    for (std::size_t i = 0; i < found.gl_pathc; ++i) {
      if (is_numbered(found.gl_pathv[i], name)) files.emplace_back(found.gl_pathv[i]);
    }
  }
  ::globfree(&found);
  std::sort(files.begin(), files.end(), [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  });
  return files;
}

bool is_link(const std::string& file) {
  const std::unique_ptr<char, decltype(&std::free)> target(::realpath(file.c_str(), nullptr), &std::free);
  return target != nullptr && file != target.get();
}

std::string stable_link(const char* folder, const std::string& device) {
  glob_t links{};
  std::string found;
  if (::glob((std::string(folder) + "/*").c_str(), 0, nullptr, &links) == 0) {
    for (std::size_t i = 0; i < links.gl_pathc && found.empty(); ++i) {
      const std::unique_ptr<char, decltype(&std::free)> target(::realpath(links.gl_pathv[i], nullptr), &std::free);
      if (target != nullptr && device == target.get()) found = links.gl_pathv[i];
    }
  }
  ::globfree(&links);
  return found;
}

std::string users_of(const std::string& device) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path target = fs::canonical(device, error);
  if (error) return {};
  std::string users;
  for (fs::directory_iterator process("/proc", error), end; !error && process != end; process.increment(error)) {
    const std::string number = process->path().filename().string();
    if (number.find_first_not_of("0123456789") != std::string::npos || number == std::to_string(::getpid())) continue;
    // A process of another user, or one that has just ended, has no files that can be read.
    std::error_code hidden;
    for (fs::directory_iterator file(process->path() / "fd", hidden), none; !hidden && file != none;
         file.increment(hidden)) {
      std::error_code closed;
      if (fs::read_symlink(file->path(), closed) != target || closed) continue;
      std::ifstream comm(process->path() / "comm");
      std::string name;
      std::getline(comm, name);
      // Replace control characters, because a process may give itself any name, even one that a terminal would execute.
      std::replace_if(
          name.begin(), name.end(), [](unsigned char c) { return c < ' ' || c == 127; }, '?');
      users.append(users.empty() ? "" : ", ").append(name).append(" (process ").append(number).append(")");
      break;
    }
  }
  return users;
}

}  // namespace touchline::hal
