#include "firmware/config/section_writer.h"

#include <toml++/toml.h>
#include <vector>

#include "firmware/config/board_file.h"
#include "firmware/config/file_replacement.h"

namespace touchline::config {
namespace {

// Follows TOML's lexical structure far enough to know which lines begin a table: not inside of a string or a list.
class LineScanner {
 public:
  /// True when the line begins outside of any value; to be called for each line in turn.
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
          // A multi-line string may end in one or two quotes of its own.
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
    if (in_string_ && delimiter_.size() == 1) in_string_ = false;  // not valid TOML; the parser has said so
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

// First part of "[a.b]" or "[[a.b]]", quotes taken off; "" when the line is no header.
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

// For each line: the section it belongs to. Blank lines and comments above a header go with that header as far as the
// comment touches it; blank lines in between stay with what is above.
std::vector<std::string> owners_of(const std::vector<std::string_view>& lines) {
  std::vector<std::string> owner(lines.size());
  LineScanner scanner;
  std::string current;
  std::size_t comment = 0;  // where the block of comments begins that the next line may belong to
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const bool outside = scanner.begins_outside(lines[i]);
    const std::string_view content = trimmed(lines[i]);
    if (const std::string header = outside ? header_of(content) : std::string(); !header.empty()) {
      current = header;
      // Without a blank line before it, a comment is the last of the section above.
      const bool apart = comment == 0 || trimmed(lines[comment - 1]).empty();
      for (std::size_t j = apart ? comment : i; j < i; ++j) owner[j] = current;
    }
    owner[i] = current;
    if (!outside || !content.starts_with('#')) comment = i + 1;
  }
  return owner;
}

bool parse(const std::string& text, const std::string& what, toml::table& out, std::string& reason) {
  try {
    out = toml::parse(text);
    return true;
  } catch (const toml::parse_error& fault) {
    reason = what + ", line " + std::to_string(fault.source().begin.line) + ": " + std::string(fault.description());
    return false;
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

Status replace_section(const std::string& text, std::string_view section, std::string_view toml, std::string& out,
                       std::string& reason) {
  toml::table before, added, after;
  if (!parse(text, "the file", before, reason)) return ErrorCode::kInconsistent;
  if (!parse(std::string(toml), "the new section", added, reason)) return ErrorCode::kInconsistent;
  if (added.size() > 1 || (added.size() == 1 && !added.contains(section))) {
    reason = "the new text must hold [" + std::string(section) + "] and nothing else";
    return ErrorCode::kInconsistent;
  }
  const std::size_t first_end = text.find('\n');
  const bool crlf = first_end != std::string::npos && first_end > 0 && text[first_end - 1] == '\r';
  const std::string_view line_end = crlf ? "\r\n" : "\n";
  const std::string replacement = with_line_ends(toml, line_end);

  const std::vector<std::string_view> lines = lines_of(text);
  const std::vector<std::string> owners = owners_of(lines);
  out.clear();
  bool done = false;
  for (std::size_t i = 0; i < lines.size();) {
    std::size_t end = i;
    while (end < lines.size() && owners[end] == owners[i]) ++end;
    if (owners[i] != section) {
      for (; i < end; ++i) out += lines[i];
      continue;
    }
    // Blank lines at its end part it from the next section: they stay.
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
  // The scanner above knows TOML's lines only; the parser has the last word on whether just this section changed.
  if (!parse(out, "the changed file", after, reason) || !same_but(before, after, section) ||
      !same_at(added, after, section)) {
    reason = "[" + std::string(section) + "] is not written as a section with a header; write it so by hand once" +
             (reason.empty() ? "" : " (" + reason + ")");
    return ErrorCode::kInconsistent;
  }
  return {};
}

Status write_section(const std::string& path, std::string_view section, std::string_view toml, std::string& reason) {
  std::string text;
  bool exists = false;
  if (const Status status = read_text(path, text, exists, reason); !status.ok()) return status;
  if (!exists) text = kNewFile;
  std::string changed;
  if (const Status status = replace_section(text, section, toml, changed, reason); !status.ok()) {
    reason.insert(0, path + ": ");
    return status;
  }
  return replace_file(path, changed, reason);
}

}  // namespace touchline::config
