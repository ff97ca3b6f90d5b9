#include "firmware/console/versions_text.h"

#include <gnu/libc-version.h>
#include <libwebsockets.h>
#include <sys/utsname.h>
#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <thread>

// Included after <cstdio>, because libjpeg's header needs FILE.
#include <jpeglib.h>

extern "C" {
#include <libavutil/avutil.h>
}

namespace touchline::console {
namespace {

#define TOUCHLINE_TEXT_OF(macro) TOUCHLINE_TEXT_OF_VALUE(macro)
#define TOUCHLINE_TEXT_OF_VALUE(value) #value

// Reads a file to its end without asking for its size, because files of /proc report none.
std::string text_of_file(const char* path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// Returns the value in the first line that begins with `key`, as in "model name : AMD EPYC".
std::string value_in(const std::string& text, std::string_view key) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = std::string_view(text).substr(at, end - at);
    const std::size_t begin = line.starts_with(key) ? line.find_first_not_of(" \t:=\"", key.size()) : line.npos;
    if (begin != line.npos) return std::string(line.substr(begin, line.find_last_not_of('"') + 1 - begin));
    at = end + 1;
  }
  return {};
}

std::string system_text() {
  utsname name{};
  if (::uname(&name) != 0) return {};
  // Leave out nodename, because the computer's name is irrelevant to the bug.
  return std::string(name.sysname) + " " + name.release + " " + name.version + " " + name.machine;
}

std::string processor_text() {
  const std::string facts = text_of_file("/proc/cpuinfo");
  std::string text = value_in(facts, "model name");
  if (text.empty()) text = value_in(facts, "CPU part");
  return text + ", " + std::to_string(std::thread::hardware_concurrency()) + " processors";
}

// The words are separated by NUL.
std::string command_line_text() {
  std::string text = text_of_file("/proc/self/cmdline");
  if (!text.empty()) text.pop_back();
  std::replace(text.begin(), text.end(), '\0', ' ');
  return text;
}

}  // namespace

std::string versions_text(const Scene& scene) {
  std::string text;
  const auto add = [&text](std::string_view what, const std::string& value) {
    if (!value.empty()) text.append(what).append(": ").append(value.c_str()).append("\n");
  };
  add("touchline", scene.version);
  add("compiler", __VERSION__);
  add("command line", command_line_text());
  add("system",
      text_of_file("/etc/os-release").empty() ? "" : value_in(text_of_file("/etc/os-release"), "PRETTY_NAME"));
  add("kernel", system_text());
  add("board", text_of_file("/proc/device-tree/model"));
  add("processor", processor_text());
  add("colors", std::string(config::kernel_word(scene.configuration->board)) + " kernel");
  add("camera", scene.camera.description);
  add("camera delivers", scene.camera.negotiated);
  add("libc", ::gnu_get_libc_version());
  add("libwebsockets", ::lws_get_library_version());
  add("libjpeg-turbo (header)", TOUCHLINE_TEXT_OF(LIBJPEG_TURBO_VERSION));
  add("FFmpeg", ::av_version_info());
  add("zlib", ::zlibVersion());
  return text;
}

}  // namespace touchline::console
