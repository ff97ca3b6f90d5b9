#include "firmware/config/toml_file.h"

#include <charconv>
#include <optional>

#include "firmware/config/board_file.h"
#include "hal/files/input_file.h"

namespace touchline::config {
namespace {

std::string option_text(const Override& override) { return "--set " + override.key + "=" + override.value; }

// Returns a table with the value as its only node. Its source is the option, so that messages name the option.
std::optional<toml::table> parse_value(const Override& override) {
  const auto parse = [&](const std::string& value) -> std::optional<toml::table> {
    try {
      toml::table parsed = toml::parse("value = " + value + "\n", option_text(override));
      if (parsed.size() == 1) return parsed;
      return std::nullopt;  // a line break in the value began another key
    } catch (const toml::parse_error&) {
      return std::nullopt;
    }
  };
  std::optional<toml::table> parsed = parse(override.value);
  return parsed ? std::move(parsed) : parse(toml_string(override.value));
}

struct Step {
  std::string key;
  std::optional<std::size_t> index;  // index of a list's element: key[index]
};

bool parse_steps(std::string_view path, std::vector<Step>& steps) {
  while (true) {
    const std::size_t dot = path.find('.');
    std::string_view part = path.substr(0, dot);
    Step step;
    if (const std::size_t bracket = part.find('['); bracket != std::string_view::npos) {
      const std::string_view digits = part.substr(bracket + 1);
      std::size_t index = 0;
      const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
      if (error != std::errc() || std::string_view(end, digits.data() + digits.size()) != "]") return false;
      step.index = index;
      part = part.substr(0, bracket);
    }
    if (part.empty()) return false;
    step.key = part;
    steps.push_back(std::move(step));
    if (dot == std::string_view::npos) return true;
    path.remove_prefix(dot + 1);
  }
}

// Returns the error for a file that cannot be used as a whole.
Error unusable(std::string_view where, std::string_view key, std::string_view message) {
  return {ErrorCode::kNotFound, error_line(where, key, message)};
}

Result<void> check_version(const toml::table& root, const std::string& path) {
  const toml::node* node = root.get("version");
  const std::string known = std::to_string(kFileVersion);
  if (node == nullptr) {
    return unusable(path, "version", "is missing; the first line must be: version = " + known);
  }
  const std::string where = path + ":" + std::to_string(node->source().begin.line);
  const auto* version = node->as_integer();
  if (version == nullptr || version->get() < 1) {
    return unusable(where, "version", "must be an integer from 1; this Touchline reads version " + known);
  }
  if (version->get() > kFileVersion) {
    return unusable(
        where, "version",
        "made by a later Touchline (version " + std::to_string(version->get()) + "); this one reads version " + known);
  }
  return {};
}

}  // namespace

Result<toml::table> parse_file(const std::string& path, std::string_view remedy) {
  const Result<std::string> content = hal::read_file(path, hal::kMaxTextFileBytes);
  if (!content.ok()) {
    const bool show_remedy = content.code() == ErrorCode::kNotFound && !remedy.empty();
    return unusable("", "", content.text() + (show_remedy ? "; " + std::string(remedy) : ""));
  }
  return parse_text(content.value(), path);
}

Result<toml::table> parse_text(std::string_view content, const std::string& path) {
  try {
    toml::table root = toml::parse(content, path);
    TOUCHLINE_TRY(check_version(root, path));
    return root;
  } catch (const toml::parse_error& fault) {
    return unusable(path + ":" + std::to_string(fault.source().begin.line), "", fault.description());
  }
}

Result<void> apply(const Override& override, toml::table& root) {
  const auto wrong = [&](std::string_view key, std::string_view message) {
    return Error{ErrorCode::kInconsistent, error_line(option_text(override), key, message)};
  };
  std::vector<Step> steps;
  if (!parse_steps(override.key, steps)) {
    return wrong("", "a key looks like camera.exposure_us or color[0].name");
  }
  std::optional<toml::table> parsed = parse_value(override);
  toml::node* value = parsed ? parsed->get("value") : nullptr;
  if (value == nullptr) {
    return wrong("", "the value cannot be read");
  }
  const toml::source_region source = value->source();
  toml::table* table = &root;
  std::string path;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Step& step = steps[i];
    const bool last = i + 1 == steps.size();
    path.append(path.empty() ? "" : ".").append(step.key);
    if (!step.index) {
      if (last) {
        value->visit([&](auto& node) { table->insert_or_assign(toml::key(step.key, source), std::move(node)); });
        return {};
      }
      toml::node* inner = table->get(step.key);
      if (inner == nullptr) inner = &table->insert(toml::key(step.key, source), toml::table{}).first->second;
      table = inner->as_table();
      if (table == nullptr) {
        return wrong(path, inner->is_array() ? "is a list; name an element: " + path + "[0]" : "is not a section");
      }
      continue;
    }
    toml::array* array = table->get_as<toml::array>(step.key);
    path += "[" + std::to_string(*step.index) + "]";
    if (array == nullptr || *step.index >= array->size()) {
      return wrong(path, "the list has " + std::to_string(array == nullptr ? 0 : array->size()) + " elements");
    }
    if (last) {
      value->visit([&](auto& node) {
        array->replace(array->cbegin() + static_cast<std::ptrdiff_t>(*step.index), std::move(node));
      });
      return {};
    }
    table = array->get(*step.index)->as_table();
    if (table == nullptr) return wrong(path, "is not a section");
  }
  return {};
}

}  // namespace touchline::config
