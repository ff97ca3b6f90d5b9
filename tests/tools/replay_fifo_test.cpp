#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "tests/command_output.h"
#include "tests/tools/program_folder.h"

namespace touchline::replay {
namespace {

// Signals to the program while it waits for another one.
class ReplayOfFifo : public touchline::testing::ProgramFolder {
 protected:
  ReplayOfFifo() {
    write("venue.toml",
          "version = 1\n[picture]\nwidth_px = 64\nheight_px = 48\n[field]\nlength_m = 1.5\nwidth_m = 1.3\n"
          "[camera_model]\nkind = \"full\"\n[camera_model.full]\nfx_px = 60.0\nfy_px = 60.0\ncx_px = 31.5\n"
          "cy_px = 23.5\nrotation_rad = [3.14159, 0.0, 0.0]\nposition_m = [0.0, 0.0, 2.0]\n[colors]\nspace = \"rgb\"\n"
          "[[color]]\nname = \"blue\"\n[[color.box]]\nlow = [0, 0, 200]\nhigh = [40, 40, 255]\n"
          "[[color]]\nname = \"red\"\n[[color.box]]\nlow = [200, 0, 0]\nhigh = [255, 40, 40]\n"
          "[[color]]\nname = \"orange\"\n[[color.box]]\nlow = [200, 100, 0]\nhigh = [255, 160, 60]\n");
    write("team.toml",
          "version = 1\n[own]\ncolor = \"blue\"\n[[own.robot]]\nid = 1\ncolors = [\"red\"]\n[ball]\ncolor = "
          "\"orange\"\n");
    write("picture.ppm", "P6\n64 48\n255\n" + std::string(std::size_t{64} * 48 * 3, '\0'));
    EXPECT_EQ(::mkfifo(fifo_.c_str(), 0600), 0);
  }
  // Starts the program, sends SIGTERM when it waits, and expects that it says so and leaves nothing behind.
  void expect_stopped(const std::string& input, const std::string& output) {
    const std::string messages = path("messages.txt"), venue = path("venue.toml"), team = path("team.toml");
    const pid_t process = ::fork();
    if (process == 0) {
      const int file = ::open(messages.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
      for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) ::dup2(file, stream);
      ::execl(TOUCHLINE_REPLAY, "touchline-replay", input.c_str(), "--venue", venue.c_str(), "--team", team.c_str(),
              "--out", output.c_str(), nullptr);
      ::_exit(127);
    }
    const auto is_waiting = [&] {
      std::ifstream file("/proc/" + std::to_string(process) + "/syscall");  // "running", or a number
      long number = -1;
      file >> number;
#ifdef SYS_poll  // not on 64-bit ARM
      if (number == SYS_poll) return true;
#endif
      return number == SYS_ppoll || number == SYS_clock_nanosleep;
    };
    constexpr useconds_t kPause_us = 10'000;
    for (int i = 0; i < 3000 && !is_waiting(); ++i) ::usleep(kPause_us);
    EXPECT_EQ(testing::exit_code_after_termination(process, 10), 1) << "SIGTERM must end the program";
    std::ifstream said(messages);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(said), {}),
              "touchline-replay: stopped; no output was written\n");
  }
  const std::string fifo_ = path("fifo");
};

TEST_F(ReplayOfFifo, SignalsEndTheWaitForAWriter) {
  expect_stopped(fifo_, path("r.jsonl"));
  EXPECT_FALSE(std::filesystem::exists(path("r.jsonl")));
}

TEST_F(ReplayOfFifo, SignalsEndTheWaitForMoreOfTheVideo) {
  const int writer = ::open(fifo_.c_str(), O_RDWR | O_CLOEXEC);
  const std::string begin = "YUV4MPEG2 W64 H48 F30:1 C420jpeg\nFRAME\n";
  ASSERT_EQ(::write(writer, begin.data(), begin.size()), static_cast<ssize_t>(begin.size()));
  expect_stopped(fifo_, path("r.jsonl"));
  ::close(writer);
}

TEST_F(ReplayOfFifo, SignalsEndTheWaitForAReaderOfTheResult) { expect_stopped(path("picture.ppm"), fifo_); }

TEST_F(ReplayOfFifo, SignalsEndTheWaitForAFullPipe) {
  const int reader = ::open(fifo_.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
  while (::write(reader, "full", 4) > 0) {
  }
  expect_stopped(path("picture.ppm"), fifo_);
  ::close(reader);
}

TEST_F(ReplayOfFifo, AVideoComesThroughAFifo) {
  std::thread writer([this] {
    std::ofstream out(fifo_);
    out << "YUV4MPEG2 W64 H48 F30:1 C420jpeg\n";
    for (int i = 0; i < 3; ++i) out << "FRAME\n" << std::string(std::size_t{64} * 48 * 3 / 2, 'x');
  });
  EXPECT_TRUE(run_program(TOUCHLINE_REPLAY, fifo_ + " --venue " + path("venue.toml") + " --team " + path("team.toml") +
                                                " --out " + path("r.jsonl")))
      << read("out");
  writer.join();
  EXPECT_EQ(read("out").substr(0, 9), "3 frames ");
}

}  // namespace
}  // namespace touchline::replay
