#include "firmware/recording/recorder.h"

#include <pthread.h>
#include <sys/statvfs.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cinttypes>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <mutex>
#include <new>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "firmware/recording/recording_files.h"
#include "firmware/recording/recording_writer.h"

namespace touchline::recording {
namespace {

using namespace std::chrono_literals;
using WallClock = std::chrono::steady_clock;

constexpr std::uint64_t kMegabyte = 1'000'000;
// A power cut costs at most this much, and the page cache never holds more than a disk writes in a moment.
constexpr auto kSavePeriod = 1s;
// Pause when nothing is waiting: a tenth of a frame at 60 Hz.
constexpr auto kIdlePause = 2ms;
// The longest time for which a disk may block the end of the program. Robots already stand then.
constexpr auto kPatience = 10s;
// Lines come seldom: so many wait only for a disk that blocks.
constexpr std::size_t kMaxWaiting = 1000;
// Several programs may begin a recording in the same folder at the same time.
constexpr int kNameAttempts = 10;

std::optional<std::uint64_t> free_bytes(const std::string& folder) {
  struct statvfs status {};
  if (::statvfs(folder.c_str(), &status) != 0) return std::nullopt;
  return std::uint64_t{status.f_bavail} * status.f_frsize;
}

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

struct Recorder::Shared {
  /// What other threads than the loop's want to have recorded.
  struct Note {
    std::optional<ConfigurationText> configuration{};
    std::shared_ptr<const console::Scene> scene{};  // with the configuration of a session
    std::string level{}, line{};
  };

  Shared(const RecordingPlan& the_plan, std::string the_version)
      : plan(the_plan),
        version(std::move(the_version)),
        ring(static_cast<std::size_t>(plan.settings.memory_mb) * kMegabyte),
        tap(ring, static_cast<std::uint32_t>(plan.settings.every)) {}

  [[nodiscard]] std::optional<std::string> disk_shortage() const {
    const std::uint64_t reserve = static_cast<std::uint64_t>(plan.settings.reserve_mb) * kMegabyte;
    const std::optional<std::uint64_t> free = free_bytes(plan.folder);
    if (!free || *free >= reserve) return std::nullopt;
    return plan.folder + ": the disk has " + std::to_string(*free / kMegabyte) +
           " MB left, less than recording.reserve_mb = " + std::to_string(plan.settings.reserve_mb);
  }
  // A step without its configuration cannot be replayed, so only lines are dropped.
  void put(Note note) {
    const std::scoped_lock lock(mutex);
    if (!is_done && (note.configuration || notes.size() < kMaxWaiting)) notes.push_back(std::move(note));
  }
  Result<void> write_waiting(bool& was_idle);
  Result<void> write_notes(bool& was_idle);
  Result<void> write_note(const Note& note);
  // Returns lines that say what was deleted, and what could not be.
  std::vector<std::string> keep_quota_now();
  // Prints, unless nobody waits for the thread any more.
  void say(const Print& print, const std::string& line) {
    const std::scoped_lock lock(mutex);
    if (!is_abandoned) print(line);
  }

  const RecordingPlan plan;
  const std::string version;
  std::string name, path;
  ByteRing ring;
  StepTap tap;
  RecordingWriter writer;                // of the thread
  std::vector<std::string> first_lines;  // of open(), for the thread to print
  bool has_reported_removal = false;     // of the quota, that failed
  std::uint32_t reloads = 0;
  bool has_started = false;
  std::thread thread;

