#include "firmware/config/section_writer.h"

#include <toml++/toml.h>
#include <vector>

#include "firmware/config/board_file.h"
#include "firmware/config/file_backup.h"

namespace touchline::config {
namespace {

// Finds the lines that can be headers: those that begin outside strings and lists.
class LineScanner {
 public:
  /// Returns true if the line begins outside any value. Call it for each line in order.
  bool begins_outside(std::string_view line) {
    const bool outside = !in_string_ && depth_ == 0;
    scan(line);
    return outside;
  }

 private:
  void scan(std::string_view line) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (in_string_) {
        if (!quote_is_literal_ && line[i] == '\\') {
          ++i;
        } else if (line.substr(i, delimiter_.size()) == delimiter_) {
          i += delimiter_.size() - 1;
          // The content of a multi-line string may end with one or two quotes.
          while (delimiter_.size() == 3 && i + 1 < line.size() && line[i + 1] == delimiter_[0]) ++i;
          in_string_ = false;
        }
        continue;
      }
      const char c = line[i];
      if (c == '#') return;
      if (c == '"' || c == '\'') {
        const std::string triple(3, c);
        delimiter_ = line.substr(i, 3) == triple ? triple : std::string(1, c);
        quote_is_literal_ = c == '\'';
        in_string_ = true;
        i += delimiter_.size() - 1;
      } else if (c == '[' || c == '{') {
        ++depth_;
      } else if (c == ']' || c == '}') {
        --depth_;
      }
    }
    // The text is not valid TOML, which the parser reports.
    if (in_string_ && delimiter_.size() == 1) in_string_ = false;
  }

  bool in_string_ = false, quote_is_literal_ = false;
  std::string delimiter_;
  int depth_ = 0;
};

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1);
}

// Returns the first part of "[a.b]" or "[[a.b]]" without quotes; "" if the line is not a header.
std::string header_of(std::string_view line) {
  line = trimmed(line);
  if (!line.starts_with('[')) return {};
  line = trimmed(line.substr(line.starts_with("[[") ? 2 : 1));
  if (line.starts_with('"') || line.starts_with('\'')) return std::string(line.substr(1, line.find(line[0], 1) - 1));
  return std::string(trimmed(line.substr(0, line.find_first_of(".]"))));
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::size_t size = end == std::string_view::npos ? text.size() : end + 1;
    lines.push_back(text.substr(0, size));
    text.remove_prefix(size);
  }
  return lines;
}

// Returns the section of each line. A block of comments directly above a header belongs to the section of the header;
// blank lines belong to the section above.
std::vector<std::string> owners_of(const std::vector<std::string_view>& lines) {
  std::vector<std::string> owner(lines.size());
  LineScanner scanner;
  std::string current;
  std::size_t comment = 0;  // first line of the block of comments above the current line
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const bool outside = scanner.begins_outside(lines[i]);
    const std::string_view content = trimmed(lines[i]);
    if (const std::string header = outside ? header_of(content) : std::string(); !header.empty()) {
      current = header;
      // Without a blank line before it, the comment belongs to the section above.
      const bool apart = comment == 0 || trimmed(lines[comment - 1]).empty();
      for (std::size_t j = apart ? comment : i; j < i; ++j) owner[j] = current;
    }
    owner[i] = current;
    if (!outside || !content.starts_with('#')) comment = i + 1;
  }
  return owner;
}

Result<toml::table> parse(const std::string& text, const std::string& name) {
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& fault) {
    return failure(ErrorCode::kInconsistent, "%s, line %u: %s", name.c_str(), fault.source().begin.line,
                   std::string(fault.description()).c_str());
  }
}

std::string with_line_ends(std::string_view text, std::string_view line_end) {
  std::string out;
  for (std::string_view line : lines_of(text)) {
    while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
    out.append(line).append(line_end);
  }
  return out;
}

bool same_but(toml::table a, toml::table b, std::string_view section) {
  a.erase(section);
  b.erase(section);
  return a == b;
}

bool same_at(const toml::table& a, const toml::table& b, std::string_view section) {
  toml::table x, y;
  if (const toml::node* node = a.get(section)) node->visit([&](const auto& n) { x.insert("section", n); });
  if (const toml::node* node = b.get(section)) node->visit([&](const auto& n) { y.insert("section", n); });
  return x == y;
}

}  // namespace

Result<std::string> replace_section(const std::string& text, std::string_view section, std::string_view toml) {
  TOUCHLINE_TRY_ASSIGN(const toml::table before, parse(text, "the file"));
  TOUCHLINE_TRY_ASSIGN(const toml::table added, parse(std::string(toml), "the new section"));
  const std::string name(section);
  if (added.size() > 1 || (added.size() == 1 && !added.contains(section))) {
    return failure(ErrorCode::kInconsistent, "the new text must hold [%s] and nothing else", name.c_str());
  }
  const std::size_t first_end = text.find('\n');
  const bool crlf = first_end != std::string::npos && first_end > 0 && text[first_end - 1] == '\r';
  const std::string_view line_end = crlf ? "\r\n" : "\n";
  const std::string replacement = with_line_ends(toml, line_end);

  const std::vector<std::string_view> lines = lines_of(text);
  const std::vector<std::string> owners = owners_of(lines);
  std::string out;
  bool done = false;
  for (std::size_t i = 0; i < lines.size();) {
    std::size_t end = i;
    while (end < lines.size() && owners[end] == owners[i]) ++end;
    if (owners[i] != section) {
      for (; i < end; ++i) out += lines[i];
      continue;
    }
    // Keeps blank lines at the end of the section, because they separate it from the next one.
    std::size_t blank = end;
    while (blank > i && trimmed(lines[blank - 1]).empty()) --blank;
    if (!done) out += replacement;
    if (!done && !replacement.empty()) {
      for (std::size_t j = blank; j < end; ++j) out += lines[j];
    }
    done = true;
    i = end;
  }
  if (!done && !replacement.empty()) {
    if (!out.empty() && out.back() != '\n') out += line_end;
    if (!out.empty()) out += line_end;
    out += replacement;
  }
  // LineScanner knows only lines, so let the parser check that nothing but this section has changed.
  const Result<toml::table> after = parse(out, "the changed file");
  if (after.ok() && same_but(before, after.value(), section) && same_at(added, after.value(), section)) return out;
  const std::string cause = after.ok() ? std::string() : " (" + after.text() + ")";
  return failure(ErrorCode::kInconsistent, "[%s] is not written as a section with a header; rewrite it by hand%s",
                 name.c_str(), cause.c_str());
}

Result<void> write_section(const std::string& path, std::string_view section, std::string_view toml) {
  TOUCHLINE_TRY_ASSIGN(const std::optional<std::string> text, read_text(path));
  Result<std::string> changed = replace_section(text.value_or(kNewFile), section, toml);
  if (!changed.ok()) return prefixed(path, std::move(changed).error());
  return replace_file(path, changed.value());
}

}  // namespace touchline::config
