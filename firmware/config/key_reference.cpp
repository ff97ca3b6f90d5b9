#include "firmware/config/key_reference.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <set>
#include <utility>

#include "firmware/config/board_file.h"
#include "firmware/config/key_list.h"
#include "firmware/config/standard_layouts.h"
#include "firmware/config/team_file.h"
#include "firmware/config/venue_file.h"
#include "firmware/config/wording.h"

namespace touchline::config {
namespace {

struct FileKeys {
  const char* file;
  std::vector<KeyInfo> keys;
};

std::vector<FileKeys> all_files() {
  return {{"board.toml", KeyLister::keys_of_file<BoardFile>()},
          {"venue.toml", KeyLister::keys_of_file<VenueFile>()},
          {"team.toml", KeyLister::keys_of_file<TeamFile>()}};
}

// Returns a word for the column "Reload"; empty: the key needs a restart.
std::string_view reload_word(Reload reload) {
  switch (reload) {
    case Reload::kInherit:
    case Reload::kRestart:
      break;
    case Reload::kNoEffect:
      return "no effect";
    case Reload::kCamera:
      return "camera";
    case Reload::kThresholds:
      return "thresholds";
    case Reload::kControl:
      return "control";
    case Reload::kLoop:
      return "loop";
  }
  return {};
}

bool is_section(const KeyInfo& key) { return key.type == "section" || key.type == "list of sections"; }

// Returns "[own]" or "[[own.robot]]".
std::string header_of(const KeyInfo& section) {
  std::string path = section.path;
  for (std::size_t at = path.find("[]"); at != std::string::npos; at = path.find("[]")) path.erase(at, 2);
  return section.type == "section" ? "[" + path + "]" : "[[" + path + "]]";
}

// Escapes vertical bars, which would end the cell.
std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text) out.append(c == '|' ? "\\|" : std::string(1, c));
  return out;
}

void append_table(const std::vector<KeyInfo>& keys, const std::string& prefix, std::string& page) {
  std::string rows;
  for (const KeyInfo& key : keys) {
    const bool inside = key.path.starts_with(prefix) && key.path.find('.', prefix.size()) == std::string::npos;
    if (!inside || is_section(key)) continue;
    rows.append("| `").append(key.path.substr(prefix.size())).append("` | ").append(cell(key.type)).append(" | ");
    rows.append(key.is_required ? "required" : "`" + cell(key.initial) + "`").append(" | ").append(key.limits);
    rows.append(" | ").append(reload_word(key.reload)).append(" | ").append(cell(key.help)).append(" |\n");
  }
  if (!rows.empty()) page.append("\n| key | type | default | range | reload | meaning |\n|---|---|---|---|---|---|\n");
  page.append(rows);
}

std::string text_of(const KeyInfo& key) {
  std::string text = "  " + key.path + ": " + key.type;
  if (!key.limits.empty()) text.append(", ").append(key.limits);
  if (key.is_required) {
    text.append(", required");
  } else if (!key.initial.empty()) {
    text.append(", default ").append(key.initial);
  }
  if (const std::string_view word = reload_word(key.reload); !word.empty() && !is_section(key)) {
    text.append(", reload: ").append(word);
  }
  return text.append("\n      ").append(key.help).append("\n");
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// Text that the terminal shows for one key or layout, and the text that is searched for words.
struct Entry {
  std::string file, name, text, searched;
};

std::vector<Entry> all_entries() {
  std::vector<Entry> entries;
  const auto add = [&](const std::string& file, const std::string& name, const std::string& help, std::string text) {
    std::string searched = file;
    searched.append(" ").append(name).append(" ").append(help);
    entries.push_back({file, name, std::move(text), lower_case(std::move(searched))});
  };
  for (const auto& [file, keys] : all_files()) {
    for (const KeyInfo& key : keys) add(file, key.path, key.help, text_of(key));
  }
  for (const StandardLayout& layout : standard_layouts()) {
    const std::string name(layout.name), help(layout.help);
    std::string text = "  " + name;
    text.append(": ").append(help).append("\n");
    add("standard layouts", name, help, std::move(text));
  }
  return entries;
}

// Returns a text that names the first word found nowhere, and the most similar part of a path: "exposure_us" of
// "camera.exposure_us".
std::string nothing_found(std::span<const std::string> words) {
  const std::vector<Entry> entries = all_entries();
  for (const std::string& word : words) {
    const std::string wanted = lower_case(word);
    const bool is_known = std::any_of(entries.begin(), entries.end(), [&](const Entry& entry) {
      return entry.searched.find(wanted) != std::string::npos;
    });
    if (is_known) continue;
    std::set<std::string> parts;
    for (const Entry& entry : entries) {
      std::string part;
      for (const char c : entry.name + ".") {
        const bool ends = c == '.' || c == '_' || c == '[' || c == ']';
        if (!ends) part += c;
        if (ends && part.size() > 2) parts.insert(part);
        if (ends) part.clear();
      }
    }
    const std::vector<std::string_view> known(parts.begin(), parts.end());
    const std::string_view nearest = nearest_word(wanted, known);
    return "no key has \"" + word + "\" in its file, section, name or meaning" +
           (nearest.empty() ? "" : "; did you mean \"" + std::string(nearest) + "\"?");
  }
  std::string text = "no key has all of these words:";
  for (const std::string& word : words) text += " " + word;
  return text;
}

}  // namespace

Result<std::string> key_reference_text(std::span<const std::string> words) {
  std::vector<Entry> shown;
  for (Entry& entry : all_entries()) {
    const bool has_all = std::all_of(words.begin(), words.end(), [&](const std::string& word) {
      return entry.searched.find(lower_case(word)) != std::string::npos;
    });
    if (has_all) shown.push_back(std::move(entry));
  }
  if (shown.empty()) return Error{ErrorCode::kNotFound, nothing_found(words)};
  std::string text, file;
  for (const Entry& entry : shown) {
    if (entry.file != file) text.append(entry.file).append("\n");
    file = entry.file;
    text.append(entry.text);
  }
  return text;
}

std::string key_reference_markdown() {
  std::string page;
  for (const auto& [file, keys] : all_files()) {
    page.append("\n### ").append(file).append("\n");
    append_table(keys, "", page);
    for (const KeyInfo& key : keys) {
      if (!is_section(key)) continue;
      page.append("\n#### ")
          .append(header_of(key))
          .append("\n\n")
          .append(key.help)
          .append(key.is_required ? ". Required.\n" : ".\n");
      append_table(keys, key.path + (key.type == "section" ? "." : "[]."), page);
    }
  }
  page.append(
      "\n### Standard layouts\n\nNames for `own.layout` and `opponent.layout`. Colors of robots are listed in the "
      "order of the");
  page.append(" identification patches.\n\n| name | robot's top | height |\n|---|---|---|\n");
  for (const StandardLayout& layout : standard_layouts()) {
    page.append("| `").append(layout.name).append("` | ").append(layout.help).append(" | ");
    page.append(number_text(layout.layout.height_m)).append(" m |\n");
  }
  return page;
}

Result<std::string> updated_key_reference(std::string page) {
  const std::size_t begin = page.find(kReferenceBegin);
  const std::size_t from = begin + std::strlen(kReferenceBegin);
  const std::size_t end = begin == std::string::npos ? begin : page.find(kReferenceEnd, from);
  if (end == std::string::npos) {
    return failure(ErrorCode::kNotFound, "the lines that begin and end the reference are missing");
  }
  page.replace(from, end - from, key_reference_markdown() + "\n");
  return page;
}

}  // namespace touchline::config
