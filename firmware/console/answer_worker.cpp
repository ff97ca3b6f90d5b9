#include "firmware/console/answer_worker.h"

#include <exception>
#include <memory>
#include <utility>

namespace touchline::console {

void AnswerWorker::start(std::function<MadeAnswer()> make) {
  thread_.run([this, make = std::move(make)]() -> FileThread::Finish {
    auto answer = std::make_shared<MadeAnswer>();
    try {
      *answer = make();
    } catch (const std::exception&) {  // out of memory
      *answer = {};
    }
    return [this, answer] {
      answer_ = std::move(*answer);
      is_done_ = true;
    };
  });
  is_busy_ = true;  // set only after run(), which may throw
  is_done_ = false;
}

bool AnswerWorker::is_done() {
  thread_.finish();
  return is_done_;
}

MadeAnswer AnswerWorker::take() {
  is_busy_ = is_done_ = false;
  return std::exchange(answer_, {});
}

}  // namespace touchline::console
