#pragma once

#include <string>
#include <utility>
#include <vector>

namespace touchline::latency {

struct Cell {
  std::string text;
  bool marked = false;  // what the reader should see first
};

/// Of numbers: the first column is on the left, the others on the right.
struct Table {
  std::string title;
  std::vector<std::string> head;
  std::vector<std::vector<Cell>> rows;
};

/// What is said to a person, on a terminal or on a page.
struct Document {
  std::string title;
  std::string verdict;  // one sentence
  std::vector<Table> tables;
  std::vector<std::pair<std::string, std::string>> facts;  // name and value
};

/// For a terminal; the verdict comes last, where one looks. Marks are asterisks.
std::string to_text(const Document& document);
/// One page that needs nothing else: no script, no file beside it. `svg`: a picture, may be empty.
std::string to_html(const Document& document, const std::string& svg);

}  // namespace touchline::latency
