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
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <deque>
#include <filesystem>
#include <mutex>
#include <new>
#include <optional>
#include <span>
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

std::uint32_t recording_of(std::span<const std::byte> record) {
  std::uint32_t recording = 0;
  std::memcpy(&recording, record.data() + offsetof(StepParts, recording), sizeof(recording));
  return recording;
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
        tap(ring, static_cast<std::uint32_t>(plan.settings.every)),
        is_wanted(plan.settings.automatic == config::AutomaticRecording::kOn) {
    tap.end();
  }

  [[nodiscard]] std::optional<std::string> disk_shortage() const {
    const std::uint64_t reserve = static_cast<std::uint64_t>(plan.settings.reserve_mb) * kMegabyte;
    const std::optional<std::uint64_t> free = free_bytes(plan.folder);
    if (!free || *free >= reserve) return std::nullopt;
    return plan.folder + ": the disk has " + std::to_string(*free / kMegabyte) +
           " MB left, less than recording.reserve_mb = " + std::to_string(plan.settings.reserve_mb);
  }
  // A step without its configuration cannot be replayed, so only lines are dropped. What is put while no file is open
  // belongs to the next one as far as it still holds then.
  void put(Note note) {
    const std::scoped_lock lock(mutex);
    if (note.configuration) keep(note);
    if (!is_done && has_file && (note.configuration || notes.size() < kMaxWaiting)) notes.push_back(std::move(note));
  }
  void keep(const Note& note) {
    if (note.scene) {
      current = note;
      reload = {};
    } else if (current.configuration) {
      ConfigurationText files = *note.configuration;
      files.reload = 0;
      files.camera = current.configuration->camera;
      files.is_calibrated = current.configuration->is_calibrated;
      current.configuration = std::move(files);
      reload = note;
    }
  }
  Result<void> create_file();
  void write_file(const Print& print, bool is_last, bool& was_idle);
  Result<void> save_file(const Print& print);
  void end_file(const Print& print, const std::string& failure, bool is_last);
  void follow_half(const Print& print);
  [[nodiscard]] std::string text_of_file(const std::string& failure) const;
  void update_status(bool is_on, const std::string& ended);
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
  ByteRing ring;
  StepTap tap;
  std::atomic<bool> is_wanted, end{false};
  bool has_started = false;
  std::uint32_t reloads = 0;
  std::thread thread;

  // Of the thread, and of open() before.
  std::string name, path;
  std::unique_ptr<RecordingWriter> writer;          // null: nothing is being recorded
  std::uint32_t number = 0;                         // of the recording
  std::uint64_t lost_steps = 0, lost_pictures = 0;  // of the tap, when it began
  std::uint8_t half = 0;
  std::vector<std::string> to_print;
  bool has_reported_removal = false;  // of the quota, that failed
  WallClock::time_point next_save{};

  mutable std::mutex mutex;
  std::condition_variable has_ended;
  std::deque<Note> notes;
  Note current, reload;  // configuration of the session, with the last reload, which the loop may not have taken yet
  bool has_file = false, is_done = false, is_abandoned = false;
  console::RecordingStatus status;
  std::string wish;  // who has ended the recording
  std::string summary;
};

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