  std::atomic<bool> end{false};
  std::mutex mutex;
  std::condition_variable has_ended;
  std::deque<Note> notes;
  bool is_done = false, is_abandoned = false;
  std::string failure;  // why the recording ended early
};

RecordingPlan plan_recording(const config::Configuration& configuration, const std::string& folder) {
  RecordingPlan plan{folder, configuration.board.recording};
  if (folder.empty() && !plan.settings.folder.empty()) {
    const auto board = std::filesystem::path(configuration.board_where.file()).parent_path();
    plan.folder = (board / plan.settings.folder).lexically_normal().string();
  }
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
  shared->first_lines = shared->keep_quota_now();
  if (const auto shortage = shared->disk_shortage()) {
    return touchline::failure(ErrorCode::kFull, "%s; nothing can be recorded", shortage->c_str());
  }
  Result<void> created;
  for (int i = 0; i < kNameAttempts; ++i) {
    shared->name = next_name(recordings_in(plan.folder));
    shared->path = (std::filesystem::path(plan.folder) / shared->name).string();
    created = shared->writer.create(shared->path, version);
    if (created.code() != ErrorCode::kInconsistent) break;
  }
  if (!created.ok()) return created.error();
  return std::unique_ptr<Recorder>(new Recorder(std::move(shared)));
}

Recorder::~Recorder() {
  finish();
  if (!shared_->has_started) shared_->writer.discard();
}

StepTap& Recorder::tap() { return shared_->tap; }
const std::string& Recorder::path() const { return shared_->path; }

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
  note.scene = std::make_shared<const console::Scene>(
      console::scene_of(session.shared_configuration(), session.camera_info(), shared_->version));
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

Result<void> Recorder::Shared::write_note(const Note& note) {
  if (!note.configuration) return writer.add_line(note.level, note.line);
  if (note.scene) writer.begin_session(note.scene);
  return writer.add(*note.configuration);
}

Result<void> Recorder::Shared::write_waiting(bool& was_idle) {
  was_idle = true;
  // The disk's state is looked at again after so many steps.
  constexpr int kSteps = 64;
  for (int i = 0; i < kSteps; ++i) {
    const std::span<const std::byte> record = ring.front();
    // The configuration that a step needs was put before the step, and precedes it in the file.
    TOUCHLINE_TRY(write_notes(was_idle));
    if (record.empty()) break;
    was_idle = false;
    Result<void> added = writer.add_step(record);
    ring.pop();
    if (!added.ok()) return added;
  }
  return {};
}

Result<void> Recorder::Shared::write_notes(bool& was_idle) {
  std::deque<Note> waiting;
  {
    const std::scoped_lock lock(mutex);
    waiting.swap(notes);
  }
  for (const Note& note : waiting) {
    was_idle = false;
    TOUCHLINE_TRY(write_note(note));
  }
  return {};
}

std::vector<std::string> Recorder::Shared::keep_quota_now() {
  const std::uint64_t quota = static_cast<std::uint64_t>(plan.settings.quota_mb) * kMegabyte;
  if (quota == 0) return {};
  const std::string key = "recording.quota_mb = " + std::to_string(plan.settings.quota_mb);
  const QuotaRemovals removals = keep_quota(plan.folder, name, quota);
  std::vector<std::string> lines;
  for (const std::string& deleted : removals.deleted) {
    lines.push_back("recording: " + deleted);
    lines.back() += " was deleted to keep " + key;
  }
  if (!removals.failure.empty() && !has_reported_removal) {
    has_reported_removal = true;
    lines.push_back("recording: " + key + " cannot be kept: " + removals.failure);
  }
  return lines;
}

void Recorder::work(const std::shared_ptr<Shared>& shared, const Print& print) {
  // A limit of the file's size ends the recording, not the program.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGXFSZ);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::string failure;
  try {
    for (const std::string& line : shared->first_lines) shared->say(print, line);
    auto next_save = WallClock::now();
    Result<void> result;
    while (result.ok()) {
      const bool is_last = shared->end.load(std::memory_order_acquire);
      bool was_idle = false;
      result = shared->write_waiting(was_idle);
      if (result.ok() && WallClock::now() >= next_save) {
        next_save = WallClock::now() + kSavePeriod;
        result = shared->writer.save();
        for (const std::string& line : shared->keep_quota_now()) shared->say(print, line);
        const std::optional<std::string> shortage = shared->disk_shortage();
        if (result.ok() && shortage) result = touchline::failure(ErrorCode::kFull, "%s", shortage->c_str());
      }
      if (was_idle && is_last) break;
      if (was_idle) std::this_thread::sleep_for(kIdlePause);
    }
    failure = result.text();
    const Result<void> closed = shared->writer.close();
    if (failure.empty()) failure = closed.text();
  } catch (const std::exception& error) {
    failure = error.what();
  }
  shared->tap.end();
  if (!failure.empty()) shared->say(print, "recording: ends: " + failure);
  const std::scoped_lock lock(shared->mutex);
  shared->failure = failure;
  shared->is_done = true;
  shared->notes.clear();
  shared->has_ended.notify_all();
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
  const RecordingCounts& counts = shared_->writer.counts();
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), ": %" PRIu64 " steps, %" PRIu64 " pictures, %.1f MB", counts.steps,
                counts.pictures, static_cast<double>(counts.bytes) / kMegabyte);
  std::string line = "recording " + shared_->path + text.data();
  const std::uint64_t steps = shared_->tap.lost_steps(), pictures = shared_->tap.lost_pictures();
  if (pictures > 0) line += ", " + std::to_string(pictures) + " pictures lost";
  if (steps > 0) line += ", " + std::to_string(steps) + " steps lost";
  if (!shared_->failure.empty()) line += "; it ended early: " + shared_->failure;
  return line + "\n" + shared_->writer.hash().line();
}

}  // namespace touchline::recording
