#include "tools/programs/setup/unified_difference.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "tools/programs/command_line/formatted.h"

namespace touchline::setup {
namespace {

using Lines = std::vector<std::string_view>;

constexpr std::size_t kContext = 3;
// Largest table of the longest common subsequence, whose size is the product of both numbers of lines: 16 million
// entries of 2 bytes.
constexpr std::size_t kMaxEntries = std::size_t{16} << 20;

struct Edit {
  char sign = ' ';
  std::string_view line;
};

Lines lines_of(std::string_view text) {
  Lines lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1);
    lines.push_back(text.substr(0, end + 1));
    text.remove_prefix(end + 1);
  }
  return lines;
}

// Finds the longest common subsequence of the lines that remain after removing equal lines at both ends.
std::vector<Edit> edits_between(const Lines& a, const Lines& b) {
  std::size_t first = 0, last = 0;
  while (first < a.size() && first < b.size() && a[first] == b[first]) ++first;
  while (last < a.size() - first && last < b.size() - first && a[a.size() - 1 - last] == b[b.size() - 1 - last]) ++last;
  const std::size_t rows = a.size() - first - last, columns = b.size() - first - last;
  std::vector<Edit> out;
  for (std::size_t i = 0; i < first; ++i) out.push_back({' ', a[i]});
  std::size_t row = 0, column = 0;
  if ((rows + 1) * (columns + 1) <= kMaxEntries) {
    std::vector<std::uint16_t> common((rows + 1) * (columns + 1), 0);
    const auto at = [&](std::size_t i, std::size_t j) -> std::uint16_t& { return common[i * (columns + 1) + j]; };
    for (std::size_t i = rows; i-- > 0;) {
      for (std::size_t j = columns; j-- > 0;) {
        at(i, j) = a[first + i] == b[first + j] ? static_cast<std::uint16_t>(at(i + 1, j + 1) + 1)
                                                : std::max(at(i + 1, j), at(i, j + 1));
      }
    }
    while (row < rows && column < columns) {
      if (a[first + row] == b[first + column]) {
        out.push_back({' ', a[first + row]});
        ++row;
        ++column;
      } else if (at(row + 1, column) >= at(row, column + 1)) {
        out.push_back({'-', a[first + row++]});
      } else {
        out.push_back({'+', b[first + column++]});
      }
    }
  }
  while (row < rows) out.push_back({'-', a[first + row++]});
  while (column < columns) out.push_back({'+', b[first + column++]});
  for (std::size_t i = a.size() - last; i < a.size(); ++i) out.push_back({' ', a[i]});
  return out;
}

// Returns "12,3" as in the header of a hunk; an empty range is given by the line before it.
std::string range_text(std::size_t lines_before, std::size_t count) {
  return formatted("%zu,%zu", count == 0 ? lines_before : lines_before + 1, count);
}

}  // namespace

std::string unified_difference(std::string_view name, std::string_view before, std::string_view after) {
  if (before == after) return {};
  const std::vector<Edit> edits = edits_between(lines_of(before), lines_of(after));
  std::string out = formatted("--- %s\n+++ %s\n", std::string(name).c_str(), std::string(name).c_str());
  std::size_t old_line = 0, new_line = 0;
  for (std::size_t i = 0; i < edits.size();) {
    // A hunk ends where more than twice the context lines are equal.
    std::size_t change = i;
    while (change < edits.size() && edits[change].sign == ' ') ++change;
    if (change == edits.size()) break;
    const std::size_t begin = change - std::min(change - i, kContext);
    std::size_t end = change, equal = 0;
    for (std::size_t j = change; j < edits.size() && equal <= 2 * kContext; ++j) {
      equal = edits[j].sign == ' ' ? equal + 1 : 0;
      if (equal == 0) end = j + 1;
    }
    const std::size_t stop = std::min(end + kContext, edits.size());
    old_line += begin - i;
    new_line += begin - i;
    std::size_t removed = 0, added = 0;
    std::string hunk;
    for (std::size_t j = begin; j < stop; ++j) {
      removed += edits[j].sign != '+' ? 1u : 0u;
      added += edits[j].sign != '-' ? 1u : 0u;
      hunk.append(1, edits[j].sign).append(edits[j].line);
      if (hunk.back() != '\n') hunk += "\n\\ No newline at end of file\n";
    }
    out += "@@ -" + range_text(old_line, removed) + " +" + range_text(new_line, added) + " @@\n" + hunk;
    old_line += removed;
    new_line += added;
    i = stop;
  }
  return out;
}

}  // namespace touchline::setup
