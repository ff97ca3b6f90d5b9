#include "firmware/recording/recording_shelf.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <tuple>

#include "firmware/recording/recorder.h"
#include "firmware/recording/recording_files.h"

namespace touchline::recording {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

Json json_of(const RecordingFacts& facts, const std::string& name, bool is_growing) {
  return {{"name", name},
          {"bytes", facts.bytes},
          {"growing", is_growing},
          {"complete", facts.is_complete},
          {"date", date_of(name)},
          {"duration_s", static_cast<double>(facts.end_ns - facts.begin_ns) * 1e-9},
          {"frames", facts.frames},
          {"goals", facts.goals},
          {"stops", facts.stops},
          {"lost", facts.lost},
          {"score", Json::parse(facts.score)},
          {"problem", facts.problem}};
}

}  // namespace

RecordingShelf::RecordingShelf(std::string folder, const Recorder* recorder) : folder_(std::move(folder)) {
  if (recorder == nullptr) return;
  status_ = recorder->status_reader();
  control_ = recorder->control();
}

std::optional<console::RecordingStatus> RecordingShelf::status() const {
  if (!status_) return std::nullopt;
  return status_();
}

Result<void> RecordingShelf::set_on(bool on, const std::string& who) {
  if (!control_) return failure(ErrorCode::kUnsupported, "nothing can be recorded: the log says why");
  control_(on, who);
  return {};
}

Result<std::string> RecordingShelf::path_of(const std::string& name) const {
  std::string path = (fs::path(folder_) / name).string();
  std::error_code unknown;
  if (!is_recording_name(name) || !fs::is_regular_file(fs::symlink_status(path, unknown))) {
    return failure(ErrorCode::kNotFound, "there is no recording of this name");
  }
  return path;
}

Result<RecordingView*> RecordingShelf::view_of(const std::string& name, bool is_fresh) {
  TOUCHLINE_TRY_ASSIGN(const std::string path, path_of(name));
  if (!is_fresh && view_ && shown_ == name) return view_.get();
  view_.reset();  // before the next one needs its memory
  auto view = std::make_unique<RecordingView>();
  TOUCHLINE_TRY(view->open(path));
  view_ = std::move(view);
  shown_ = name;
  return view_.get();
}

Result<std::string> RecordingShelf::list() {
  std::vector<std::string> names = names_in(folder_);
  std::erase_if(known_,
                [&](const auto& entry) { return std::find(names.begin(), names.end(), entry.first) == names.end(); });
  Json recordings = Json::array();
  for (const std::string& name : names) {
    const std::string path = (fs::path(folder_) / name).string();
    const bool is_growing = is_being_written(path);
    std::error_code unknown;
    const std::uintmax_t bytes = fs::file_size(path, unknown);
    const auto known = known_.find(name);
    if (known != known_.end() && known->second.bytes == bytes && !is_growing) {
      recordings.push_back(json_of(known->second, name, false));
      continue;
    }
    RecordingView view;
    const Result<void> opened = view.open(path);
    RecordingFacts facts = view.facts();
    facts.problem = opened.ok() ? std::string() : opened.text();
    facts.bytes = unknown ? 0 : std::uint64_t{bytes};
    if (!is_growing) known_[name] = facts;
    recordings.push_back(json_of(facts, name, is_growing));
  }
  return Json{{"folder", folder_}, {"recordings", std::move(recordings)}}.dump(-1, ' ', false,
                                                                               Json::error_handler_t::replace);
}

Result<std::string> RecordingShelf::describe(const std::string& name) {
  TOUCHLINE_TRY_ASSIGN(RecordingView* const view, view_of(name, true));
  return view->description(name);
}

Result<std::string> RecordingShelf::frames(const std::string& name, const console::FrameRange& range) {
  TOUCHLINE_TRY_ASSIGN(RecordingView* const view, view_of(name, false));
  return view->frames(range);
}

Result<std::uint64_t> RecordingShelf::size(const std::string& name) {
  TOUCHLINE_TRY_ASSIGN(const std::string path, path_of(name));
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (error) return failure(ErrorCode::kIo, "%s: %s", path.c_str(), error.message().c_str());
  return std::uint64_t{bytes};
}

Result<std::string> RecordingShelf::read(const std::string& name, std::uint64_t offset, std::uint64_t bytes) {
  TOUCHLINE_TRY_ASSIGN(const std::string path, path_of(name));
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  std::string out(static_cast<std::size_t>(bytes), '\0');
  const ssize_t count = file < 0 ? -1 : ::pread(file, out.data(), out.size(), static_cast<off_t>(offset));
  const int error = errno;
  if (file >= 0) ::close(file);
  if (count < 0) return failure(ErrorCode::kIo, "%s: %s", path.c_str(), std::strerror(error));
  out.resize(static_cast<std::size_t>(count));
  return out;
}

Result<void> RecordingShelf::remove(const std::string& name) {
  TOUCHLINE_TRY_ASSIGN(const std::string path, path_of(name));
  if (is_being_written(path))
    return failure(ErrorCode::kBusy, "%s is being recorded: end the recording first", name.c_str());
  if (shown_ == name) view_.reset();
  std::error_code error;
  fs::remove(path, error);
  if (error) return failure(ErrorCode::kIo, "%s cannot be deleted: %s", path.c_str(), error.message().c_str());
  return {};
}

}  // namespace touchline::recording