Result<void> Recorder::Shared::create_file() {
  name.clear();
  to_print = keep_quota_now();
  if (const auto shortage = disk_shortage()) {
    return touchline::failure(ErrorCode::kFull, "%s; nothing can be recorded", shortage->c_str());
  }
  auto next = std::make_unique<RecordingWriter>();
  Result<void> created;
  for (int i = 0; i < kNameAttempts; ++i) {
    name = next_name(recordings_in(plan.folder));
    path = (std::filesystem::path(plan.folder) / name).string();
    created = next->create(path, version);
    if (created.code() != ErrorCode::kInconsistent) break;
  }
  if (!created.ok()) return created;
  writer = std::move(next);
  lost_steps = tap.lost_steps();
  lost_pictures = tap.lost_pictures();
  update_status(true, {});
  Note session, last_reload;
  {
    const std::scoped_lock lock(mutex);
    has_file = true;
    notes.clear();
    session = current;
    last_reload = reload;
    summary.clear();
  }
  if (session.configuration) TOUCHLINE_TRY(write_note(session));
  if (last_reload.configuration) TOUCHLINE_TRY(write_note(last_reload));
  tap.begin(++number);
  return {};
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

Result<void> Recorder::Shared::write_note(const Note& note) {
  if (!note.configuration) return writer->add_line(note.level, note.line);
  if (note.scene) writer->begin_session(note.scene);
  return writer->add(*note.configuration);
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
    // A step that was on its way when the former recording ended.
    const bool is_of_file = recording_of(record) == number;
    Result<void> added = is_of_file ? writer->add_step(record) : Result<void>();
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

Result<void> Recorder::Shared::save_file(const Print& print) {
  if (WallClock::now() < next_save) return {};
  next_save = WallClock::now() + kSavePeriod;
  Result<void> result = writer->save();
  for (const std::string& line : keep_quota_now()) say(print, line);
  const std::optional<std::string> shortage = disk_shortage();
  if (result.ok() && shortage) return touchline::failure(ErrorCode::kFull, "%s", shortage->c_str());
  update_status(true, {});
  return result;
}

// One file for each half. Between the halves, and before and after the game, nothing is recorded.
void Recorder::Shared::follow_half(const Print& print) {
  const std::uint8_t now = tap.half();
  if (plan.settings.automatic != config::AutomaticRecording::kHalves || now == half) return;
  if (writer) {
    {
      const std::scoped_lock lock(mutex);
      wish = "the referee has announced another half";
    }
    end_file(print, {}, false);
  }
  half = now;
  is_wanted = half > 0;
}

// Begins, writes or ends the file.
void Recorder::Shared::write_file(const Print& print, bool is_last, bool& was_idle) {
  follow_half(print);
  Result<void> result;
  if (is_wanted && !writer && !is_last) {
    result = create_file();
    if (result.ok()) say(print, "recording " + path);
  } else if (!is_wanted && writer) {
    end_file(print, {}, false);
  }
  for (const std::string& line : std::exchange(to_print, {})) say(print, line);
  if (result.ok() && writer) result = write_waiting(was_idle);
  if (result.ok() && writer) result = save_file(print);
  if (!result.ok()) {
    is_wanted = false;
    end_file(print, result.text(), is_last);
  }
  // Nobody wants these any more.
  while (!writer && !ring.front().empty()) ring.pop();
}

void Recorder::Shared::end_file(const Print& print, const std::string& failure, bool is_last) {
  tap.end();
  std::string why = failure;
  bool was_idle = !why.empty();
  while (!was_idle && why.empty()) why = write_waiting(was_idle).text();
  {
    const std::scoped_lock lock(mutex);
    has_file = false;
    notes.clear();
  }
  if (writer) {
    const Result<void> closed = writer->close();
    if (why.empty()) why = closed.text();
  }
  std::string text = writer ? text_of_file(why) : std::string();
  std::string ended = why;
  {
    const std::scoped_lock lock(mutex);
    if (ended.empty()) ended = std::exchange(wish, {});
  }
  if (ended.empty()) ended = "the program has ended";
  update_status(false, ended);
  writer.reset();
  if (!why.empty()) say(print, "recording: ends: " + why);
  // The run ends with the lines of its last recording, and with why that one ended early.
  if (why.empty() && !is_last) {
    text.pop_back();
    say(print, text);
    text.clear();
  }
  const std::scoped_lock lock(mutex);
  summary = std::move(text);
}

void Recorder::Shared::update_status(bool is_on, const std::string& ended) {
  const std::scoped_lock lock(mutex);
  status.is_on = is_on;
  status.ended = ended;
  status.file = name;
  if (!writer) return;
  const RecordingCounts& counts = writer->counts();
  status.duration_s = static_cast<double>(counts.duration_ns) * 1e-9;
  status.frames = counts.steps;
  status.pictures = counts.pictures;
  status.bytes = counts.bytes;
  status.lost_frames = tap.lost_steps() - lost_steps;
  status.lost_pictures = tap.lost_pictures() - lost_pictures;
}

void Recorder::work(const std::shared_ptr<Shared>& shared, const Print& print) {
  // A limit of the file's size ends the recording, not the program.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGXFSZ);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::string failure;
  try {
    for (;;) {
      const bool is_last = shared->end.load(std::memory_order_acquire);
      bool was_idle = true;
      shared->write_file(print, is_last, was_idle);
      if (was_idle && is_last) break;
      if (was_idle) std::this_thread::sleep_for(kIdlePause);
    }
    if (shared->writer) shared->end_file(print, {}, true);
  } catch (const std::exception& error) {
    failure = error.what();
  }
  shared->tap.end();
  if (!failure.empty()) {
    shared->say(print, "recording: ends: " + failure);
    shared->update_status(false, failure);
  }
  const std::scoped_lock lock(shared->mutex);
  if (!failure.empty()) shared->summary = "recording " + shared->path + " ended early: " + failure + "\n";
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
  return shared_->summary;
}

std::string Recorder::Shared::text_of_file(const std::string& failure) const {
  const RecordingCounts& counts = writer->counts();
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), ": %" PRIu64 " steps, %" PRIu64 " pictures, %.1f MB", counts.steps,
                counts.pictures, static_cast<double>(counts.bytes) / kMegabyte);
  std::string line = "recording " + path + text.data();
  const std::uint64_t steps = tap.lost_steps() - lost_steps, pictures = tap.lost_pictures() - lost_pictures;
  if (pictures > 0) line += ", " + std::to_string(pictures) + " pictures lost";
  if (steps > 0) line += ", " + std::to_string(steps) + " steps lost";
  if (!failure.empty()) line += "; it ended early: " + failure;
  return line + "\n" + writer->hash().line();
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
