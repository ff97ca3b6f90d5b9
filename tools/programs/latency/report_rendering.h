#pragma once

#include <string>
#include <utility>
#include <vector>

namespace touchline::latency {

struct Cell {
  std::string text;
  bool marked = false;  // the cell is highlighted
};

/// A table of numbers. The first column is aligned to the left, the others to the right.
struct Table {
  std::string title;
  std::vector<std::string> head;
  std::vector<std::vector<Cell>> rows;
};

/// Content of a report, independent of its rendering.
struct Document {
  std::string title;
  std::string summary;  // one sentence
  std::vector<Table> tables;
  std::vector<std::pair<std::string, std::string>> facts;  // pairs of name and value
};

/// Renders the report for a terminal. The summary comes last, next to the prompt. Marked cells get an asterisk.
std::string to_text(const Document& document);
/// Renders the report as one self-contained HTML page without scripts. `svg`: a chart, may be empty.
std::string to_html(const Document& document, const std::string& svg);

}  // namespace touchline::latency
