#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hal/mock/arena_parameters.h"
#include "hal/mock/renderer.h"
#include "hal/replay/picture.h"
#include "tests/tools/program_folder.h"
#include "tools/programs/arena/scenes.h"
#include "tools/programs/setup/message_link.h"

namespace touchline::setup {

/// Renders pictures of the arena as its camera delivers them (RGB, 640 x 480).
hal::Picture arena_picture(hal::mock::Floor floor, std::uint64_t seed);
/// Returns the first pictures of a scene.
std::vector<hal::Picture> scene_pictures(arena::SceneKind kind, unsigned count, std::uint64_t seed);

/// touchline-setup in a folder with a copy of the mock board; the test takes the place of the firmware and its page.
class ScriptedFirmware : public touchline::testing::ProgramFolder {
 protected:
  void SetUp() override;
  void TearDown() override;

  /// Copies a file of the mock board to the saved files.
  void copy(const std::string& name) const;
  void start_program();
  void stop_program(int signal);
  void connect();
  void disconnect() {
    socket_.reset();
    reader_ = {};
  }

  /// Sends a command and waits for its answer; in the meantime serves frames and the use of files.
  nlohmann::json run(const std::string& command, nlohmann::json members = nlohmann::json::object());
  /// As run(); the command must succeed. Returns the result.
  nlohmann::json expect_ok(const std::string& command, nlohmann::json members = nlohmann::json::object());
  /// As run(); the command must fail with a message that contains this text.
  void expect_error(const std::string& command, nlohmann::json members, const std::string& text);
  /// Sends a command without waiting; returns its request.
  int send(const std::string& command, nlohmann::json members = nlohmann::json::object());
  nlohmann::json answer_to(int request);
  /// Handles messages until `is_enough`.
  void serve_until(const std::function<bool()>& is_enough);
  Message receive();
  void answer_use(const std::string& error = "");
  void send_bytes(const std::string& bytes) const;

  [[nodiscard]] std::string saved(const std::string& name) const { return path("etc/" + name); }
  /// Returns the picture of the state's step; the test fails if it did not arrive.
  const Message& picture(const nlohmann::json& id);

  nlohmann::json state_, live_;         // newest messages
  std::vector<Message> pictures_;       // pictures for the page
  std::vector<nlohmann::json> used_;    // "use" messages
  std::vector<nlohmann::json> tries_;   // "try" messages, which the test answers
  std::vector<nlohmann::json> tests_;   // "test" messages, which the test answers
  std::vector<nlohmann::json> wheels_;  // "wheels" messages
  std::vector<hal::Picture> camera_;    // pictures that the camera delivers in turn
  std::string camera_error_;            // error that the camera reports instead of a picture
  bool delivers_ = true;                // false: the camera never answers "frames"
  bool loads_ = true;                   // false: the test answers "use" with answer_use()
  std::size_t delivered_ = 0;

 private:
  void handle(const Message& message);
  void deliver();

  hal::Descriptor socket_;
  MessageReader reader_;
  std::vector<nlohmann::json> answers_;
  pid_t process_ = 0;
  int next_request_ = 1;
};

/// A board whose venue is calibrated.
class SetupOfACalibratedBoard : public ScriptedFirmware {
 protected:
  void SetUp() override {
    ScriptedFirmware::SetUp();
    for (const char* name : {"venue.toml", "venue-light.png", "venue-field.png"}) copy(name);
  }
};

/// Arguments of field.find for the field of arena_picture().
inline const nlohmann::json kMiroSot = {{"preset", "mirosot-middle"}, {"camera_height_m", 2.3}};

}  // namespace touchline::setup
