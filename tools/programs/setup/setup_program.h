#pragma once

#include <chrono>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/files/text_output.h"
#include "hal/linux/network/unix_listener.h"
#include "hal/result.h"
#include "tools/programs/setup/arguments.h"
#include "tools/programs/setup/draft.h"
#include "tools/programs/setup/job.h"
#include "tools/programs/setup/message_link.h"
#include "tools/programs/setup/worker.h"

namespace touchline::setup {

struct SetupOptions {
  std::string board;   // the saved board file; venue and team file lie beside it
  std::string folder;  // folder of the draft
  std::string socket;
};

/// The client that asked; request 0 needs no answer.
struct Asker {
  nlohmann::json client, request = 0;
};

/// The running job, from its first frame to the end of its work.
struct RunningJob {
  Job job;
  Asker asker;
  std::vector<std::shared_ptr<const calibrate::CameraPicture>> frames;
  std::size_t frame_number = 0;  // number of frames that have arrived
  std::chrono::steady_clock::time_point next_frame, give_up;
  bool waits_for_frame = false;
  bool drives = false;  // a robot, until Job::drive is done
  // The last request to drive, and whether the firmware has answered it: other answers are those to earlier jobs.
  std::int64_t test_request = 0;
  bool is_tested = false;
  std::string text;
  nlohmann::json progress = nullptr, result = nullptr;
  nlohmann::json exchange = nullptr;  // TestOrder::exchange
  DraftState state;                   // draft state that the job will create
};
/// The program behind "Set up" of the console (docs/console-protocol.md, Guided setup). It has one thread; long work
/// runs in a process of its own. It serves one connection, from the firmware; a new connection replaces the old one.
class SetupProgram {
 public:
  /// `output`: for the log; a failure to write it is ignored.
  SetupProgram(SetupOptions options, hal::TextOutput& output);
  /// Finishes an interrupted save and listens. Errors of finish_saving() and hal::UnixListener.
  Result<void> open();
  /// Serves until `signals` (of signalfd) can be read.
  void run(int signals);

 private:
  using Clock = std::chrono::steady_clock;
  using Handler = Result<nlohmann::json> (SetupProgram::*)(const Arguments&);
  struct Command {
    const char* name;
    Handler handler;
    bool needs_draft, while_busy;
  };
  static const std::vector<Command>& commands();

  // Connection (setup_program.cpp).
  void accept();
  void receive_from_firmware();
  void receive_from_worker();
  void handle(const Message& message);
  void handle_command(const nlohmann::json& message);
  void handle_frame(const Message& message);
  void answer_camera(const Result<CameraFrame>& frame);
  void answer(const Asker& asker, const Result<nlohmann::json>& result);
  void send(const nlohmann::json& content, std::string_view bytes = {});
  void send_state();
  void send_picture(std::uint32_t id, const ShownPicture& picture, const nlohmann::json& client);
  void use(bool draft);
  void ask_to_try();
  [[nodiscard]] int wait_ms() const;

  // Jobs (setup_jobs.cpp).
  Result<nlohmann::json> start(Job job);
  void request_frames();
  void begin_driving();
  void ask_to_drive();
  void end_driving();
  void handle_tested(const nlohmann::json& answer);
  void drive_robot(const nlohmann::json& message);
  void begin_work();
  void handle_work(Message message);
  void end_job(const std::string& error);
  void check_time();

  // Commands for the draft as a whole (draft_commands.cpp).
  Result<nlohmann::json> state(const Arguments&);
  Result<nlohmann::json> begin(const Arguments&);
  Result<nlohmann::json> discard(const Arguments&);
  Result<nlohmann::json> undo(const Arguments&);
  Result<nlohmann::json> redo(const Arguments&);
  Result<nlohmann::json> cancel(const Arguments&);
  Result<nlohmann::json> differences(const Arguments&);
  Result<nlohmann::json> save(const Arguments&);
  Result<nlohmann::json> export_setup(const Arguments&);
  Result<nlohmann::json> import_setup(const Arguments&);
  Result<nlohmann::json> picture(const Arguments&);
  Result<nlohmann::json> use_files(const Arguments&);
  Result<nlohmann::json> drive(const Arguments&);
  Result<nlohmann::json> change(DraftState state, bool replaces_last = false);

  // Commands of the steps (step_commands.cpp).
  Result<nlohmann::json> field_find(const Arguments&);
  Result<nlohmann::json> field_corners(const Arguments&);
  Result<nlohmann::json> light_measure(const Arguments&);
  Result<nlohmann::json> colors_picture(const Arguments&);
  Result<nlohmann::json> colors_find(const Arguments&);
  Result<nlohmann::json> colors_click(const Arguments&);
  Result<nlohmann::json> colors_remove(const Arguments&);
  Result<nlohmann::json> colors_reset(const Arguments&);
  Result<nlohmann::json> camera_quality(const Arguments&);
  Result<nlohmann::json> set(const Arguments&);
  Result<nlohmann::json> robots_set(const Arguments&);
  Result<nlohmann::json> robots_noise(const Arguments&);
  Result<nlohmann::json> camera_set(const Arguments&);
  Result<nlohmann::json> radio_set(const Arguments&);
  Result<nlohmann::json> radio_pattern(const Arguments&);
  Result<nlohmann::json> radio_measure(const Arguments&);
  Result<nlohmann::json> radio_write(const Arguments&);
  Result<nlohmann::json> set_section(const std::string& section, std::initializer_list<const char*> keys,
                                     const Arguments&);
  Result<nlohmann::json> confirm(const Arguments&);
  Result<nlohmann::json> try_draft(const Arguments&);
  /// `radio`: new value of DraftState::measured["radio"]; null: as before.
  Result<nlohmann::json> change_text(const std::string& step, const std::string& file, Result<std::string> text,
                                     bool replaces_last = false, nlohmann::json radio = nullptr);

  void print(const std::string& text);

  SetupOptions options_;
  hal::TextOutput& output_;
  Draft draft_;
  hal::UnixListener listener_;
  MessageLink firmware_;
  Worker worker_;

  bool uses_draft_ = false;
  std::uint32_t use_request_ = 0;
  // Use_runs_: the firmware has not answered yet; use_is_stale_: the files have changed since.
  bool use_runs_ = false, use_is_stale_ = false;
  nlohmann::json preview_ = {{"source", "saved"}, {"ok", true}, {"error", ""}};
  std::string error_;
  std::uint32_t next_picture_ = 1;
  std::vector<std::string> import_;
  bool trying_ = false;
  bool try_waits_ = false;  // the try waits until the firmware has loaded the draft's files
  // Clients that wait for the camera's measures, and the newest measures. They are not part of the draft, because they
  // change all the time.
  std::vector<Asker> measure_camera_;
  nlohmann::json camera_;

  std::optional<RunningJob> running_;
  Clock::time_point shown_{};  // when the state of a job that drives was sent last
  Asker asker_;                // client whose command is being handled
  bool answered_ = false;      // the job of the command will answer later
};

}  // namespace touchline::setup
