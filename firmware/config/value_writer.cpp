#include "firmware/config/value_writer.h"

#include <toml++/toml.h>
#include <algorithm>
#include <vector>

#include "firmware/config/toml_file.h"

namespace touchline::config {
namespace {

// Returns the offset of the first byte of each line, and of the end.
std::vector<std::size_t> line_offsets(const std::string& text) {
  std::vector<std::size_t> offsets{0};
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n') offsets.push_back(i + 1);
  }
  if (offsets.back() != text.size()) offsets.push_back(text.size());
  return offsets;
}

// toml++ counts lines and code points from 1.
std::size_t offset_of(const std::string& text, const std::vector<std::size_t>& lines, toml::source_position at) {
  if (at.line < 1 || at.line > lines.size()) return text.size();
  std::size_t offset = lines[at.line - 1];
  for (std::size_t column = 1; column < at.column && offset < text.size(); ++column) {
    for (++offset; offset < text.size() && (static_cast<unsigned char>(text[offset]) & 0xC0u) == 0x80u;) ++offset;
  }
  return offset;
}

// Replaces a value. A comment after the value keeps its column if there is room.
void replace_and_align(std::string& text, std::size_t begin, std::size_t end, const std::string& value) {
  std::size_t spaces = end;
  while (spaces < text.size() && text[spaces] == ' ') ++spaces;
  const bool has_comment = spaces < text.size() && text[spaces] == '#';
  const std::size_t former = end - begin, room = spaces - end;
  text.replace(begin, former, value);
  if (!has_comment) return;
  const std::size_t at = begin + value.size();
  if (value.size() <= former) {
    text.insert(at, former - value.size(), ' ');
  } else {
    text.erase(at, std::min(value.size() - former, room > 0 ? room - 1 : 0));
  }
}

bool is_written_inside(const toml::node& node) {
  const toml::table* const table = node.as_table();
  return !node.is_array_of_tables() && (table == nullptr || table->is_inline());
}

// Returns the line, counted from 0, before which the table's next key belongs.
std::size_t line_after(const toml::table& table, bool is_root) {
  std::size_t line = is_root ? 0 : table.source().begin.line;
  for (const auto& [name, node] : table) {
    if (is_written_inside(node)) line = std::max<std::size_t>(line, node.source().end.line);
  }
  return line;
}

// Returns the table that the parser must read from the changed text.
Result<toml::table> changed(toml::table root, const std::string& table, const std::string& key,
                            const std::string& value) {
  if (!value.empty()) {
    TOUCHLINE_TRY(apply({table.empty() ? key : table + "." + key, value}, root));
    return root;
  }
  toml::table* const parent = table.empty() ? &root : root.at_path(table).as_table();
  if (parent != nullptr) parent->erase(key);
  return root;
}

std::string edited(const std::string& text, const toml::table& root, const std::string& table, const std::string& key,
                   const std::string& value) {
  const std::string line_end = text.find("\r\n") != std::string::npos ? "\r\n" : "\n";
  const std::string added = key + " = " + value + line_end;
  const toml::table* const parent = table.empty() ? &root : root.at_path(table).as_table();
  std::string out = text;
  if (parent == nullptr) {
    if (!out.empty() && out.back() != '\n') out += line_end;
    return value.empty() ? text : out + line_end + "[" + table + "]" + line_end + added;
  }
  const std::vector<std::size_t> lines = line_offsets(text);
  const toml::node* const node = parent->get(key);
  if (node == nullptr && value.empty()) return text;
  if (node == nullptr) {
    const std::size_t line = std::min(line_after(*parent, table.empty()), lines.size() - 1);
    const bool is_open = lines[line] > 0 && text[lines[line] - 1] != '\n';
    return out.insert(lines[line], (is_open ? line_end : "") + added);
  }
  const toml::source_region where = node->source();
  if (value.empty()) {
    const std::size_t first = lines[where.begin.line - 1];
    return out.erase(first, lines[std::min<std::size_t>(where.end.line, lines.size() - 1)] - first);
  }
  replace_and_align(out, offset_of(text, lines, where.begin), offset_of(text, lines, where.end), value);
  return out;
}

}  // namespace

Result<std::string> replace_value(const std::string& text, const std::string& table, const std::string& key,
                                  const std::string& value) {
  try {
    const toml::table before = toml::parse(text);
    TOUCHLINE_TRY_ASSIGN(const toml::table wanted, changed(before, table, key, value));
    std::string out = edited(text, before, table, key, value);
    // Reject an edit if the parser does not read the wanted table from it, because only the parser knows every way to
    // write a table.
    if (toml::parse(out) == wanted) return out;
  } catch (const toml::parse_error& fault) {
    return failure(ErrorCode::kInconsistent, "line %u: %s", fault.source().begin.line,
                   std::string(fault.description()).c_str());
  }
  return failure(ErrorCode::kInconsistent, "[%s] is not written as a section with a header", table.c_str());
}

}  // namespace touchline::config
