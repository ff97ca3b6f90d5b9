#pragma once

#include <string>
#include <vector>

#include "core/light/light_map.h"
#include "core/region/region_scanner.h"
#include "firmware/config/toml_writer.h"
#include "firmware/config/venue_file.h"
#include "hal/result.h"

namespace touchline::calibrate {

/// A venue file that may be incomplete: missing sections have their defaults.
struct VenueDraft {
  config::VenueFile file;
  Polygon region_of_interest;
  LightMap light;
  bool exists = false;
};

/// Returns whether the field was calibrated.
bool has_camera_model(const VenueDraft& draft);

/// Reads a venue file. A file that does not exist gives an empty draft. kInconsistent and the errors of the light map:
/// the message names file, line and key.
Result<VenueDraft> read_draft(const std::string& path);

/// Name and TOML text of one section.
struct Section {
  std::string name, toml;
};

namespace detail {
template <class Struct>
struct Titled {
  const std::string& name;
  const Struct& value;
  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.section(self.value, {.name = self.name});
  }
};
template <class Struct>
struct TitledList {
  const std::string& name;
  const std::vector<Struct>& values;
  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.list(self.values, {.name = self.name});
  }
};
}  // namespace detail

/// Formats a table as a section, with a comment line above its header unless `remark` is empty.
template <class Struct>
Section section_of(const std::string& name, const Struct& value, const std::string& remark) {
  Section section{name, config::TomlWriter::text_of(detail::Titled<Struct>{name, value}, false)};
  section.toml.erase(0, section.toml.find_first_not_of('\n'));
  if (!remark.empty()) section.toml.insert(0, "# " + remark + "\n");
  return section;
}

/// Formats a list of tables, [[name]].
template <class Struct>
Section section_of(const std::string& name, const std::vector<Struct>& values) {
  Section section{name, config::TomlWriter::text_of(detail::TitledList<Struct>{name, values}, false)};
  section.toml.erase(0, section.toml.find_first_not_of('\n'));
  return section;
}

/// Replaces these sections, either all or none, and leaves the rest of the file as it is. The former version is kept as
/// PATH.bak. Errors: as config::write_section().
Result<void> write_sections(const std::string& path, const std::vector<Section>& sections);

}  // namespace touchline::calibrate
