#include "firmware/config/toml_writer.h"

namespace touchline::config {

void TomlWriter::line(std::string_view key, std::string_view value, std::string_view limits, std::string_view unit,
                      std::string_view help) {
  std::string text = std::string(key) + " = " + std::string(value);
  if (comments_) {
    constexpr std::size_t kCommentColumn = 34;  // where most keys and values have ended
    if (text.size() < kCommentColumn) text.resize(kCommentColumn, ' ');
    text.append("  # ").append(help);
    const std::string_view bounds = limits.empty() ? unit : limits;
    if (!bounds.empty()) text.append(" (").append(bounds).append(")");
  }
  keys_.append(text).append("\n");
}

void TomlWriter::append_table(const TomlWriter& inner, std::string_view open, std::string_view close,
                              std::string_view help) {
  tables_ += "\n";
  if (comments_ && !help.empty()) tables_.append("# ").append(help).append("\n");
  tables_.append(open).append(inner.path_).append(close).append("\n").append(inner.keys_).append(inner.tables_);
}

}  // namespace touchline::config
