#include "firmware/config/difference.h"

#include <algorithm>
#include <map>

#include "firmware/config/toml_writer.h"

namespace touchline::config {
namespace {

struct KeyValue {
  std::string key, value;
  bool is_element = false;
};

/// Visitor of core/parameter.h that lists every key with its value.
class ValueLister {
 public:
  template <class Struct>
  static std::vector<KeyValue> values_of(const Struct& value) {
    ValueLister lister;
    Struct::describe(value, lister);
    return std::move(lister.values_);
  }

  template <class T>
  void number(std::string_view key, const T& value, Range, std::string_view, std::string_view) {
    add(key, value_text(value));
  }
  template <class Container>
  void numbers(std::string_view key, const Container& values, Range, std::string_view, std::string_view) {
    std::string list;
    for (const auto& value : values) list.append(list.empty() ? "" : ", ").append(value_text(value));
    add(key, "[" + list + "]");
  }
  void flag(std::string_view key, const bool& value, std::string_view) { add(key, value ? "true" : "false"); }
  void text(std::string_view key, const std::string& value, std::string_view) { add(key, toml_string(value)); }
  void texts(std::string_view key, const std::vector<std::string>& values, std::string_view) {
    const std::vector<std::string_view> views(values.begin(), values.end());
    add(key, "[" + joined(views) + "]");
  }
  template <class Enum>
  void choice(std::string_view key, const Enum& value, std::span<const Choice<Enum>> choices, std::string_view) {
    for (const auto& choice : choices) {
      if (choice.value == value) add(key, toml_string(choice.word));
    }
  }
  template <class Struct>
  void section(std::string_view key, const Struct& value, std::string_view) {
    const std::string outer = prefix_;
    prefix_ += std::string(key) + ".";
    Struct::describe(value, *this);
    prefix_ = outer;
  }
  template <class Container>
  void list(std::string_view key, const Container& values, std::string_view) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      std::string name = element(key, i);
      if constexpr (requires { values[i].name; }) name = std::string(key) + "." + values[i].name;
      values_.push_back({prefix_ + name, TomlWriter::text_of(values[i], false), true});
    }
  }

 private:
  void add(std::string_view key, std::string value) {
    values_.push_back({prefix_ + std::string(key), std::move(value), false});
  }

  std::string prefix_;
  std::vector<KeyValue> values_;
};

Change change_of(FileKind file, const std::string& key, const KeyValue* before, const KeyValue* after) {
  Change change{file, key, {}, {}};
  if ((before != nullptr ? before : after)->is_element) return change;
  if (before != nullptr) change.before = before->value;
  if (after != nullptr) change.after = after->value;
  return change;
}

template <class File>
void compare(FileKind file, const File& before, const File& after, std::vector<Change>& out) {
  const std::vector<KeyValue> old_values = ValueLister::values_of(before), new_values = ValueLister::values_of(after);
  std::map<std::string, const KeyValue*> old_by_key;
  for (const KeyValue& value : old_values) old_by_key.emplace(value.key, &value);
  for (const KeyValue& value : new_values) {
    const auto found = old_by_key.find(value.key);
    const KeyValue* old = found == old_by_key.end() ? nullptr : found->second;
    if (old == nullptr || old->value != value.value) out.push_back(change_of(file, value.key, old, &value));
    if (old != nullptr) old_by_key.erase(found);
  }
  for (const KeyValue& value : old_values) {
    const auto left = old_by_key.find(value.key);
    if (left != old_by_key.end() && left->second == &value) out.push_back(change_of(file, value.key, &value, nullptr));
  }
}

bool same(const LightMap& a, const LightMap& b) {
  if (a.columns != b.columns || a.rows != b.rows) return false;
  const auto cells = std::ptrdiff_t{a.columns} * a.rows;
  return std::equal(a.illumination.begin(), a.illumination.end(), b.illumination.begin(),
                    [&](const auto& x, const auto& y) { return std::equal(x.begin(), x.begin() + cells, y.begin()); });
}

}  // namespace

std::vector<Change> difference(const Configuration& before, const Configuration& after) {
  std::vector<Change> changes;
  compare(FileKind::kBoard, before.board, after.board, changes);
  compare(FileKind::kVenue, before.venue, after.venue, changes);
  const bool map_is_listed = std::any_of(changes.begin(), changes.end(), [](const Change& change) {
    return change.file == FileKind::kVenue && change.key == "light.map";
  });
  // The calibration writes a new picture under the old name.
  const bool both_have_one = !before.venue.light.map.empty() && !after.venue.light.map.empty();
  if (!map_is_listed && both_have_one && !same(before.pipeline.scan.light, after.pipeline.scan.light)) {
    changes.push_back({FileKind::kVenue, "light.map", {}, {}});
  }
  compare(FileKind::kTeam, before.team, after.team, changes);
  return changes;
}

std::string text_of(const Change& change) {
  if (change.before.empty() && change.after.empty()) return change.key;
  return change.key + " " + change.before + " -> " + change.after;
}

}  // namespace touchline::config
