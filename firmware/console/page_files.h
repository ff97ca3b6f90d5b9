#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace touchline::console {

/// A file of the page.
struct PageFile {
  std::string content, content_type;
};

/// The files of the built page, by the path in their address, such as "/assets/index-3f2a.js". They are read at once
/// and kept, so that requests do not wait for a disk. Only files found in the folder are served, so no address leads
/// out of it.
class PageFiles {
 public:
  PageFiles() = default;
  /// `folder`: "" if there is none. Keeps assets of `former`, unless it is null, that the folder no longer has, because
  /// a browser with the former page may still request them. Reads files, so the console's thread must not call it while
  /// it serves.
  explicit PageFiles(const std::string& folder, const PageFiles* former = nullptr);

  /// Returns null if there is no such file.
  [[nodiscard]] const PageFile* find(std::string_view address) const;
  /// Returns whether there is no page.
  [[nodiscard]] bool empty() const { return find("/") == nullptr; }

 private:
  void add(std::string address, PageFile file);

  std::map<std::string, PageFile, std::less<>> files_;
  std::size_t bytes_ = 0;
};

/// Returns the folder of the built page: that of the installation, else tools/console/dist above the program's folder.
/// "" if there is none.
std::string find_page_folder();

/// Returns the text that is shown if the page is missing.
std::string_view missing_page();

}  // namespace touchline::console
