#pragma once

#include <map>
#include <string>
#include <string_view>

namespace touchline::console {

/// A file of the page.
struct PageFile {
  std::string path, content_type;
};

/// The files of the built page by the path of their address, such as "/assets/index-3f2a.js". Only files that were
/// found in the folder are served, so that no address leads out of it.
class PageFiles {
 public:
  /// `folder`: "" if there is none.
  explicit PageFiles(std::string folder) : folder_(std::move(folder)) { scan(); }

  /// Looks for the files again: the page may have been built meanwhile.
  void scan();
  /// Null: there is no such file.
  [[nodiscard]] const PageFile* find(std::string_view address) const;
  /// Whether there is a page.
  [[nodiscard]] bool empty() const { return find("/") == nullptr; }

 private:
  std::string folder_;
  std::map<std::string, PageFile, std::less<>> files_;
};

/// The folder of the built page: that of the installation, else tools/console/dist above the program's folder. "" if
/// there is none.
std::string find_page_folder();

/// What is shown where the page is missing.
std::string_view missing_page();

}  // namespace touchline::console
