#include "tools/programs/calibrate/venue/venue_draft.h"

#include <filesystem>

#include "firmware/config/file_replacement.h"
#include "firmware/config/light_map_file.h"
#include "firmware/config/section_writer.h"
#include "firmware/config/toml_file.h"

namespace touchline::calibrate {
namespace {

// Checks all keys that are present and requires none.
struct DraftFile : config::VenueFile {
  static constexpr std::array<std::string_view, 0> kRequired{};
};

}  // namespace

Status read_draft(const std::string& path, VenueDraft& out, std::string& reason) {
  out = {};
  std::error_code error;
  out.exists = std::filesystem::exists(path, error);
  if (!out.exists) return {};
  DraftFile file;
  config::Locations where;
  config::Problems problems;
  const Status status = config::read_toml(path, "", {}, file, where, problems);
  if (!status.ok()) {
    reason = problems.text();
    while (!reason.empty() && reason.back() == '\n') reason.pop_back();
    return status;
  }
  out.file = file;
  const auto& roi = file.region_of_interest;
  if (roi.u_px.size() != roi.v_px.size() || roi.u_px.size() > kMaxPolygonPoints) {
    reason = where.of("region_of_interest") + ": region_of_interest: u_px and v_px need one value a corner, at most " +
             std::to_string(kMaxPolygonPoints);
    return ErrorCode::kInconsistent;
  }
  for (std::size_t i = 0; i < roi.u_px.size(); ++i) out.region_of_interest.push_back({roi.u_px[i], roi.v_px[i]});
  if (file.light.map.empty()) return {};
  const std::string map = (std::filesystem::path(path).parent_path() / file.light.map).string();
  const Status light = config::read_light_map(map, out.light, reason);
  if (!light.ok()) reason = where.of("light.map") + ": light.map: " + reason;
  return light;
}

Status write_sections(const std::string& path, const std::vector<Section>& sections, std::string& reason) {
  std::string content;
  bool exists = false;
  if (Status s = config::read_text(path, content, exists, reason); !s.ok()) return s;
  if (!exists) content = "version = 1\n";
  for (const Section& section : sections) {
    std::string changed;
    if (Status s = config::replace_section(content, section.name, section.toml, changed, reason); !s.ok()) {
      reason.insert(0, path + ": ");
      return s;
    }
    content = changed;
  }
  return config::replace_file(path, content, reason);
}

}  // namespace touchline::calibrate
