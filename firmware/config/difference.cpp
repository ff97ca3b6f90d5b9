#include "firmware/config/difference.h"

#include <algorithm>
#include <map>

#include "core/parameter_copy.h"
#include "firmware/config/toml_writer.h"

namespace touchline::config {
namespace {

struct KeyValue {
  std::string key, value;
  Reload reload = Reload::kRestart;
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
  void number(const T& value, const Key& key) {
    add(key, value_text(value));
  }
  template <class Container>
  void numbers(const Container& values, const Key& key) {
    add(key, list_text(values));
  }
  void flag(const bool& value, const Key& key) { add(key, value ? "true" : "false"); }
  void text(const std::string& value, const Key& key) { add(key, toml_string(value)); }
  void texts(const std::vector<std::string>& values, const Key& key) { add(key, list_text(values)); }
  template <class Enum, class Choices>
  void choice(const Enum& value, const Choices& choices, const Key& key) {
    add(key, toml_string(config::word_of(value, choices)));
  }
  template <class Struct>
  void section(const Struct& value, const Key& key) {
    const std::string outer_prefix = prefix_;
    const Reload outer_reload = reload_;
    prefix_.append(key.name).append(".");
    reload_ = inherited(key.reload, reload_);
    Struct::describe(value, *this);
    prefix_ = outer_prefix;
    reload_ = outer_reload;
  }
  template <class Container>
  void list(const Container& values, const Key& key) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      std::string name = element(key.name, i);
      if constexpr (requires { values[i].name; }) name = std::string(key.name) + "." + values[i].name;
      const Reload reload = inherited(key.reload, reload_);
      values_.push_back({prefix_ + name, TomlWriter::text_of(values[i], false), reload, true});
    }
  }

 private:
  void add(const Key& key, std::string value) {
    values_.push_back({prefix_ + std::string(key.name), std::move(value), inherited(key.reload, reload_), false});
  }

  std::string prefix_;
  Reload reload_ = Reload::kRestart;
  std::vector<KeyValue> values_;
};

// `present`: the value before or after the change, whichever exists.
Change change_of(FileKind file, const KeyValue& present, const KeyValue* before, const KeyValue* after) {
  Change change{file, present.key, {}, {}, present.reload};
  if (present.is_element) return change;
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
    if (old == nullptr || old->value != value.value) out.push_back(change_of(file, value, old, &value));
    if (old != nullptr) old_by_key.erase(found);
  }
  for (const KeyValue& value : old_values) {
    const auto left = old_by_key.find(value.key);
    if (left != old_by_key.end() && left->second == &value) out.push_back(change_of(file, value, &value, nullptr));
  }
}

bool same(const LightMap& a, const LightMap& b) {
  if (a.columns != b.columns || a.rows != b.rows) return false;
  const auto cells = std::ptrdiff_t{a.columns} * a.rows;
  return std::equal(a.illumination.begin(), a.illumination.end(), b.illumination.begin(),
                    [&](const auto& x, const auto& y) { return std::equal(x.begin(), x.begin() + cells, y.begin()); });
}

bool same(const LightReference& a, const LightReference& b) {
  return a.columns == b.columns && a.rows == b.rows && a.colors.sum == b.colors.sum;
}

}  // namespace

std::vector<Change> difference(const Configuration& before, const Configuration& after) {
  std::vector<Change> changes;
  compare(FileKind::kBoard, before.board, after.board, changes);
  compare(FileKind::kVenue, before.venue, after.venue, changes);
  // The folders may contain different pictures under the same name.
  const auto add_picture = [&changes](const char* key, const std::string& old_name, const std::string& new_name,
                                      const auto& old_picture, const auto& new_picture) {
    if (old_name.empty() || old_name != new_name || same(old_picture, new_picture)) return;
    changes.push_back({FileKind::kVenue, key, {}, {}, Reload::kThresholds});
  };
  const LightEntry &old_light = before.venue.light, &new_light = after.venue.light;
  add_picture("light.map", old_light.map, new_light.map, before.pipeline.scan.light, after.pipeline.scan.light);
  add_picture("light.reference", old_light.reference, new_light.reference, before.pipeline.adaptation.reference,
              after.pipeline.adaptation.reference);
  compare(FileKind::kTeam, before.team, after.team, changes);
  return changes;
}

std::string text_of(const Change& change) {
  if (change.before.empty() && change.after.empty()) return change.key;
  return change.key + " " + change.before + " -> " + change.after;
}

}  // namespace touchline::config
