#include "firmware/recording/recorder.h"

#include <chrono>
#include <filesystem>
#include <new>
#include <utility>

#include "firmware/recording/recorder_parts.h"

namespace touchline::recording {
namespace {

using namespace std::chrono_literals;
// The longest time for which a disk may block the end of the program. Robots already stand then.
constexpr auto kPatience = 10s;
Result<void> check_folder(const std::string& folder) {
  using std::filesystem::file_type;
  std::error_code error;
  const file_type type = std::filesystem::status(folder, error).type();
  if (type == file_type::directory) return {};
  if (type == file_type::not_found) {
    return touchline::failure(ErrorCode::kNotFound, "%s: no such folder for recordings; make it: mkdir -p %s",
                              folder.c_str(), folder.c_str());
  }
  if (!error) return touchline::failure(ErrorCode::kInconsistent, "%s: not a folder for recordings", folder.c_str());
  return touchline::failure(error == std::errc::permission_denied ? ErrorCode::kPermission : ErrorCode::kIo,
                            "%s: the folder for recordings cannot be used: %s", folder.c_str(),
                            error.message().c_str());
}

}  // namespace

RecordingPlan plan_recording(const config::Configuration& configuration, const std::string& folder) {
  RecordingPlan plan{folder, configuration.board.recording};
  if (folder.empty() && !plan.settings.folder.empty()) {
    const auto board = std::filesystem::path(configuration.board_where.file()).parent_path();
    plan.folder = (board / plan.settings.folder).lexically_normal().string();
  }
  // Who asks for a recording on the command line gets one.
  auto& automatic = plan.settings.automatic;
  if (!folder.empty() && automatic == config::AutomaticRecording::kOff) automatic = config::AutomaticRecording::kOn;
  return plan;
}

Result<std::unique_ptr<Recorder>> Recorder::open(const RecordingPlan& plan, const std::string& version) {
  TOUCHLINE_TRY(check_folder(plan.folder));
  std::shared_ptr<Shared> shared;
  try {
    shared = std::make_shared<Shared>(plan, version);
  } catch (const std::bad_alloc&) {
    return touchline::failure(ErrorCode::kFull, "recording.memory_mb = %d: not enough memory", plan.settings.memory_mb);
  }
  if (shared->is_wanted) TOUCHLINE_TRY(shared->create_file());
  return std::unique_ptr<Recorder>(new Recorder(std::move(shared)));
}

Recorder::~Recorder() {
  finish();
  if (!shared_->has_started && shared_->writer) shared_->writer->discard();
}

StepTap& Recorder::tap() { return shared_->tap; }

void Recorder::start(const Print& print) {
  if (shared_->has_started) return;
  shared_->thread = std::thread([shared = shared_, print] { work(shared, print); });
  shared_->has_started = true;
}

void Recorder::begin_session(const Session& session, bool waits) {
  shared_->tap.begin_session(waits);
  shared_->reloads = 0;
  Shared::Note note;
  note.configuration = text_of(session.configuration());
  note.configuration->session = shared_->tap.session();
  note.configuration->version = shared_->version;
  note.configuration->camera = session.camera_info().description;
  note.configuration->is_calibrated = session.is_calibrated();
  auto scene = std::make_shared<console::Scene>(
      console::scene_of(session.shared_configuration(), session.camera_info(), shared_->version));
  scene->is_calibrated = session.is_calibrated();
  note.scene = std::move(scene);
  shared_->put(std::move(note));
}

void Recorder::add_reload(const config::Configuration& files) {
  Shared::Note note;
  note.configuration = text_of(files);
  note.configuration->session = shared_->tap.session();
  note.configuration->reload = ++shared_->reloads;
  note.configuration->version = shared_->version;
  shared_->put(std::move(note));
}

void Recorder::add_line(const std::string& level, const std::string& line) {
  Shared::Note note;
  note.level = level;
  note.line = line;
  shared_->put(std::move(note));
}

void Recorder::finish() {
  if (!shared_->thread.joinable()) return;
  shared_->end.store(true, std::memory_order_release);
  std::unique_lock lock(shared_->mutex);
  const bool is_done = shared_->has_ended.wait_for(lock, kPatience, [this] { return shared_->is_done; });
  shared_->is_abandoned = !is_done;
  lock.unlock();
  if (is_done) {
    shared_->thread.join();
  } else {
    shared_->thread.detach();
  }
}

std::string Recorder::summary() const {
  const std::scoped_lock lock(shared_->mutex);
  if (!shared_->is_done) return "recording " + shared_->path + ": the disk does not answer; the file has no end\n";
  return shared_->summary;
}

std::function<console::RecordingStatus()> Recorder::status_reader() const {
  return [shared = shared_] {
    const std::scoped_lock lock(shared->mutex);
    return shared->status;
  };
}

std::function<void(bool, const std::string&)> Recorder::control() const {
  return [shared = shared_](bool on, const std::string& who) {
    const std::scoped_lock lock(shared->mutex);
    shared->wish = on ? std::string() : who;
    shared->is_wanted = on;
  };
}

}  // namespace touchline::recording
