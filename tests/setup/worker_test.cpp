#include "tools/programs/setup/worker.h"

#include <gtest/gtest.h>
#include <poll.h>

#include <fstream>
#include <sstream>

namespace touchline::setup {
namespace {

// Reports of the work about itself.
nlohmann::json said_by(const Worker::Work& work) {
  Worker worker;
  EXPECT_TRUE(worker.start(work).ok());
  nlohmann::json last;
  while (worker.is_running()) {
    pollfd file{worker.link().descriptor(), POLLIN, 0};
    ::poll(&file, 1, -1);
    const Result<void> received = worker.link().receive();
    for (;;) {
      Result<std::optional<Message>> message = worker.link().next();
      if (!message.ok() || !message.value()) break;
      if (message.value()->content.at("type") == "done") {
        EXPECT_EQ(worker.finish(), "");
        return last;
      }
      last = message.value()->content;
    }
    if (!received.ok()) break;
  }
  ADD_FAILURE() << "the work has not reported its end";
  return last;
}

// As root the test itself has all of them.
TEST(Worker, HasNoCapabilities) {
  const nlohmann::json said = said_by([](const Worker::Reporter& reporter) -> Result<void> {
    std::ostringstream status;
    status << std::ifstream("/proc/self/status").rdbuf();
    reporter.send({{"type", "status"}, {"text", status.str()}});
    return {};
  });
  const std::string status = said.at("text");
  for (const char* set : {"CapInh", "CapPrm", "CapEff", "CapAmb"}) {
    EXPECT_NE(status.find(std::string(set) + ":\t0000000000000000\n"), std::string::npos) << set;
  }
  EXPECT_NE(status.find("NoNewPrivs:\t1\n"), std::string::npos);
}

}  // namespace
}  // namespace touchline::setup
