#include "firmware/config/toml_writer.h"

namespace touchline::config {

void TomlWriter::line(const Key& key, std::string_view value, std::string_view words) {
  std::string text = std::string(key.name) + " = " + std::string(value);
  if (comments_) {
    constexpr std::size_t kCommentColumn = 34;  // column of comments; most keys with their values are shorter
    if (text.size() < kCommentColumn) text.resize(kCommentColumn, ' ');
    text.append("  # ").append(key.help);
    const std::string limits = words.empty() ? limits_text(key) : std::string(words);
    if (!limits.empty()) text.append(" (").append(limits).append(")");
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
