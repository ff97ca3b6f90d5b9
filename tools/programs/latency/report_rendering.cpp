#include "tools/programs/latency/report_rendering.h"

#include <algorithm>
#include <string_view>

namespace touchline::latency {
namespace {

constexpr std::string_view kStyle = R"(
  body { font: 15px/1.45 "Helvetica Neue", Arial, sans-serif; color: #222; background: #fff; max-width: 980px;
         margin: 2em auto; padding: 0 1em; }
  h1 { font-size: 1.45em; margin: 0 0 .6em; } h2 { font-size: 1.1em; margin: 1.6em 0 .4em; }
  .summary { font-size: 1.12em; border-left: 4px solid #0072b2; padding: .3em 0 .3em .8em; margin: 0 0 1.2em; }
  svg { width: 100%; height: auto; }
  table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
  th, td { padding: .18em .8em; text-align: right; border-bottom: 1px solid #ddd; white-space: nowrap; }
  thead th { border-bottom: 1.5px solid #222; font-weight: 600; }
  tbody th { font-weight: normal; }
  th:first-child, td:first-child, .facts td { text-align: left; } .facts td { white-space: normal; }
  .facts th { vertical-align: top; }
  .marked { font-weight: 700; color: #a8001a; }
  @media print { body { margin: 0; max-width: none; font-size: 10pt; } table, svg { break-inside: avoid; } }
)";

// Returns the number of characters (not bytes) in UTF-8, which is the width on a terminal.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; }));
}

std::string padding(const std::string& text, std::size_t width) {
  return std::string(width - std::min(width, width_of(text)), ' ');
}

std::string cell_text(const Cell& cell) { return cell.marked ? "*" + cell.text : cell.text; }

std::string to_text(const Table& table) {
  std::vector<std::size_t> widths;
  for (const std::string& head : table.head) widths.push_back(width_of(head));
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width_of(cell_text(row[i])));
  }
  std::string text = table.title + "\n";
  const auto put = [&](std::size_t column, const std::string& cell) {
    const std::string gap = padding(cell, widths[column]);
    text += column == 0 ? cell + gap : "  " + gap + cell;
  };
  for (std::size_t i = 0; i < table.head.size(); ++i) put(i, table.head[i]);
  for (const auto& row : table.rows) {
    text += '\n';
    for (std::size_t i = 0; i < row.size(); ++i) put(i, cell_text(row[i]));
  }
  return text + "\n\n";
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string to_html(const Table& table) {
  std::string html = "<h2>" + escaped(table.title) + "</h2>\n<table>\n<thead><tr>";
  for (const std::string& head : table.head) html += "<th scope=\"col\">" + escaped(head) + "</th>";
  html += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr><th scope=\"row\">" + escaped(row.front().text) + "</th>";
    for (std::size_t i = 1; i < row.size(); ++i) {
      html += (row[i].marked ? "<td class=\"marked\">" : "<td>") + escaped(row[i].text) + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table>\n";
}

}  // namespace

std::string to_text(const Document& document) {
  std::string text = document.title + "\n\n";
  for (const Table& table : document.tables) text += to_text(table);
  std::size_t width = 0;
  for (const auto& [name, value] : document.facts) width = std::max(width, width_of(name));
  for (const auto& [name, value] : document.facts)
    text.append(name).append(padding(name, width)).append("  ").append(value).append("\n");
  return text + (document.facts.empty() ? "" : "\n") + document.summary + "\n";
}

std::string to_html(const Document& document, const std::string& svg) {
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>" +
                     escaped(document.title) + "</title>\n<style>" + std::string(kStyle) +
                     "</style>\n</head>\n<body>\n<h1>" + escaped(document.title) + "</h1>\n<p class=\"summary\">" +
                     escaped(document.summary) + "</p>\n";
  // Skips the XML declaration, which is not allowed inside a page.
  const std::size_t begin = svg.find("<svg");
  if (begin != std::string::npos) html += svg.substr(begin);
  for (const Table& table : document.tables) html += to_html(table);
  if (!document.facts.empty()) {
    html += "<h2>Conditions</h2>\n<table class=\"facts\">\n";
    for (const auto& [name, value] : document.facts) {
      html += "<tr><th scope=\"row\">" + escaped(name) + "</th><td>" + escaped(value) + "</td></tr>\n";
    }
    html += "</table>\n";
  }
  return html + "</body>\n</html>\n";
}

}  // namespace touchline::latency
