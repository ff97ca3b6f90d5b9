#include "firmware/console/bug_report.h"

#include <array>
#include <ctime>
#include <exception>
#include <filesystem>
#include <memory>
#include <utility>

#include "firmware/console/tar_archive.h"
#include "firmware/console/versions_text.h"
#include "hal/files/input_file.h"
#include "hal/replay/picture.h"

namespace touchline::console {
namespace {

// A light map has at most some 100 KB; the limit allows for any picture with one pixel per cell.
constexpr std::size_t kMaxVenuePictureBytes = std::size_t{8} << 20;
// Buffer for one state; a state of 22 robots has 12 KB.
constexpr std::size_t kStateBytes = std::size_t{64} * 1024;

constexpr const char* kReadme =
    "A bug report of Touchline. It contains no token and no key, but the names of files and what the camera saw.\n"
    "\n"
    "versions.txt        program, libraries, kernel, processor\n"
    "picture.png         what the camera saw; its number is in results.jsonl\n"
    "results.jsonl       the results of the last ten seconds: a message \"state\" per frame "
    "(docs/console-protocol.md)\n"
    "status.json         latency since the start and in the last minute, lost frames, radio\n"
    "hello.json          camera, robots, colors and field, as a page gets them\n"
    "events.jsonl        the last lines of the log\n"
    "configuration.toml  all keys with their values, also the defaults\n"
    "files/              board, venue and team file, and the venue's pictures\n"
    "\n"
    "To recognize the picture again, in this folder:\n"
    "touchline-replay picture.png --venue files/venue.toml --team files/team.toml --out -\n";

/// Adds files to the archive, without the secret.
class ReportFiles {
 public:
  explicit ReportFiles(const BugReportContent& content)
      : content_(content), archive_(bug_report_name(content), unix_s(content)) {}

  void add_text(std::string_view name, std::string text) {
    const std::string& secret = content_.secret;
    for (std::size_t at = 0; !secret.empty() && (at = text.find(secret, at)) != std::string::npos;) {
      text.replace(at, secret.size(), "(removed)");
    }
    archive_.add(name, text);
  }
  void add_bytes(std::string_view name, std::string_view bytes) { archive_.add(name, bytes); }
  void note_missing(const std::string& what) { missing_ += "\nMissing: " + what; }
  std::string finish() {
    add_text("README.txt", kReadme + missing_ + (missing_.empty() ? "" : "\n"));
    return archive_.finish();
  }

  static std::int64_t unix_s(const BugReportContent& content) {
    return std::chrono::duration_cast<std::chrono::seconds>(content.unix_time.to_unix(content.made)).count();
  }

 private:
  const BugReportContent& content_;
  TarArchive archive_;
  std::string missing_;
};

void add_picture(ReportFiles& files, const BugReportContent& content) {
  if (content.frame.width_px == 0) return files.note_missing("picture.png: the camera delivered none.");
  Frame frame = content.frame;
  const PictureLayout layout = picture_layout(frame.format, frame.width_px, frame.height_px);
  for (std::size_t plane = 0; plane < info_of(frame.format).planes; ++plane) {
    frame.plane[plane] = content.pixels.data() + layout.offset_bytes[plane];
    frame.stride_bytes[plane] = layout.stride_bytes[plane];
  }
  hal::Picture picture;
  picture.width_px = frame.width_px;
  picture.height_px = frame.height_px;
  picture.rgb8.reserve(std::size_t{3} * frame.width_px * frame.height_px);
  for (std::size_t v = 0; v < frame.height_px; ++v) {
    for (std::size_t u = 0; u < frame.width_px; ++u) {
      const std::array<std::uint8_t, 3> rgb = to_rgb8(pixel_at(frame, u, v), color_space(frame.format));
      picture.rgb8.insert(picture.rgb8.end(), rgb.begin(), rgb.end());
    }
  }
  const Result<std::string> png = hal::encode_png(picture);
  if (!png.ok()) return files.note_missing("picture.png: " + png.text());
  files.add_bytes("picture.png", png.value());
}

void add_results(ReportFiles& files, const BugReportContent& content) {
  std::string text, line(kStateBytes, '\0');
  for (const Snapshot& snapshot : content.snapshots) {
    report::JsonWriter json(line);
    write_state(json, content.scene, snapshot, content.console, content.unix_time);
    json.line_end();
    if (json.fits()) text.append(line, 0, json.size());
  }
  if (text.empty()) files.note_missing("results: no frame was processed.");
  files.add_text("results.jsonl", std::move(text));
}

void add_events(ReportFiles& files, const BugReportContent& content) {
  std::string text, line;
  for (const Event& event : content.events) {
    // Escaping replaces a byte by at most six, as in "\u001f".
    line.resize(6 * event.text.size() + 256);
    report::JsonWriter json(line);
    write_event(json, event);
    json.line_end();
    if (json.fits()) text.append(line, 0, json.size());
  }
  files.add_text("events.jsonl", std::move(text));
}

void add_configuration(ReportFiles& files, const config::Configuration& configuration) {
  files.add_text("configuration.toml", config::dump(configuration));
  for (const config::Locations* const where :
       {&configuration.board_where, &configuration.venue_where, &configuration.team_where}) {
    const Result<std::string> text = hal::read_file(where->file(), hal::kMaxTextFileBytes);
    const std::string name = std::filesystem::path(where->file()).filename().string();
    if (text.ok()) {
      files.add_text("files/" + name, text.value());
    } else {
      files.note_missing(text.text());
    }
  }
  const std::filesystem::path folder = std::filesystem::path(configuration.venue_where.file()).parent_path();
  const config::LightEntry& light = configuration.venue.light;
  for (const std::string& name : {light.map, light.reference}) {
    if (name.empty()) continue;
    const Result<std::string> bytes = hal::read_file((folder / name).string(), kMaxVenuePictureBytes);
    // A venue may name any file, so check that it is a picture before it leaves the board.
    const bool is_picture = bytes.ok() && bytes.value().starts_with("\x89PNG\r\n\x1a\n");
    if (is_picture) {
      files.add_bytes("files/" + std::filesystem::path(name).filename().string(), bytes.value());
    } else {
      files.note_missing(bytes.ok() ? name + ": is not a PNG picture" : bytes.text());
    }
  }
}

}  // namespace

std::string bug_report_name(const BugReportContent& content) {
  const std::time_t time = ReportFiles::unix_s(content);
  std::tm parts{};
  std::array<char, 64> text{};
  std::strftime(text.data(), text.size(), "touchline-bug-report-%Y%m%d-%H%M%S", ::gmtime_r(&time, &parts));
  return text.data();
}

std::string make_bug_report(const BugReportContent& content) {
  ReportFiles files(content);
  files.add_text("versions.txt", versions_text(content.scene));
  files.add_text("hello.json", content.hello);
  files.add_text("status.json", content.status);
  add_events(files, content);
  add_configuration(files, *content.scene.configuration);
  add_results(files, content);
  add_picture(files, content);
  return files.finish();
}

}  // namespace touchline::console
