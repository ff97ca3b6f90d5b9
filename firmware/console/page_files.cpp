#include "firmware/console/page_files.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>
#include <utility>

#include "hal/files/input_file.h"

namespace touchline::console {
namespace {

namespace fs = std::filesystem;

// Limits for the files that are kept; a built page has about 10 files and half a megabyte. Assets of earlier builds are
// kept until a limit is reached.
constexpr std::size_t kMaxPageFiles = 500, kMaxPageBytes = std::size_t{16} << 20;
// Number of parent folders to search, enough to reach the sources from build/PRESET/firmware.
constexpr int kFoldersAbove = 5;

std::string content_type(const fs::path& path) {
  struct Type {
    std::string_view extension, type;
  };
  constexpr std::array<Type, 10> kTypes{{{".html", "text/html; charset=utf-8"},
                                         {".js", "text/javascript; charset=utf-8"},
                                         {".css", "text/css; charset=utf-8"},
                                         {".json", "application/json"},
                                         {".webmanifest", "application/manifest+json"},
                                         {".svg", "image/svg+xml"},
                                         {".png", "image/png"},
                                         {".ico", "image/x-icon"},
                                         {".woff2", "font/woff2"},
                                         {".wasm", "application/wasm"}}};
  const std::string extension = path.extension().string();
  const auto* const found =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const Type& type) { return type.extension == extension; });
  return std::string(found != kTypes.end() ? found->type : "application/octet-stream");
}

}  // namespace

PageFiles::PageFiles(const std::string& folder, const PageFiles* former) {
  if (folder.empty()) return;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    // A link could lead out of the folder.
    if (entry->is_symlink(error) || !entry->is_regular_file(error)) continue;
    const fs::path& path = entry->path();
    Result<std::string> content = hal::read_file(path.string(), kMaxPageBytes);
    // A file that is being written is skipped; the next reading finds it.
    if (!content.ok()) continue;
    add("/" + path.lexically_relative(folder).generic_string(), {std::move(content).value(), content_type(path)});
  }
  const auto add_asset = [this](const auto& entry) {
    if (entry.first.starts_with("/assets/")) add(entry.first, entry.second);
  };
  if (former != nullptr) std::for_each(former->files_.begin(), former->files_.end(), add_asset);
  if (const PageFile* const index = find("/index.html")) add("/", *index);
  // Browsers request this name if no page names an icon, for example for a picture on its own.
  if (const PageFile* const icon = find("/favicon.svg")) add("/favicon.ico", *icon);
}

void PageFiles::add(std::string address, PageFile file) {
  if (files_.size() >= kMaxPageFiles || bytes_ + file.content.size() > kMaxPageBytes) return;
  const std::size_t bytes = file.content.size();
  if (files_.try_emplace(std::move(address), std::move(file)).second) bytes_ += bytes;
}

const PageFile* PageFiles::find(std::string_view address) const {
  const auto found = files_.find(address);
  return found == files_.end() ? nullptr : &found->second;
}

std::string find_page_folder() {
  std::error_code error;
  fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (error) return {};
  const auto has_page = [&](const fs::path& candidate) { return fs::exists(candidate / "index.html", error); };
  const fs::path installed = folder.parent_path() / "share/touchline/console";
  if (has_page(installed)) return installed.string();
  for (int i = 0; i < kFoldersAbove && folder.has_relative_path(); ++i, folder = folder.parent_path()) {
    // The folder is used even if the page is not built yet, because it may be built while the program runs.
    const fs::path sources = folder / "tools/console";
    if (fs::is_directory(sources, error)) return (sources / "dist").string();
  }
  return {};
}

std::string_view missing_page() {
  return R"(<!doctype html><html lang="en"><meta charset="utf-8"><meta http-equiv="refresh" content="5"><title>Touchline</title>
<style>body{font:16px/1.5 sans-serif;max-width:40em;margin:3em auto;padding:0 1em}code{background:#8883;padding:.1em .3em}</style>
<h1>The page is not built</h1>
<p>Touchline runs, but the console's page is missing. To build it, in the folder of the sources, run</p>
<p><code>tools/console/build</code></p>
<p>Then this page loads by itself. The build needs node 18 or later (<code>apt install nodejs npm</code>). The picture alone:
<a href="/snapshot.jpg">snapshot</a>, <a href="/stream.mjpg">stream</a>.</p></html>
)";
}

}  // namespace touchline::console
