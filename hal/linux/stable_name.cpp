#include "hal/linux/stable_name.h"

#include <glob.h>

#include <cstdlib>
#include <memory>

namespace touchline::hal {

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

std::string stable_name(const char* folder, const std::string& device) {
  const std::string link = stable_link(folder, device);
  return link.empty() ? link : " = " + link;
}

}  // namespace touchline::hal
